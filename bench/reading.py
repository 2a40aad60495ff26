#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the reading times of two builds of the Python module.

    /usr/bin/python3 bench/reading.py BUILD_BEFORE BUILD_AFTER VOLUME...

A build is its folder, which contains python/isoatlas. Each build reads each volume 9 times, in
separate processes that take turns. Prints the medians of the CPU time of reading, and their ratio.
"""

import json
import statistics
import subprocess
import sys

READ = """
import json, sys, time, warnings
import isoatlas
warnings.simplefilter("ignore")
isoatlas.read(sys.argv[1])
times = []
for _ in range(3):
    start = time.process_time()
    isoatlas.read(sys.argv[1])
    times.append(time.process_time() - start)
print(json.dumps(times))
"""


def times(build, volume):
    run = subprocess.run(
        [sys.executable, "-c", READ, volume],
        env={"PYTHONPATH": f"{build}/python"},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(run.stdout)


def main():
    before, after, *volumes = sys.argv[1:]
    print("| volume | before, ms | after, ms | after / before |\n|---|---|---|---|")
    ratios = []
    for volume in volumes:
        found = {before: [], after: []}
        for _ in range(3):
            for build in (before, after):
                found[build] += times(build, volume)
        a, b = statistics.median(found[before]), statistics.median(found[after])
        ratios.append(b / a)
        print(
            f"| {volume.rsplit('/', 1)[-1]} | {1e3 * a:.1f} | {1e3 * b:.1f} | {b / a:.2f} |",
            flush=True,
        )
    print(f"\ngeometric mean {statistics.geometric_mean(ratios):.2f}, largest {max(ratios):.2f}")


if __name__ == "__main__":
    main()
