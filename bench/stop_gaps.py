#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions between two checks of the cancellation flag, and fails if too many.

    bench/stop_gaps.py build/release/bin/instruction_cases

A cancelled computation ends at its next call of RunControl::check_cancelled(). callgrind writes the
instructions since the previous call at each of these calls. So the longest interval without a check
is counted, not timed, in all stages of an extraction with one thread.

White noise of 16^3 represents white noise of 96^3, which would take an hour. Work between two
checks that grows with the volume is 6^3 times as long there (a sort 1.6 times that); work that does
not grow is not longer. So the limit of 1.5e9 instructions, half a second to a second, becomes 7e6.

Needs valgrind. Uses only the standard library.
"""

import argparse
import collections
import pathlib
import re
import subprocess
import sys
import tempfile

CASES = ("noise_16_refined", "noise_16_measured", "smooth_32_refined")
LIMIT = 1.5e9 / (96 / 16) ** 3
SHOWN = 5  # number of printed intervals that are too long, and of functions for each of them


def write_gaps(valgrind, program, case, file):
    """Run a case. Returns the instructions of extract_case() with all its calls."""
    options = ["--tool=callgrind", "--collect-atstart=no", "--toggle-collect=extract_case"]
    options += ["--dump-before=isoatlas::RunControl::*", "--combine-dumps=yes"]
    options += [f"--callgrind-out-file={file}"]
    command = [valgrind, *options, program, case]
    done = subprocess.run(command, capture_output=True, text=True)
    collected = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not collected or int(collected[1]) == 0:
        sys.exit(
            f"{case}: valgrind ended with status {done.returncode} without a count:\n{done.stderr}"
        )
    return int(collected[1])


def read_gaps(file):
    """Yield, per interval, the instructions of each function without those of its calls."""
    names, function, is_call, gap = {}, None, False, None
    for line in file:
        if line.startswith("events:"):
            if gap is not None:
                yield gap
            gap = collections.Counter()
        elif match := re.match(r"c?fn=\((\d+)\)(?: (.*))?", line):
            if match[2]:
                names[match[1]] = match[2]
            if line.startswith("fn="):
                function = names[match[1]]
        elif line.startswith("calls="):
            # The next line counts the called function, whose own lines count it already.
            is_call = True
        elif line[0] in "+-*0123456789":
            if not is_call:
                gap[function] += int(line.split()[1])
            is_call = False
    yield gap


def is_within_limit(valgrind, program, case):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        instructions = write_gaps(valgrind, program, case, out)
        with open(out) as file:
            gaps = [(gap.total(), gap) for gap in read_gaps(file)]
    counted = sum(total for total, _ in gaps)
    if counted != instructions:
        sys.exit(
            f"{case}: {counted:,} instructions in {len(gaps):,} intervals, "
            f"expected {instructions:,}: the file of callgrind was misread"
        )
    gaps.sort(key=lambda gap: -gap[0])
    print(
        f"{case}: {len(gaps):,} intervals; the longest has {gaps[0][0]:,} instructions, "
        f"expected at most {LIMIT:,.0f}"
    )
    for total, gap in gaps[:SHOWN]:
        if total > LIMIT:
            print(f"  {total:,} instructions without a check of cancellation, among them")
            for name, count in gap.most_common(SHOWN):
                print(f"    {count:12,} {name[:150]}")
    return gaps[0][0] <= LIMIT


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", type=pathlib.Path, help="the built instruction_cases")
    parser.add_argument("--valgrind", default="valgrind", help="the valgrind program")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    passed = [is_within_limit(arguments.valgrind, program, case) for case in CASES]
    return 0 if all(passed) else 1


if __name__ == "__main__":
    sys.exit(main())
