#!/usr/bin/env bash
# compare.sh OTHER_COMPILER PROGRAM FOLDER "SURFACE SIZE ..." FLAGS... SOURCE: 77 where there is no other compiler.
set -euo pipefail
compiler=$1 program=$2 folder=$3
read -ra surfaces <<<"$4"
shift 4
command -v "$compiler" >/dev/null || exit 77
mkdir -p "$folder"
"$compiler" "$@" -pthread -o "$folder/mesh"
"$program" "${surfaces[@]}" "$folder/this"
"$folder/mesh" "${surfaces[@]}" "$folder/other"
[ -s "$folder/this" ]
cmp "$folder/this" "$folder/other"
