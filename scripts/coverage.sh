#!/usr/bin/env bash
# Which lines of include/ the tests run, as a table by folder; fails below 92 %. Builds everything once more: an hour of processor time.
# coverage.py BUILD --missing HEADER lists the lines.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=$PWD/build/coverage

scripts/setup.sh clang-16 llvm-16 libvtk9-dev libcgal-dev libgmsh-dev libnglib-dev libopenmpi-dev openmpi-bin libptscotch-dev
cmake --preset coverage >/dev/null
cmake --build --preset coverage >"$build/build.log"
cmake --build --preset coverage --target heavy_hosts distributed >>"$build/build.log"

# Programs of one kind share four files, into which each adds what it has counted (%4m).
rm -rf "$build/profiles"
export LLVM_PROFILE_FILE="$build/profiles/%4m.profraw"
# Not those that limit the time between two calls: counting costs time.
ctest --test-dir "$build" --output-on-failure --exclude-regex ", followed|^compilers: |heard of all the time" \
  >"$build/tests.log" || { sed -n '/tests passed/,$p' "$build/tests.log"; exit 1; }
/usr/bin/python3 scripts/coverage.py "$build" --least 92
