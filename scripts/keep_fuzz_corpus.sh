#!/usr/bin/env bash
# Keeps what fuzzing reached: the smallest set of files of build/corpus/FORMAT that reaches all code
# that any of them reaches, as tests/fuzz/corpus_files/FORMAT.zip, which the tests read.
#   scripts/keep_fuzz_corpus.sh [FORMAT...]     (default: all of build/corpus)
# The fuzzers have to be built (scripts/fuzz_files.sh).
set -euo pipefail
cd "$(dirname "$0")/.."
formats=("$@")
[ ${#formats[@]} -gt 0 ] || mapfile -t formats < <(find build/corpus -mindepth 1 -maxdepth 1 -type d -printf '%f\n' | sort)
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1
kept=tests/fuzz/corpus_files
mkdir -p "$kept"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for format in "${formats[@]}"; do
  mkdir -p "$folder/$format/old" "$folder/$format/new"
  if [ -f "$kept/$format.zip" ]; then unzip -q -d "$folder/$format/old" "$kept/$format.zip"; fi
  build/fuzz-files/bin/fuzz_"$format" -set_cover_merge=1 -use_counters=0 -max_len=8000 \
    "$folder/$format/new" "build/corpus/$format" "$folder/$format/old" > "$folder/$format.log" 2>&1
  python3 - "$folder/$format/new" "$kept/$format.zip" << 'PYTHON'
import hashlib, pathlib, sys, zipfile

files = {hashlib.sha256(data).hexdigest()[:12]: data for data in (p.read_bytes() for p in pathlib.Path(sys.argv[1]).iterdir())}
with zipfile.ZipFile(sys.argv[2], "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
    for name in sorted(files):  # the same files give the same archive
        archive.writestr(zipfile.ZipInfo(name, (2000, 1, 1, 0, 0, 0)), files[name], zipfile.ZIP_DEFLATED)
print(f"{sys.argv[2]}: {len(files)} files, {pathlib.Path(sys.argv[2]).stat().st_size} bytes")
PYTHON
done
