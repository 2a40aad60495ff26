#!/usr/bin/env bash
# try_wheel.sh WHEELS PYTHON DICOM: installs the wheel for PYTHON on a Debian 12 root that has
# nothing but Python and pip, and uses the tool and the module there: volumes in and meshes out in
# many formats, DICOM with each compression, the page, and the message for pictures. Prints the time
# from `pip install` to the first page. Needs root rights, debootstrap and a network; exits with 77
# without them.
set -euo pipefail
tag=$("$2" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
wheel=$(ls -t "$1"/isoatlas-*-"$tag"-*.whl | head -n 1)
dicom=$(realpath "$3")
skip() { echo "skipped: $*"; exit 77; }
[ "$tag" = cp311 ] || skip "Debian 12 has Python 3.11, and the wheel is for $tag"
[ "$(id -u)" -eq 0 ] || skip "not root"
command -v debootstrap > /dev/null || skip "debootstrap is not installed"

# Use the mirror and keys of apt on this machine.
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 2> /dev/null |
  head -n 1)
root=$(mktemp -d)
clean_up() {
  ! mountpoint -q "$root/debian/proc" || umount "$root/debian/proc"
  rm -rf --one-file-system "$root"
}
trap clean_up EXIT
debootstrap --variant=minbase --include=python3,python3-venv bookworm "$root/debian" \
  "${mirror:-http://deb.debian.org/debian}" > "$root/log" 2>&1 || {
  tail -n 3 "$root/log"
  skip "no Debian root could be made"
}
in_root() {
  chroot "$root/debian" env -i PATH=/root/venv/bin:/usr/bin:/bin HOME=/root LC_ALL=C.UTF-8 "$@"
}
# The loader finds libraries next to a program, and the program finds itself, by /proc.
mount -t proc proc "$root/debian/proc" 2> /dev/null || skip "/proc cannot be mounted"
cp /etc/resolv.conf /etc/hosts "$root/debian/etc/"
"$2" -m pip download -q --only-binary :all: --dest "$root/debian/root/packages" "$wheel" ||
  skip "PyPI cannot be reached"
cp -r "$dicom" "$root/debian/root/dicom"
in_root sh -c '! ls /usr/lib/x86_64-linux-gnu/ | grep -E "libtbb|libvtk|libtiff|libGL|libX11"'

in_root python3 -m venv /root/venv
start=$(date +%s.%N)
in_root pip install -q --no-index --find-links /root/packages isoatlas
in_root python3 - <<'EOF'
import pathlib, isoatlas
mesh = isoatlas.extract(isoatlas.examples.load_protein(), 100)
mesh.save("/root/first.html")
assert "isoatlas-geometry" in pathlib.Path("/root/first.html").read_text()
EOF
end=$(date +%s.%N)
echo "from pip install to the first page: $(awk "BEGIN {printf \"%.1f\", $end - $start}") s"
in_root pip list --format=freeze

# The tool, in each format of meshes, from each kind of volume.
samples=/root/venv/lib/python3.11/site-packages/isoatlas/samples
in_root isoatlas --version
in_root isoatlas info "$samples/embryo.nrrd" > /dev/null
for extension in ply stl obj off vtp 3mf gii glb vtm; do
  in_root isoatlas extract "$samples/protein_iron.nhdr" --iso 100 -q -o "/root/m.$extension" \
    --html /root/m.html
  case $extension in
    glb | vtm) in_root isoatlas levels "/root/m.$extension" > /dev/null ;;
    *) in_root isoatlas check "/root/m.$extension" > /dev/null ;;
  esac
done
in_root isoatlas report /root/m.glb -o /root/report.html
for file in "$dicom"/*.dcm; do
  in_root isoatlas info "/root/dicom/$(basename "$file")" > "$root/printed" 2> "$root/errors"
  grep -q sha256 "$root/printed" || { cat "$root/printed" "$root/errors"; exit 1; }
  ! grep -i dictionary "$root/errors"
done

# Pictures need OpenGL and X11, which pip cannot install; everything else works without them.
status=0
in_root isoatlas picture /root/m.glb -o /root/m.png 2> "$root/errors" || status=$?
cat "$root/errors"
[ "$status" -eq 2 ] && grep -q "Debian: libopengl0 .* xvfb" "$root/errors"

in_root python3 - <<'EOF'
import numpy as np, isoatlas
x, y, z = np.indices((40, 36, 30))
field = 11.5 - np.sqrt((x - 19.3) ** 2 + (y - 17.6) ** 2 + (z - 14.7) ** 2)
mesh = isoatlas.extract(field, 0.0, order="ijk")
assert isoatlas.check(mesh, self_intersections=True)["closed"] and len(mesh.to_html()) > 500_000
for extension in ("ply", "vtp", "glb", "3mf", "html", "stl"):
    mesh.save(f"/root/field.{extension}")
print(mesh)
EOF
echo "passed"
