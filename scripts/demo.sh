#!/usr/bin/env bash
# From nothing to two hex-dominant meshes of the Stanford bunny: installs what is missing, builds the program, meshes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/setup.sh
cmake --preset gcc-release -DFRAMEHEX_BUILD_TESTS=OFF -DFRAMEHEX_BUILD_BENCHMARKS=OFF >/dev/null
cmake --build --preset gcc-release --target framehex_program
out=build/demo
mkdir -p "$out"
framehex=build/gcc-release/bin/framehex
"$framehex" mesh examples/data/bunny.stl --size 0.26 --field nearest --order fifo -o "$out/bunny_nearest_fifo.vtu"
"$framehex" mesh examples/data/bunny.stl --size 0.26 --field smoothed --order smoothness -o "$out/bunny_smoothed_smoothness.vtu"
