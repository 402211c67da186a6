// SPDX-License-Identifier: BSL-1.0
#include "framehex/pipeline/detail/mesh_quads_impl.hpp"
