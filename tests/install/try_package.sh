#!/usr/bin/env bash
# try_package.sh PACKAGE.deb CONSUMER: installs the package on a fresh Debian 12 root, meshes the
# sample volume with the tool, checks its manual page, and builds and runs the consumer with CMake
# and pkg-config. Prints the time from `dpkg -i` to the mesh. Needs root rights, debootstrap and a
# Debian mirror; exits with 77 without them.
set -euo pipefail
package=$(realpath "$1")
consumer=$(realpath "$2")
skip() { echo "skipped: $*"; exit 77; }
[ "$(id -u)" -eq 0 ] || skip "not root"
command -v debootstrap > /dev/null || skip "debootstrap is not installed"

# Use the mirror and keys of apt on this machine.
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 2> /dev/null |
  head -n 1)
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
debootstrap --variant=minbase bookworm "$root/debian" "${mirror:-http://deb.debian.org/debian}" \
  > "$root/log" 2>&1 || {
  tail -n 3 "$root/log"
  skip "no Debian root could be made"
}
in_root() {
  chroot "$root/debian" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive \
    HOME=/root "$@"
}
rm "$root/debian/etc/apt/sources.list"  # debootstrap wrote one
cp -r /etc/apt/. "$root/debian/etc/apt/"
cp /etc/resolv.conf /etc/hosts "$root/debian/etc/"
[ -d /usr/share/keyrings ] && cp -rn /usr/share/keyrings/. "$root/debian/usr/share/keyrings/"
cp "$package" "$root/debian/root/isoatlas.deb"
cp -r "$consumer" "$root/debian/root/consumer"
in_root apt-get update -qq || skip "the new root reaches no mirror"

# Dependencies are downloaded first, so that the measured time does not include the network.
in_root apt-get install -y -qq --no-install-recommends --download-only /root/isoatlas.deb \
  > /dev/null ||
  skip "the packages that it depends on cannot be fetched"
start=$(date +%s)
in_root dpkg -i /root/isoatlas.deb > /dev/null 2>&1 ||
  in_root apt-get install -f -y -qq --no-install-recommends > /dev/null
in_root isoatlas extract /usr/share/isoatlas/samples/protein_iron.nhdr --iso 100 \
  --max-distance 0.5vx -o /root/protein.ply
echo "from dpkg -i to a mesh: $(($(date +%s) - start)) s"
in_root isoatlas check /root/protein.ply > /dev/null
page=/usr/share/man/man1/isoatlas-extract.1
in_root sh -c "test -s $page.gz || test -s $page"

in_root apt-get install -y -qq --no-install-recommends g++ cmake make pkg-config > /dev/null ||
  skip "no compiler can be fetched"
in_root sh -c 'cmake -S /root/consumer -B /root/build > /dev/null &&
  cmake --build /root/build > /dev/null && /root/build/consumer'
in_root sh -c 'g++ -std=c++20 /root/consumer/main.cpp $(pkg-config --cflags --libs isoatlas) \
  -o /root/by_pkgconfig && /root/by_pkgconfig'
in_root dpkg -r isoatlas > /dev/null
in_root sh -c '! test -e /usr/bin/isoatlas'
echo "passed"
