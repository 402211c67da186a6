#!/usr/bin/env bash
# Builds the reference as static HTML in build/reference/html; fails on any warning, and when a public name has no words.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/setup.sh doxygen
out=${1:-build/reference}
mkdir -p "$out"
(cat docs/reference/Doxyfile && echo "OUTPUT_DIRECTORY = $out") | doxygen -
/usr/bin/python3 docs/reference/undocumented.py "$out/xml"
echo "$out/html/index.html"
