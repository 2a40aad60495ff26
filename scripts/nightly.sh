#!/usr/bin/env bash
# Runs the adversarial tests with all patterns, which takes minutes, then the property tests with
# new random seeds until the time is up (default: one hour). Each seed is written to
# build/nightly/seeds.log before its run. A failure ends the script, which prints the command that
# repeats the failed run.
#   scripts/nightly.sh [SECONDS]
set -euo pipefail
cd "$(dirname "$0")/.."
end=$(($(date +%s) + ${1:-3600}))
scripts/install_dependencies.sh test
cmake --preset release -DISOATLAS_BUILD_TESTS=ON > /dev/null
cmake --build build/release --target test_adversarial test_property test_levels_property
mkdir -p build/nightly
ISOATLAS_ADVERSARIAL=night build/release/bin/test_adversarial --gtest_brief=1
log=build/nightly/seeds.log
while [ "$(date +%s)" -lt "$end" ]; do
  seed=$(od -An -N4 -tu4 /dev/urandom | tr -d ' ')
  for test in property levels_property; do
    parameters="max_success=30 max_size=100 seed=$seed"
    echo "$(date -u +%FT%TZ) $test $seed" >> "$log"
    if ! RC_PARAMS="$parameters" "build/release/bin/test_$test" --gtest_brief=1 \
      > "build/nightly/$test.log" 2>&1; then
      tail -n 40 "build/nightly/$test.log"
      echo "failed; repeat with: RC_PARAMS='$parameters' build/release/bin/test_$test" |
        tee -a "$log"
      exit 1
    fi
  done
done
echo "passed: $(wc -l < "$log") runs in $log"
