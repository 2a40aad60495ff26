#!/bin/sh
# install_packages.sh PYTHON REQUIREMENTS FOLDER [OPTION OF PIP]: installs packages from PyPI
# into a folder, unless it has those of the same list already.
set -eu
python=$1 requirements=$2 folder=$3 option=${4:-}
cmp -s "$requirements" "$folder/installed.txt" && exit 0
rm -rf "$folder"
"$python" -m pip install --quiet --disable-pip-version-check ${option:+"$option"} \
  --target "$folder" -r "$requirements"
cp "$requirements" "$folder/installed.txt"
