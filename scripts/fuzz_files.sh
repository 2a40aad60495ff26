#!/usr/bin/env bash
# Fuzzes the readers of files: one libFuzzer target for each format, under ASan and UBSan.
#   scripts/fuzz_files.sh [SECONDS [FORMAT...]]     (default: 60 seconds for each format)
# Seeds are the files of tests/data, samples and tests/fuzz/corpus_files. What is new stays in build/corpus/FORMAT; a crash is
# build/corpus/FORMAT-crash-*, and the line with executions and coverage of each format is printed at the end.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
seconds=${1:-60}
shift || true
formats=("$@")
[ ${#formats[@]} -gt 0 ] || formats=(nrrd nii mha tif dcm vtk vti vtr npy mrc mgh ply stl obj off vtp glb 3mf gii json)

scripts/install_dependencies.sh test
scripts/install_dependencies.sh fuzz
cmake --preset fuzz-files > build/fuzz-files.log
cmake --build --preset fuzz-files --target "${formats[@]/#/fuzz_}"

seeds_of() {
  local format=$1
  case $format in
    dcm) find tests/data -path '*dcm*' -type f -size -70k ;;
    *) find tests/data samples -type f -iname "*.$format" -size -70k ;;
  esac
}

export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1
for format in "${formats[@]}"; do
  corpus=build/corpus/$format
  mkdir -p "$corpus"
  seeds_of "$format" | while read -r seed; do cp -f "$seed" "$corpus/seed-$(echo "$seed" | tr '/ ' '__')"; done
  found=tests/fuzz/corpus_files/$format
  folders=("$corpus"); [ -d "$found" ] && folders+=("$found")
  build/fuzz-files/bin/fuzz_"$format" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -max_len=70000 -print_final_stats=1 \
    -artifact_prefix="$root/build/corpus/$format-" "${folders[@]}" > "build/corpus/$format.log" 2>&1 || echo "$format: FOUND something, see build/corpus/$format.log"
  echo "$format: $(grep -o 'stat::number_of_executed_units: .*' "build/corpus/$format.log" || true) $(grep -E '^#[0-9]+.*DONE' "build/corpus/$format.log" | tail -1 | grep -o 'cov: [0-9]*' || true)"
done
