// SPDX-License-Identifier: BSL-1.0
#include "framehex/surface/detail/cross_field_impl.hpp"
#include "framehex/surface/detail/retriangulation_impl.hpp"
