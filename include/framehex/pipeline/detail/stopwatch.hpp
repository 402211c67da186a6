// SPDX-License-Identifier: BSL-1.0
#pragma once

#include <chrono>

namespace framehex {

/// Wall seconds of the stages, in the columns of the paper's Table 2.
struct StageSeconds {
  double background = 0;          ///< surface preparation and background tetrahedra
  double field = 0;               ///< cross field and frame field
  double insertion = 0;           ///< curves, surfaces, volume
  double tetrahedralization = 0;  ///< retriangulation of the surface and the second tetrahedral mesh
  double search = 0;              ///< potential hexahedra and their conflicts
  double selection = 0;
  double assembly = 0;  ///< remaining cells, interfaces, optimisation

  double recombination() const { return search + selection + assembly; }
  double total() const { return background + field + insertion + tetrahedralization + recombination(); }
};

/// Splits the time since it was made among the stages.
class Stopwatch {
public:
  /// Adds the time since the last call to `stage`.
  void lap(double& stage) {
    const auto now = std::chrono::steady_clock::now();
    stage += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace framehex
