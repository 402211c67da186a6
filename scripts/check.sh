#!/usr/bin/env bash
# What is checked on every change besides the tests: formatting, benchmarks, the other compiler, sanitizers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/setup.sh clang-16 clang-format clang-tidy-16
echo "formatting"
find include src examples tests benchmarks -name '*.[hc]pp' -not -path 'tests/compile/fail/*' -print0 |
  xargs -0 clang-format --dry-run -Werror

echo "viewer: the committed page is what its sources give"
command -v npm >/dev/null || scripts/setup.sh npm
(cd examples/viewer && npm ci --silent && npm run --silent check)

echo "clang-tidy"
clang-tidy-16 --quiet src/*.cpp -- -std=c++20 -Iinclude -isystem /usr/include/eigen3

echo "the benchmarks compile, and every header alone; g++ and clang make the same meshes"
cmake --preset gcc-release >/dev/null
cmake --build --preset gcc-release --target benchmarks compilers_mesh \
  framehex_headers_alone_verify_interface_header_sets >/dev/null
ctest --preset gcc-release --build-config compilers --tests-regex '^compilers:' --no-tests=error

# The thread sanitizer of g++ 12 does not start where addresses are scattered more widely than it knows.
runner=()
setarch -R true 2>/dev/null && runner=(setarch -R)

# Header-only, where scripts/test.sh links `framehex::compiled`. Without the examples, the slow cases and the whole models: those are the business of scripts/test.sh.
run() { # PRESET TEST CASES...
  cmake --preset "$1" -DFRAMEHEX_BUILD_EXAMPLES=OFF -DFRAMEHEX_TESTED_LIBRARY=framehex::framehex >/dev/null
  cmake --build --preset "$1" --target "$2" >/dev/null
  echo "$1: $2" "${@:3}"
  "${runner[@]}" "build/$1/bin/$2" --warn NoTests "${@:3}"
}
for test in test_geometry test_mesh test_verify; do
  run clang-release "$test"
  run gcc-debug "$test"
done
# The threaded stages: what is said to be the same for any number of threads is computed with several.
run gcc-threads test_executor
run gcc-threads test_recombination '[threads]'
run gcc-threads test_selection '[threads]'
