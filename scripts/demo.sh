#!/usr/bin/env bash
# From a fresh Debian 12 machine to a certified mesh: installs what is missing, builds Release, meshes the sample volume.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p build/demo

scripts/install_dependencies.sh build
echo "building (some minutes the first time; log: build/demo/build.log)"
if ! { cmake --preset release -DISOATLAS_BUILD_TESTS=OFF && cmake --build --preset release; } > build/demo/build.log 2>&1; then
  tail -n 40 build/demo/build.log >&2
  exit 1
fi

build/release/bin/isoatlas extract samples/protein_iron.nhdr --iso 100 -o build/demo/protein_iron.ply --report build/demo/protein_iron.json

echo
echo "mesh:   $PWD/build/demo/protein_iron.ply"
echo "report: $PWD/build/demo/protein_iron.json"
echo "tool:   $PWD/build/release/bin/isoatlas   (try: build/release/bin/isoatlas extract --help)"
