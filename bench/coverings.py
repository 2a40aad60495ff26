#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the table of docs/theory/04-covering.md: coarse meshes of both coverings.

Measures all isosurfaces of TOPOLOGY.tsv, with and without event persistence. Needs the tool
(build/release) and the volumes. Takes about ten minutes.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEAD = "| volume @ isovalue |"  # start of the table; only its rows are replaced
COVERINGS = {
    "field": [],
    "halving": ["--covering", "halving"],
    "field 0": ["--event-persistence", "0"],
    "halving 1.5": ["--covering", "halving", "--event-persistence", "1.5vx"],
}
REPEATS = 3


def mesh(tool, volume, iso, options, folder, repeats):
    """Mesh a volume.

    Returns triangles, repair sites, and the least milliseconds of the stages cover and certify.
    """
    best = None
    for _ in range(repeats):
        report = folder / "r.json"
        fixed = "--coarse --allow-self-intersections --threads 1 -q".split()
        outputs = ["-o", folder / "m.ply", "--report", report]
        command = [tool, "extract", volume, "--iso", iso, *fixed, *outputs, *options]
        subprocess.run(command, check=True)
        r = json.loads(report.read_text())
        ms = 1000 * (r["seconds"]["cover"] + r["seconds"]["certify"])
        level = r["levels"][0]
        best = (
            level["triangles"],
            level["certificate"]["repair_sites"],
            min(ms, best[2]) if best else ms,
        )
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument(
        "--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "bin" / "isoatlas"
    )
    parser.add_argument(
        "--out", type=pathlib.Path, default=ROOT / "docs" / "theory" / "04-covering.md"
    )
    arguments = parser.parse_args()

    def line(name, field, halving, field_0, halving_15):
        return (
            f"| {name} | {field[0]:,} | {halving[0]:,} | {halving[0] / field[0]:.2f} "
            f"| {field_0[0]:,} | {halving_15[0]:,} | {field[1]:,} | {halving[1]:,} "
            f"| {field[2]:,.0f} | {halving[2]:,.0f} |"
        )

    lines, total = [], [[0, 0, 0] for _ in COVERINGS]
    with tempfile.TemporaryDirectory() as name, open(arguments.data / "TOPOLOGY.tsv") as table:
        for row in csv.DictReader(table, delimiter="\t"):
            found = [
                mesh(
                    arguments.tool,
                    arguments.data / row["file"],
                    row["isovalue"],
                    options,
                    pathlib.Path(name),
                    REPEATS if len(options) in (0, 2) else 1,
                )
                for options in COVERINGS.values()
            ]
            total = [[a + b for a, b in zip(t, f)] for t, f in zip(total, found)]
            lines.append(line(f"{row['file'].split('.')[0]} @ {row['isovalue']}", *found))
            print(lines[-1], flush=True)
    lines.append(line("all", *total))
    old = arguments.out.read_text().splitlines()
    first = next(i for i, text in enumerate(old) if text.startswith(HEAD)) + 2
    last = next(i for i in range(first, len(old)) if not old[i].startswith("|"))
    arguments.out.write_text("\n".join(old[:first] + lines + old[last:]) + "\n")


if __name__ == "__main__":
    main()
