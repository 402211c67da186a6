// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/parts/detail/parts_recombiner.hpp"
#include "framehex/parts/recombine_in_parts.hpp"

namespace framehex {

template <Transport Tr, Executor E>
PartRecombination recombine_in_parts(const PartInput& input, const Tr& transport, const PartsOptions& options,
                                     const E& executor) {
  check_options(options);
  return detail::PartsRecombiner<Tr, E>(input, transport, options, executor).run();
}

}  // namespace framehex
