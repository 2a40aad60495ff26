#!/usr/bin/env bash
# Installs what the build, the tests, the benchmarks and the fuzzers need on Debian 12, and nothing where it is all there already.
#   scripts/install_dependencies.sh [build|page|test|bench|fuzz]     (default: build; page: what the HTML page is bundled with; test includes
#                                                                    build and page, bench includes all three; fuzz: the core library
#                                                                    only, and clang)
set -euo pipefail

build=(g++ cmake ninja-build libtbb-dev libboost-dev libcgal-dev libinsighttoolkit5-dev libvtk9-dev libtiff-dev zlib1g-dev libcli11-dev nlohmann-json3-dev libtinygltf-dev)
page=()  # any Node from 18 on will do, wherever it is from
command -v node > /dev/null || page+=(nodejs)
command -v npm > /dev/null || page+=(npm)
test=("${build[@]}" "${page[@]}" chromium libgtest-dev librapidcheck-dev python3 libgmp-dev)
bench=("${test[@]}" libbenchmark-dev python3-numpy python3-vtk9)
fuzz=(clang libclang-rt-dev cmake ninja-build libtbb-dev libboost-dev libcgal-dev)

case "${1:-build}" in
  build) wanted=("${build[@]}") ;;
  page) wanted=("${page[@]}") ;;
  test) wanted=("${test[@]}") ;;
  bench) wanted=("${bench[@]}") ;;
  fuzz) wanted=("${fuzz[@]}") ;;
  *) echo "usage: $0 [build|page|test|bench|fuzz]" >&2; exit 2 ;;
esac

missing=()
for package in "${wanted[@]}"; do
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
echo "installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" > /dev/null
