// SPDX-License-Identifier: BSL-1.0
#define FRAMEHEX_INSTANTIATE template
#include "framehex/adapters/compiled.hpp"
