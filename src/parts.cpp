// SPDX-License-Identifier: BSL-1.0
#include "framehex/parts/detail/recombine_in_parts_impl.hpp"
#include "framehex/pipeline/detail/recombine_by_parts_impl.hpp"

namespace framehex {

template PartRecombination recombine_in_parts(const PartInput&, const SerialTransport&, const PartsOptions&,
                                              const ExecutorRef&);

}  // namespace framehex
