#!/bin/sh
# build_viewer.sh SOURCE FOLDER: bundles Neuroglancer from npm into FOLDER/dist, unless that was
# done from the same sources already.
set -eu
source=$1 folder=$2
mkdir -p "$folder"
if cat "$source"/* | cmp -s - "$folder/built.txt"; then exit 0; fi
cp "$source"/* "$folder/"
cd "$folder"
npm install --ignore-scripts --no-audit --no-fund --silent
npx vite build --logLevel warn
cat "$source"/* > built.txt
