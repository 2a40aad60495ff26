#!/usr/bin/env bash
# Installs missing packages, builds the release preset with tests and runs the tests. Arguments are
# passed to ctest.
#   scripts/test.sh           all tests without the label "slow"
#   scripts/test.sh --all     all tests
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh test
. scripts/use_ccache.sh
cmake --preset release -DISOATLAS_BUILD_TESTS=ON -DISOATLAS_BUILD_PYTHON=ON \
  -DISOATLAS_BUILD_MPI=ON -DISOATLAS_BUILD_VTK_FILTER=ON -DISOATLAS_UNITY_BUILD=ON
cmake --build --preset release
if [ "${1:-}" = --all ]; then
  shift
  ctest --test-dir build/release --output-on-failure -j "$(nproc)" "$@"
else
  ctest --preset release -j "$(nproc)" "$@"
fi
