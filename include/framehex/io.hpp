// SPDX-License-Identifier: BSL-1.0
#pragma once

// Readers and writers that need no foreign library.
// clang-format off

#include "framehex/io/data_array.hpp"
#include "framehex/io/input_file.hpp"
#include "framehex/io/label_arrays.hpp"
#include "framehex/io/label_limit.hpp"
#include "framehex/io/legacy_vtk_reader.hpp"
#include "framehex/io/medit_reader.hpp"
#include "framehex/io/medit_writer.hpp"
#include "framehex/io/mesh_builder.hpp"
#include "framehex/io/mesh_writer.hpp"
#include "framehex/io/metis_format.hpp"
#include "framehex/io/msh_reader.hpp"
#include "framehex/io/msh_writer.hpp"
#include "framehex/io/obj_reader.hpp"
#include "framehex/io/off_reader.hpp"
#include "framehex/io/output_file.hpp"
#include "framehex/io/ply_reader.hpp"
#include "framehex/io/soup_repair.hpp"
#include "framehex/io/stl_reader.hpp"
#include "framehex/io/surface_faults.hpp"
#include "framehex/io/surface_reader.hpp"
#include "framehex/io/surface_soup.hpp"
#include "framehex/io/text_buffer.hpp"
#include "framehex/io/triangle_soup.hpp"
#include "framehex/io/vtk_cells.hpp"
#include "framehex/io/vtu_writer.hpp"
