// SPDX-License-Identifier: BSL-1.0
#include "own_mesh.hpp"
