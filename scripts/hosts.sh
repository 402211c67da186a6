#!/usr/bin/env bash
# Builds and tests the adapters whose libraries are heavy to install, and follows the pages of all hosts from an empty folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/setup.sh libvtk9-dev libcgal-dev libgmsh-dev libnglib-dev
cmake --preset hosts
cmake --build --preset hosts
ctest --preset hosts
