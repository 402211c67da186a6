#!/usr/bin/env bash
# Which lines of include/ the tests run, as a table by folder; fails below 92 %. Takes two hours of processor time.
# coverage.sh [REGEX]   only the tests whose names match, on top of what ran before; without it, all of them from nothing.
# Unoptimised code is slow: tests that take more than a minute of it are killed and count for nothing, so that the figure
# is a lower bound. coverage.py BUILD --missing HEADER lists the lines.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/coverage

scripts/setup.sh libvtk9-dev libcgal-dev libgmsh-dev libnglib-dev libopenmpi-dev openmpi-bin libptscotch-dev
cmake --preset coverage >/dev/null
if [ $# -eq 0 ]; then
  find "$build" -name '*.gcda' -delete
fi
cmake --build --preset coverage
# Pages, packages and documents are tested against headers that are installed or joined, whose lines are not counted.
(ulimit -t 60 && ctest --test-dir "$build" --parallel 2 --tests-regex "${1:-.}" \
  --exclude-regex ', followed$|^consumers: |^docs: |^compilers: ' >"$build/tests.log") || true
grep -E 'tests passed|\*\*\*' "$build/tests.log"
if grep --quiet '\*\*\*Failed' "$build/tests.log"; then exit 1; fi
/usr/bin/python3 scripts/coverage.py "$build" --least 92
