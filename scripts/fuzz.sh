#!/usr/bin/env bash
# Fuzzes readers, checks, recombination and meshing: fuzz.sh [SECONDS]   of each, 600 without; ends at the first that is found.
# New inputs are kept in build/fuzz/corpus. One that breaks a promise goes to tests/fuzz/corpus once it is mended.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=${1:-600}

scripts/setup.sh clang-16 libclang-rt-16-dev
cmake --preset fuzz
cmake --build --preset fuzz
for target in readers validate recombine mesh_surface; do
  found=build/fuzz/corpus/$target
  mkdir -p "$found"
  echo "$target: $seconds s"
  "build/fuzz/bin/fuzz_$target" -len_control=0 -max_len=$([ $target = readers ] && echo 4096 || echo 300) -max_total_time="$seconds" \
    -timeout=600 -rss_limit_mb=4000 -malloc_limit_mb=2000 -artifact_prefix="build/fuzz/$target-" -print_final_stats=1 \
    "$found" "tests/fuzz/corpus/$target"
done
