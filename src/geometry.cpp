// SPDX-License-Identifier: BSL-1.0
#include "framehex/geometry/detail/quadratic_validity_impl.hpp"
#include "framehex/geometry/detail/validity_impl.hpp"
