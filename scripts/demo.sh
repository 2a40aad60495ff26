#!/usr/bin/env bash
# Makes a certified mesh of the sample volume and an HTML page that shows it, on a new Debian 12
# machine: installs missing packages, builds the release preset and runs the tool.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p build/demo

scripts/install_dependencies.sh build
echo "building (some minutes the first time; log: build/demo/build.log)"
if ! {
  cmake --preset release -DISOATLAS_BUILD_TESTS=OFF -DISOATLAS_BUILD_PAGE=ON \
    -DISOATLAS_BUILD_VTK_FILTER=OFF -DISOATLAS_UNITY_BUILD=ON &&
    cmake --build --preset release
} > build/demo/build.log 2>&1; then
  tail -n 40 build/demo/build.log >&2
  exit 1
fi

build/release/bin/isoatlas extract samples/protein_iron.nhdr --iso 100 \
  --refine max-distance:2vx --refine max-distance:1vx --refine max-distance:0.5vx --supersample 2 \
  -o build/demo/protein_iron.glb --report build/demo/protein_iron.json \
  --html build/demo/protein_iron.html

echo
echo "mesh:   $PWD/build/demo/protein_iron.glb"
echo "report: $PWD/build/demo/protein_iron.json"
echo "tool:   $PWD/build/release/bin/isoatlas   (try: build/release/bin/isoatlas extract --help)"
echo "page:   $PWD/build/demo/protein_iron.html   (open it in a browser)"
