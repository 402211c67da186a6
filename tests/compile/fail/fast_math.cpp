// SPDX-License-Identifier: BSL-1.0
// flags: -ffast-math
// error: cannot be compiled with -ffast-math
#include "framehex/config.hpp"
