#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the table of docs/theory/04-covering.md: coarse meshes by both coverings, with and without events that close again, on all isosurfaces of the table.

Needs the tool (build/release) and the volumes with TOPOLOGY.tsv. Takes some ten minutes.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEAD = "| volume @ isovalue | sizing field, 1.5 |"
WAYS = {"field": [], "halving": ["--covering", "halving"], "field 0": ["--event-persistence", "0"],
        "halving 1.5": ["--covering", "halving", "--event-persistence", "1.5vx"]}
REPEATS = 3


def mesh(tool, volume, iso, options, folder, repeats):
    """@return triangles, repair sites, milliseconds of cover and certify (the best)"""
    best = None
    for _ in range(repeats):
        report = folder / "r.json"
        subprocess.run([tool, "extract", volume, "--iso", iso, "--coarse", "--allow-self-intersections", "--threads", "1", "-q", "-o", folder / "m.ply", "--report", report,
                        *options], check=True)
        r = json.loads(report.read_text())
        ms = 1000 * (r["seconds"]["cover"] + r["seconds"]["certify"])
        level = r["levels"][0]
        best = (level["triangles"], level["certificate"]["repair_sites"], min(ms, best[2]) if best else ms)
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "bin" / "isoatlas")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs" / "theory" / "04-covering.md")
    arguments = parser.parse_args()

    def line(name, field, halving, field_0, halving_15):
        return (f"| {name} | {field[0]:,} | {halving[0]:,} | {halving[0] / field[0]:.2f} | {field_0[0]:,} | {halving_15[0]:,} | {field[1]:,} | {halving[1]:,} | "
                f"{field[2]:,.0f} | {halving[2]:,.0f} |")

    lines, total = [], [[0, 0, 0] for _ in WAYS]
    with tempfile.TemporaryDirectory() as name, open(arguments.data / "TOPOLOGY.tsv") as table:
        for row in csv.DictReader(table, delimiter="\t"):
            found = [mesh(arguments.tool, arguments.data / row["file"], row["isovalue"], options, pathlib.Path(name), REPEATS if len(options) in (0, 2) else 1)
                     for options in WAYS.values()]
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
