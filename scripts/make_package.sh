#!/usr/bin/env bash
# Builds the Debian package: build/release/isoatlas_VERSION_ARCH.deb.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/install_dependencies.sh package
[ -f build/release/build.ninja ] || cmake --preset release \
  -DISOATLAS_BUILD_TESTS=OFF -DISOATLAS_UNITY_BUILD=ON > /dev/null
cmake --build build/release
cd build/release
cpack -G DEB > package.log || { tail -n 20 package.log >&2; exit 1; }
sed -n 's/^CPack: - package: \(.*\) generated.*/\1/p' package.log
