#!/usr/bin/env bash
# From a fresh Debian 12 machine to a certified mesh: installs what is missing, builds Release, meshes the sample volume.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh build
cmake --preset release -DISOATLAS_BUILD_TESTS=OFF > build-demo.log 2>&1 || { cat build-demo.log; exit 1; }
cmake --build --preset release >> build-demo.log 2>&1 || { cat build-demo.log; exit 1; }
mkdir -p build/demo
mv build-demo.log build/demo/build.log

build/release/bin/isoatlas extract samples/protein_iron.nhdr --iso 100 -o build/demo/protein_iron.ply --report build/demo/protein_iron.json

echo
echo "mesh:   $PWD/build/demo/protein_iron.ply"
echo "report: $PWD/build/demo/protein_iron.json"
echo "tool:   $PWD/build/release/bin/isoatlas   (try: build/release/bin/isoatlas extract --help)"
