#!/usr/bin/env bash
# Minimizes the fuzzing corpus of each format for the tests: writes to
# tests/fuzz/corpus_files/FORMAT.zip a small set of the files of build/corpus/FORMAT that covers the
# same code as all of them.
#   scripts/keep_fuzz_corpus.sh [FORMAT...]     (default: all of build/corpus)
# scripts/fuzz_files.sh must have built the fuzzers.
set -euo pipefail
cd "$(dirname "$0")/.."
formats=("$@")
if [ ${#formats[@]} -eq 0 ]; then
  mapfile -t formats < <(find build/corpus -mindepth 1 -maxdepth 1 -type d -printf '%f\n' | sort)
fi
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

contents = [path.read_bytes() for path in pathlib.Path(sys.argv[1]).iterdir()]
files = {hashlib.sha256(content).hexdigest()[:12]: content for content in contents}
with zipfile.ZipFile(sys.argv[2], "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
    for name in sorted(files):  # sorted and without times: the same files give the same archive
        entry = zipfile.ZipInfo(name, (2000, 1, 1, 0, 0, 0))
        archive.writestr(entry, files[name], zipfile.ZIP_DEFLATED)
print(f"{sys.argv[2]}: {len(files)} files, {pathlib.Path(sys.argv[2]).stat().st_size} bytes")
PYTHON
done
