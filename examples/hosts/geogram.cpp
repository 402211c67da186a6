// SPDX-License-Identifier: BSL-1.0
// A tetrahedral mesh that Geogram loads, recombined, and written back as a mesh of Geogram.
#include <framehex/adapters/geogram.hpp>
#include <framehex/pipeline/recombine_into.hpp>

#include <geogram/basic/command_line.h>
#include <geogram/basic/command_line_args.h>
#include <geogram/mesh/mesh_io.h>

int main(int argc, char** argv) {
  GEO::initialize();
  GEO::CmdLine::import_arg_group("standard");
  GEO::Mesh tets, mixed;
  if (argc != 3 || !GEO::mesh_load(argv[1], tets)) return 2;
  framehex::GeogramOutput output(mixed);
  framehex::recombine_into(output, framehex::GeogramTets(tets));
  mixed.cells.connect();
  return GEO::mesh_save(mixed, argv[2]) ? 0 : 2;
}
