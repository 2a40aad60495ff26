#!/usr/bin/env bash
# Fuzzes the file readers: one libFuzzer target per format, with ASan and UBSan.
#   scripts/fuzz_files.sh [CPU_SECONDS [FORMAT...]]     (default: 60 CPU seconds for each format)
# The budget counts all runs since build/corpus was created, so a larger budget continues earlier
# runs. JOBS is the number of formats that run at a time (default: 1).
#
# Seeds are the files of tests/data, samples and tests/fuzz/corpus_files. build/corpus/FORMAT is the
# corpus; it grows with each run. A finding is written to build/corpus/FORMAT-crash-*, -oom-* or
# -timeout-* and ends the run of that format. build/corpus/runs.tsv has one line per run: format,
# CPU seconds, executions, covered edges, files in the corpus, findings. Their sums are printed.
set -euo pipefail
cd "$(dirname "$0")/.."
export ROOT=$PWD BUDGET=${1:-60}
shift || true
formats=("$@")
[ ${#formats[@]} -gt 0 ] || formats=(png nrrd nii mha tif dcm vtk vti vtr npy mrc mgh
  ply stl obj off vtp glb 3mf gii json)

mkdir -p build/corpus
touch build/corpus/runs.tsv
if [ -z "${SKIP_BUILD:-}" ]; then
  scripts/install_dependencies.sh test
  scripts/install_dependencies.sh fuzz
  cmake --preset fuzz-files > build/fuzz-files.log
  cmake --build --preset fuzz-files --target "${formats[@]/#/fuzz_}"
fi

add_seeds() {  # FORMAT: seeds of at most 20 KB, so that mutations stay fast
  local format=$1
  mkdir -p "build/corpus/$format"
  if [ -f "tests/fuzz/corpus_files/$format.zip" ]; then
    unzip -q -o -d "build/corpus/$format" "tests/fuzz/corpus_files/$format.zip"
  fi
  if [ "$format" = dcm ]; then
    find tests/data -path '*dcm*' -type f -size -20k
  else
    find tests/data samples -type f -iname "*.$format" -size -20k
  fi | while read -r seed; do
    cp -f "$seed" "build/corpus/$format/seed-$(echo "$seed" | tr '/ ' '__')"
  done
}

spent_on() {  # FORMAT: CPU seconds of all its runs so far
  awk -F '\t' -v format="$1" '$1 == format { cpu += $2 } END { print cpu + 0 }' \
    build/corpus/runs.tsv
}

# FORMAT: runs of at most five minutes each, until the CPU time is spent or there is a finding
fuzz() {
  local format=$1 log=build/corpus/$1.log spent findings=0
  spent=$(spent_on "$format")
  add_seeds "$format"
  while [ "$spent" -lt "$BUDGET" ] && [ "$findings" -eq 0 ]; do
    local seconds=$((BUDGET - spent < 300 ? BUDGET - spent : 300))
    local times used executions edges files
    times=$(
      TIMEFORMAT='%U %S'
      { time build/fuzz-files/bin/fuzz_"$format" -max_total_time="$seconds" -timeout=20 \
        -rss_limit_mb=4096 -malloc_limit_mb=256 -max_len=20000 -print_final_stats=1 \
        -artifact_prefix="$ROOT/build/corpus/$format-" \
        "build/corpus/$format" > "$log" 2>&1 || touch "$log.failed"; } 2>&1
    )
    if [ -e "$log.failed" ]; then
      rm -f "$log.failed"
      cp "$log" "$log.finding"
      findings=1
      echo "$format: there is a finding, see $log.finding"
    fi
    used=$(echo "$times" | awk '{ print int($1 + $2 + 0.5) }')
    spent=$((spent + used))
    executions=$(grep -o 'number_of_executed_units: [0-9]*' "$log" | grep -o '[0-9]*$' || echo 0)
    edges=$(grep -o 'cov: [0-9]*' "$log" | tail -1 | grep -o '[0-9]*$' || echo 0)
    files=$(find "build/corpus/$format" -type f | wc -l)
    printf '%s\t%s\t%s\t%s\t%s\t%s\n' "$format" "$used" "$executions" "$edges" "$files" \
      "$findings" >> build/corpus/runs.tsv
  done
  summary | grep "^$format	"
}

summary() {  # one line per format: the sums of all runs
  awk -F '\t' '
    { cpu[$1] += $2; executions[$1] += $3; if ($4 > edges[$1]) edges[$1] = $4
      files[$1] = $5; findings[$1] += $6 }
    END { for (f in cpu) printf "%s\t%d CPU s\t%d executions\t%d edges\t%d files\t%d findings\n",
                                f, cpu[f], executions[f], edges[f], files[f], findings[f] }
    ' build/corpus/runs.tsv | sort
}
export -f add_seeds fuzz spent_on summary
export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1
printf '%s\n' "${formats[@]}" | xargs -P "${JOBS:-1}" -I{} bash -c 'set -euo pipefail; fuzz {}'
