#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions between two looks at whether to stop, and fails where there are too many.

    bench/stop_gaps.py build/release/bin/instruction_cases

A computation that was cancelled ends at the next call of RunControl::check_cancelled(). callgrind writes down at each of them what was
executed since the last one, so the longest time without a look is counted, not timed, in all stages of an extraction by one thread.

White noise of 16^3 stands for white noise of 96^3, which would take an hour: what grows with the volume between two looks is 6^3 times as
long there (a sort 1.6 times that), and what does not, some fixed number of steps, is no longer. So 1.5e9 instructions, half a second to a second,
are 7e6 here.

Needs valgrind. Standard library only.
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
SHOWN = 5  # of the gaps that are too long, and of the functions that most of them are spent in


def write_gaps(valgrind, program, case, file):
    """Runs a case. @return the instructions of all of extract_case()"""
    done = subprocess.run([valgrind, "--tool=callgrind", "--collect-atstart=no", "--toggle-collect=extract_case",
                           "--dump-before=isoatlas::RunControl::*", "--combine-dumps=yes", f"--callgrind-out-file={file}", program, case],
                          capture_output=True, text=True)
    collected = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not collected or int(collected[1]) == 0:
        sys.exit(f"{case}: valgrind ended with status {done.returncode} and no count:\n{done.stderr}")
    return int(collected[1])


def read_gaps(file):
    """Yields, per gap, the instructions of each function by itself."""
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
            is_call = True  # the next line has what was called, which is counted where it was executed
        elif line[0] in "+-*0123456789":
            if not is_call:
                gap[function] += int(line.split()[1])
            is_call = False
    yield gap


def is_good(valgrind, program, case):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        instructions = write_gaps(valgrind, program, case, out)
        with open(out) as file:
            gaps = [(gap.total(), gap) for gap in read_gaps(file)]
    counted = sum(total for total, _ in gaps)
    if counted != instructions:
        sys.exit(f"{case}: {counted:,} instructions in {len(gaps):,} gaps, expected {instructions:,}: callgrind's file was misread")
    gaps.sort(key=lambda gap: -gap[0])
    print(f"{case}: {len(gaps):,} gaps; the longest has {gaps[0][0]:,} instructions, expected at most {LIMIT:,.0f}")
    for total, gap in gaps[:SHOWN]:
        if total > LIMIT:
            print(f"  {total:,} instructions without a look at whether to stop, among them")
            for name, count in gap.most_common(SHOWN):
                print(f"    {count:12,} {name[:150]}")
    return gaps[0][0] <= LIMIT


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="the built instruction_cases")
    parser.add_argument("--valgrind", default="valgrind", help="the valgrind program")
    arguments = parser.parse_args()
    return 0 if all([is_good(arguments.valgrind, arguments.program.resolve(), case) for case in CASES]) else 1


if __name__ == "__main__":
    sys.exit(main())
