// SPDX-License-Identifier: BSL-1.0
// A stand-in with the names of Geogram that the example uses.
#pragma once

namespace GEO {
void initialize();
}
