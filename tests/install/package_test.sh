#!/usr/bin/env bash
# package_test.sh BUILD CONSUMER: makes the Debian package of a build and tests it with
# try_package.sh. Exits with 77 if that is not possible.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
cpack -G DEB -B "$out" > "$out/log" 2>&1 || { cat "$out/log"; exit 1; }
status=0
"$here/try_package.sh" "$out"/*.deb "$2" || status=$?
exit "$status"
