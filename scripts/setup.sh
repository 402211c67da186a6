#!/usr/bin/env bash
# Installs from Debian's packages what the project is built and tested with, and nothing where all is there.
# setup.sh [PACKAGE...]: those packages too.
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config
  libeigen3-dev libboost-dev                        # the library
  libcli11-dev nlohmann-json3-dev                   # the program: command line, reports
  libpugixml-dev zlib1g-dev liblzma-dev             # readers
  liblemon-dev                                      # matching
  tetgen                                            # the tetrahedraliser, run as a separate program
  catch2 librapidcheck-dev libbenchmark-dev         # tests and benchmarks
  python3-numpy python3-scipy python3-meshio        # independent judges in the tests
  openfoam                                          # its checkMesh, another
  python3-getfem calculix-ccx                       # with openfoam: real solves with known answers
  python3-matplotlib                                # and their pictures
  chromium                                          # the page that shows a mesh, tested without a display
  libtet1.5-dev libopenmesh-dev libtbb-dev          # hosts that adapters are tested with
  locales                                           # a decimal comma for the tests
  aspell aspell-en doxygen                          # spelling of pages and comments; the reference
)

missing=()
for package in "${packages[@]}" "$@"; do
  state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup.sh: run as root, or install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "installing ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
"${as_root[@]}" apt-get -qq update
"${as_root[@]}" apt-get -qq install --yes --no-install-recommends "${missing[@]}" >/dev/null
