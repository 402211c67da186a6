#!/usr/bin/env bash
# Installs what is missing, builds all but the benchmarks (scripts/check.sh) and runs all tests through CTest.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-gcc-release}

scripts/setup.sh
cmake --preset "$preset"
cmake --build --preset "$preset"
ctest --preset "$preset" --parallel "$(nproc)"
