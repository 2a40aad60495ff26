#!/usr/bin/env bash
# Installs what is missing, builds Release with tests, runs them. Arguments go to ctest; none: everything but label "slow".
#   scripts/test.sh --all     the slow ones too
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_dependencies.sh test
cmake --preset release -DISOATLAS_BUILD_TESTS=ON -DISOATLAS_BUILD_PYTHON=ON -DISOATLAS_UNITY_BUILD=ON
cmake --build --preset release
if [ "${1:-}" = --all ]; then
  shift
  ctest --test-dir build/release --output-on-failure -j "$(nproc)" "$@"
else
  ctest --preset release -j "$(nproc)" "$@"
fi
