// SPDX-License-Identifier: BSL-1.0
#pragma once

#include "framehex/executor.hpp"
#include "framehex/parts/input.hpp"
#include "framehex/parts/result.hpp"
#include "framehex/parts/transport.hpp"

namespace framehex {

/// Recombines a tetrahedral mesh that its ranks hold in parts, as `recombine` does one that lies in one place. Collective.
///
/// @param input      this rank's cells; may be none. Which rank brings which cell does not matter.
/// @param transport  how ranks reach one another; `SerialTransport` where there is one.
/// @param options    the same on all ranks, but for the observer.
/// @param executor   runs the parts of this rank.
/// @return this rank's cells of the result, contiguous along a Morton curve; all ranks' together conform, are valid by the
///         exact test, and fill the volume. When an observer of any rank says stop, all end, with no cells.
/// @throws what `validate` throws, with positions in the input of the rank that throws, before any work; `invalid_option`;
///         `unsound_mesh` when the result does not pass its check.
/// @par Complexity   O(n) on each rank for n cells there and in its halo of four layers; rounds and turns exchange what lies
///                   on borders, and the cells whose part has changed.
/// @par Determinism  Depends on places and on `part_size` alone: not on the number of ranks and threads, and not on the
///                   numbering, unless vertices lie at one place.
template <Transport Tr, Executor E = SerialExecutor>
PartRecombination recombine_in_parts(const PartInput& input, const Tr& transport, const PartsOptions& options = {},
                                     const E& executor = {});

/// The same where all cells lie in one place.
template <Executor E = SerialExecutor>
PartRecombination recombine_in_parts(const PartInput& input, const PartsOptions& options = {}, const E& executor = {}) {
  return recombine_in_parts(input, SerialTransport{}, options, ExecutorRef(executor));
}

#ifdef FRAMEHEX_COMPILED
extern template PartRecombination recombine_in_parts(const PartInput&, const SerialTransport&, const PartsOptions&,
                                                     const ExecutorRef&);
#endif

}  // namespace framehex

// Those who link framehex::compiled and have a transport of their own include this themselves.
#ifndef FRAMEHEX_COMPILED
#include "framehex/parts/detail/recombine_in_parts_impl.hpp"
#endif
