#!/usr/bin/env bash
# Builds the documentation site into build/docs/html and checks its links. Warnings are errors.
# Needs no network.
#   scripts/build_docs.sh [--out DIR] [--module DIR] [--without-python]
#     --out DIR          output folder (default: build/docs)
#     --module DIR       folder of the built Python module (default: build/release/python)
#     --without-python   leave out the reference of the Python module
set -euo pipefail
cd "$(dirname "$0")/.."

out=build/docs
module=build/release/python
with_python=yes
while [ $# -gt 0 ]; do
  case "$1" in
    --out) out="${2:?--out: the folder is missing}"; shift 2 ;;
    --module) module="${2:?--module: the folder is missing}"; shift 2 ;;
    --without-python) with_python=no; shift ;;
    *) echo "usage: $0 [--out DIR] [--module DIR] [--without-python]" >&2; exit 2 ;;
  esac
done
python=${PYTHON:-/usr/bin/python3}

modules='sphinx, myst_parser, breathe, furo, sphinx_copybutton, sphinx_inline_tabs'
if ! command -v doxygen > /dev/null || ! "$python" -c "import $modules" 2> /dev/null; then
  echo "$0: doxygen, Sphinx or one of its extensions is not installed:" \
    "scripts/install_dependencies.sh docs" >&2
  exit 77
fi

options=()
if [ "$with_python" = no ]; then
  options+=(-t without_python)
elif ! message=$(PYTHONPATH="$module" "$python" -c 'import isoatlas' 2>&1); then
  echo "$0: $python cannot import the Python module isoatlas from '$module':" \
    "$(tail -n 1 <<< "$message")" >&2
  echo "  to build it:           cmake --preset release -DISOATLAS_BUILD_PYTHON=ON &&" \
    "cmake --build --preset release" >&2
  echo "  if it is elsewhere:    $0 --module DIR" >&2
  echo "  to leave it out:       $0 --without-python" >&2
  exit 1
fi

# The notebook with its 3-D pages; without nbclient or the module, with the output that it keeps.
notebooks=
if [ "$with_python" = yes ] && "$python" -c 'import nbclient, ipykernel' 2> /dev/null; then
  mkdir -p "$out/notebooks"
  notebooks=$(cd "$out/notebooks" && pwd)
  PYTHONPATH=$(cd "$module" && pwd) PYTHONDONTWRITEBYTECODE=1 \
    "$python" scripts/run_notebooks.py --out "$notebooks"
fi

mkdir -p "$out/doxygen"
out=$(cd "$out" && pwd)
{ cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = \"$out/doxygen\""; } | doxygen -
"$python" scripts/check_links.py
PYTHONPATH="$module" PYTHONDONTWRITEBYTECODE=1 ISOATLAS_DOXYGEN_XML="$out/doxygen/xml" \
  ISOATLAS_NOTEBOOKS="$notebooks" \
  "$python" -m sphinx -q -E -a -W --keep-going -n -b html -d "$out/doctrees" \
  ${options[@]+"${options[@]}"} docs "$out/html"
"$python" scripts/check_links.py --html "$out/html"
echo "site: $out/html/index.html"
