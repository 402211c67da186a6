// SPDX-License-Identifier: BSL-1.0
// error: no type named .vertex_type. in .(struct )?framehex::mesh_traits<NoTraits>.|not satisf
#include "framehex/mesh/validation.hpp"

struct NoTraits {};

void use() { framehex::validate(NoTraits{}); }
