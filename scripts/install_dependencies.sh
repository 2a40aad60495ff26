#!/usr/bin/env bash
# Installs the missing Debian 12 packages for one purpose (default: build).
#   scripts/install_dependencies.sh [build|package|python|wheel|docs|test|hosts|bench|fuzz]
#     build     the library, the tool and the HTML page
#     package   build, and the Debian package
#     python    build, and the Python module
#     wheel     build, and wheels; the Python packages come from PyPI
#     docs      only the documentation site
#     test      all of the above, and the tests
#     hosts     test, and ParaView, admesh, PrusaSlicer and what napari's window needs, for the
#               tests of hosts
#     bench     test, and the benchmarks
#     fuzz      only the core library with clang, and the fuzzers
set -euo pipefail

build=(g++ cmake ninja-build libtbb-dev libboost-dev libcgal-dev libvtk9-dev libtiff-dev libpng-dev
  libdcmtk-dev libcharls-dev libopenjp2-7-dev libnifti-dev libpugixml-dev libexpat1-dev liblz4-dev
  libblosc-dev libhdf5-dev libzstd-dev
  liblzma-dev libzip-dev libdraco-dev libssl-dev zlib1g-dev libbz2-dev libcli11-dev
  nlohmann-json3-dev libtinygltf-dev libmeshoptimizer-dev libcpp-httplib-dev pkg-config)
# The HTML page needs Node.js 18 or later, from any source.
command -v node > /dev/null || build+=(nodejs)
command -v npm > /dev/null || build+=(npm)
package=("${build[@]}" dpkg-dev file)
python=("${build[@]}" pybind11-dev python3-dev python3-numpy python3-pip python3-setuptools
  python3-venv python3-wheel)
wheel=("${build[@]}" python3-dev python3-venv)
docs=(doxygen python3-sphinx python3-myst-parser furo python3-breathe python3-sphinx-copybutton
  python3-sphinx-inline-tabs python3-nbclient python3-ipykernel)
test=("${python[@]}" "${package[@]}" "${docs[@]}" ccache debootstrap fish pkg-config zsh
  lib3mf-dev libgtest-dev libinsighttoolkit5-dev librapidcheck-dev python3 libgmp-dev xvfb
  libopenmpi-dev openmpi-bin
  xauth chromium clang-14 libc++-14-dev libc++abi-14-dev clang-format
  python3-joblib python3-nibabel python3-pydicom python3-pytest python3-scipy python3-skimage
  python3-tifffile python3-tqdm python3-vtk9 mypy valgrind)
hosts=("${test[@]}" admesh paraview prusa-slicer
  libegl1 libgl1 libxkbcommon-x11-0 libdbus-1-3 libxcb-icccm4
  libxcb-image0 libxcb-keysyms1 libxcb-randr0 libxcb-render-util0 libxcb-shape0 libxcb-xinerama0
  libxcb-cursor0)
bench=("${test[@]}" python3-matplotlib)
fuzz=(clang libclang-rt-dev unzip cmake ninja-build libtbb-dev libboost-dev libcgal-dev)

case "${1:-build}" in
  build) wanted=("${build[@]}") ;;
  package) wanted=("${package[@]}") ;;
  python) wanted=("${python[@]}") ;;
  wheel) wanted=("${wheel[@]}") ;;
  docs) wanted=("${docs[@]}") ;;
  test) wanted=("${test[@]}") ;;
  hosts) wanted=("${hosts[@]}") ;;
  bench) wanted=("${bench[@]}") ;;
  fuzz) wanted=("${fuzz[@]}") ;;
  *) echo "usage: $0 [build|package|python|wheel|docs|test|hosts|bench|fuzz]" >&2; exit 2 ;;
esac

missing=()
for package in "${wanted[@]}"; do
  state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
  echo "installing: ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends \
    "${missing[@]}" > /dev/null
fi

# Debian's package of ParaView's Python modules conflicts with that of VTK's, which other tests
# need. So it is unpacked into the build folder, not installed.
modules=$(dirname "$0")/../build/hosts/paraview
if [ "${1:-build}" = hosts ] && [ ! -d "$modules/usr/lib/python3/dist-packages/paraview" ]; then
  mkdir -p "$modules"
  (cd "$modules" && apt-get download -qq python3-paraview)
  dpkg -x "$modules"/python3-paraview_*.deb "$modules"
fi
