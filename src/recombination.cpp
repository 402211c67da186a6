// SPDX-License-Identifier: BSL-1.0
#include "framehex/assembly/detail/assemble_impl.hpp"
#include "framehex/assembly/detail/optimization_impl.hpp"
#include "framehex/assembly/detail/sound_assembly_impl.hpp"
#include "framehex/recombination/potential_hex_finder.hpp"
#include "framehex/selection/detail/select_impl.hpp"

namespace framehex::detail {

template class PotentialCellFinder<8, HexSearch>;
template Selection select_on(ExecutorRef, const IncompatibilityGraph&, const SelectOptions&);
template Selection select_on(ExecutorRef, const ImplicitIncompatibilityGraph&, const SelectOptions&);

}  // namespace framehex::detail
