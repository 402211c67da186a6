#!/usr/bin/env bash
# Which lines of include/ the tests run, as a table by folder; fails below 92 %. Takes hours of processor time.
# coverage.sh [SUITE...]   those folders of tests/ only, on top of what ran before; without any, all of them from nothing.
# coverage.py BUILD --missing HEADER lists the lines.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=build/coverage

scripts/setup.sh libvtk9-dev libcgal-dev libgmsh-dev libnglib-dev libopenmpi-dev openmpi-bin libptscotch-dev
cmake --preset coverage >/dev/null
if [ $# -eq 0 ]; then
  find "$build" -name '*.gcda' -delete
  set -- $(find tests -name 'test_*.cpp' | cut -d/ -f2 | sort -u) heavy_hosts distributed
fi

# Folders of one program are one target; those of several are a target of their own, and CTest knows how they are run.
run() { # SUITE
  case $1 in
    heavy_hosts | distributed)
      cmake --build --preset coverage --target "$1"
      ctest --test-dir "$build" --output-on-failure --tests-regex "^$1: " --exclude-regex ", followed"
      ;;
    *)
      cmake --build --preset coverage --target "test_$1"
      "$build/bin/test_$1"
      ;;
  esac
}
for suite in "$@"; do
  echo "$suite"
  run "$suite" >"$build/$suite.log" 2>&1 || { tail -n 40 "$build/$suite.log"; exit 1; }
done
/usr/bin/python3 scripts/coverage.py "$build" --least 92
