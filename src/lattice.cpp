// SPDX-License-Identifier: BSL-1.0
#include "framehex/lattice/detail/lattice_points_impl.hpp"
#include "framehex/lattice/detail/singular_points_impl.hpp"
