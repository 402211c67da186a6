#!/usr/bin/env bash
# Builds and tests what runs over MPI.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/setup.sh libopenmpi-dev openmpi-bin libptscotch-dev
cmake --preset mpi
cmake --build --preset mpi
ctest --preset mpi
