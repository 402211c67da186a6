#!/usr/bin/env bash
# From nothing to two hex-dominant meshes of the Stanford bunny: installs what is missing, builds the program, meshes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/setup.sh
echo "building the program..."
cmake --preset gcc-release >/dev/null
cmake --build --preset gcc-release --target framehex_program

mkdir -p build/demo
mesh() { # FIELD ORDER
  build/gcc-release/bin/framehex mesh examples/data/bunny.stl --size 0.26 --field "$1" --order "$2" \
    -o "build/demo/bunny_$1_$2.vtu" --report "build/demo/bunny_$1_$2.json"
}
mesh nearest fifo
mesh smoothed smoothness | tail -n 1 # without the header
cat <<END

Open in ParaView (Threshold on 'kind' from 0 to 3, then Clip; colour by 'kind' or 'scaled_jacobian'):
  build/demo/bunny_nearest_fifo.vtu
  build/demo/bunny_smoothed_smoothness.vtu
The reports are the .json files beside them.
END
