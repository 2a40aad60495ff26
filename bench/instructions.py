#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions of three small extractions and compares them with instructions.tsv.

    bench/instructions.py build/release/bin/instruction_cases            # fails if over 10 % more
    bench/instructions.py build/release/bin/instruction_cases --update   # writes the file

Needs valgrind. The counts do not depend on the load of the machine. Those in the file are of a
Release build (-O3) by g++ 12 on Debian 12 with one thread. Uses only the standard library.
"""

import argparse
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

FILE = pathlib.Path(__file__).resolve().parent / "instructions.tsv"
CASES = ("smooth_32_refined", "noise_16_coarse", "anisotropic_24_refined")
TOLERANCE = 0.10


def count_instructions(valgrind, program, case):
    """Returns the instructions of extract_case() with all its calls, and the triangles."""
    with tempfile.TemporaryDirectory() as folder:
        options = ["--tool=callgrind", "--collect-atstart=no", "--toggle-collect=extract_case"]
        options += [f"--callgrind-out-file={folder}/out"]
        command = [valgrind, *options, program, case]
        done = subprocess.run(command, capture_output=True, text=True)
    collected = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or not collected or int(collected[1]) == 0:
        sys.exit(
            f"{case}: valgrind ended with status {done.returncode} without a count:\n{done.stderr}"
        )
    return int(collected[1]), int(done.stdout.split()[0])


def read_counts():
    with open(FILE) as file:
        return {row["case"]: row for row in csv.DictReader(file, delimiter="\t")}


def write_counts(counts):
    with open(FILE, "w") as file:
        file.write("case\tinstructions\ttriangles\n")
        file.writelines(
            f"{case}\t{instructions}\t{triangles}\n"
            for case, (instructions, triangles) in counts.items()
        )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", type=pathlib.Path, help="the built instruction_cases")
    parser.add_argument("--valgrind", default="valgrind", help="the valgrind program")
    parser.add_argument("--update", action="store_true", help="write bench/instructions.tsv")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    counts = {case: count_instructions(arguments.valgrind, program, case) for case in CASES}
    if arguments.update:
        write_counts(counts)
        print(f"wrote {FILE}")
        return 0
    kept = read_counts()
    command = f"{pathlib.Path(__file__).resolve()} {program} --update"
    failed = False
    for case, (instructions, triangles) in counts.items():
        if case not in kept:
            print(f"{case}: {FILE} has no count for this case; run {command}")
            failed = True
            continue
        before = int(kept[case]["instructions"])
        change = instructions / before - 1
        print(
            f"{case}: {instructions:,} instructions, {before:,} in {FILE.name} "
            f"({100 * change:+.2f} %); {triangles:,} triangles, "
            f"{int(kept[case]['triangles']):,} in {FILE.name}"
        )
        if change > TOLERANCE:
            print(
                f"{case}: too many instructions: expected at most {100 * TOLERANCE:.0f} % more "
                f"than in {FILE}.\n"
                f"  Make the change cheaper, or accept the cost: run {command}, commit the file "
                "and give the reason"
            )
            failed = True
        elif change < -TOLERANCE:
            print(
                f"{case}: over {100 * TOLERANCE:.0f} % fewer instructions than in {FILE}. "
                f"Update the file, so that a later loss is detected: run {command}"
            )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
