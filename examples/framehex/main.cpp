// SPDX-License-Identifier: BSL-1.0
// framehex: hex-dominant meshes from closed surfaces and from tetrahedral meshes, quadrilaterals from outlines and surfaces.
//
// Exit status: 0 done, 1 failed inside, 2 the input cannot be used (one line says why), 130 interrupted.
#include "framehex/errors.hpp"

#include "commands.hpp"
#include "report.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <new>

namespace program {

namespace {

bool run(const Options& options, const framehex::Observer& observer) {
  switch (options.command) {
    case Command::mesh: return mesh(options, observer);
    case Command::recombine: return recombine(options, observer);
    case Command::field: return field(options, observer);
    case Command::plane: return plane(options, observer);
    case Command::shell: return shell(options, observer);
    default: return inspect(options);
  }
}

/// One line, with the input's name in front where the error is about what stands in it.
std::string line_of(const framehex::error& e, const Options& options) {
  std::string text = e.what();
  const bool about_input = e.entity() != framehex::Entity::none || dynamic_cast<const framehex::open_surface*>(&e) ||
                           dynamic_cast<const framehex::invalid_coordinate*>(&e) ||
                           dynamic_cast<const framehex::invalid_surface*>(&e) ||
                           dynamic_cast<const framehex::invalid_outline*>(&e);
  const bool named = text.starts_with(options.input) || dynamic_cast<const framehex::io_error*>(&e);
  if (about_input && !named) text = options.input + ": " + text;
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text;
}

/// Refuses what the parts of a mesh cannot be asked for.
void check_distributed(const Options& options) {
  if (options.command != Command::recombine)
    throw framehex::io_error(options.output + ": is written by `recombine`, over MPI");
#ifndef FRAMEHEX_PROGRAM_MPI
  throw framehex::io_error(options.output + ": is written over MPI, which this program was built without");
#endif
  if (options.ignore_faces || options.ignore_edges || options.compress || options.quadratic)
    throw framehex::invalid_option(
        options.output + ": --ignore-faces, --ignore-edges, --compress and --quadratic are not for parts of a mesh");
}

/// Which of how many ranks this process is, as `mpirun` tells its children; MPI itself need not be there.
struct Launch {
  int rank = 0, n_ranks = 1;

  Launch() {
    // Open MPI; MPICH, Intel MPI; MVAPICH.
    for (const std::string name : {"OMPI_COMM_WORLD", "PMI", "MV2_COMM_WORLD"}) {
      const char* const size = std::getenv((name + "_SIZE").c_str());
      const char* const number = std::getenv((name + "_RANK").c_str());
      if (!size || !number) continue;
      n_ranks = std::atoi(size);
      rank = std::atoi(number);
      return;
    }
  }
};

/// Refuses what several ranks would all do alike, and write to the same file.
void check_launch(const Options& options, const Launch& launch) {
  if (launch.n_ranks < 2 || is_distributed(options)) return;
  const std::string n = std::to_string(launch.n_ranks);
  if (options.command != Command::recombine)
    throw framehex::invalid_option(n + " ranks would each do the same; over MPI there is `recombine` alone");
  throw framehex::invalid_option(options.output + ": " + n +
                                 " ranks would each write it; over MPI a mesh is written in " + "parts, as " +
                                 std::filesystem::path(options.output).replace_extension(".pvtu").string());
}

int run_safely(const Options& options, const Launch& launch) {
  try {
    check_launch(options, launch);
    if (is_distributed(options)) {
      check_distributed(options);
#ifdef FRAMEHEX_PROGRAM_MPI
      std::cout.clear();
      std::cerr.clear();
      return run_distributed(options);
#endif
    }
    if (options.with_field) throw framehex::invalid_option("--field is for a .pvtu file");
    check_outputs(options);
    const Interruption interruption({options.output, options.report, options.crosses});
    const bool complete = run(options, make_observer(interruption, !options.quiet));
    end_progress();
    if (!complete) std::cerr << "framehex: interrupted\n";
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw framehex::io_error("standard output: cannot be written");
    return complete ? 0 : 130;
  } catch (const framehex::error& e) {
    end_progress();
    std::cerr << "framehex: " << line_of(e, options) << "\n";
    return 2;
  } catch (const std::bad_alloc&) {
    end_progress();
    std::cerr << "framehex: " << options.input << ": not enough memory\n";
    return 2;
  } catch (const std::exception& e) {
    end_progress();
    std::cerr << "framehex: failed inside: " << e.what() << "\n";
    return 1;
  }
}

}  // namespace

}  // namespace program

int main(int argc, char** argv) {
  // What all ranks find alike before they meet, one of them says.
  const program::Launch launch;
  if (launch.rank > 0) {
    std::cout.setstate(std::ios::failbit);
    std::cerr.setstate(std::ios::failbit);
  }
  int exit_status = 0;
  const std::optional<program::Options> options = program::parse(argc, argv, exit_status);
  if (options) exit_status = program::run_safely(*options, launch);
  // The first rank that fails ends all: one that does not say why is not to be it.
  return std::cerr ? exit_status : 0;
}
