#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the section "Closed meshes" of docs/results.md: --border closed on the real volumes.

  bench/closed.py ORACLE [--data FOLDER] [--only NAME ...] [--coarse] [--out FILE]

Meshes all isosurfaces of TOPOLOGY.tsv with `--border closed`, at level 0 and within the default
bound. ORACLE, a program from outside the project, compares each level with the volume with a layer
of outside samples around it: the same topology, component by component, no boundary loops, no
self-intersections. Planarity of the caps is checked here. Exit status 1: a level fails; 77: no data
or no oracle.

PYTHONPATH must contain the Python module of build/release. Takes about half an hour; --coarse, the
test regression.closed, about two minutes: level 0 alone, and nothing is written without --out.
"""

import argparse
import csv
import pathlib
import sys
import tempfile

import numpy as np

import isoatlas
from oracle_check import DATA, ROOT, SKIPPED, verdict_on, write_nrrd
from results import with_new_sections

TITLE = "## Closed meshes"
INTRODUCTION = f"""{TITLE}

Written by `bench/closed.py`: `--border closed --topology faces`, level 0 and the level within the
default bound. An oracle from outside the project compares each level with the volume around which
a layer of samples is outside: the topology component by component, boundary loops, and all pairs of
triangles, exactly. "Off the boundary" is the largest distance of a cap from its face of the volume
boundary, in voxels.
"""
HEADER = [
    "| isosurface | level | triangles | of them caps | topology | boundary loops "
    "| intersecting pairs | off the boundary |",
    "|---|---|---:|---:|---|---:|---:|---:|",
]


def padded(array):
    """The samples, [z, y, x], with a layer around them that is below all isovalues."""
    kind = np.float64 if array.dtype.kind == "f" else np.int64
    return np.pad(array.astype(kind), 1, constant_values=np.nanmin(array).astype(kind) - 1)


def off_the_boundary(level, shape):
    """The largest distance of a cap from its face of the volume boundary, in voxels."""
    count = level.report["caps"]["triangles"]
    if count == 0:
        return 0.0
    corners = level.vertices[level.faces[len(level.faces) - count :]]  # (count, 3, xyz)
    largest = np.array(shape[::-1]) - 1
    distance = np.concatenate([np.abs(corners), np.abs(corners - largest)], axis=2)
    return float(distance.max(axis=1).min(axis=1).max())


def rows_of(oracle, folder, label, volume, iso, coarse):
    """Yields the row of each level, and whether it passes."""
    write_nrrd(folder / "padded.nrrd", padded(volume.array))
    mesh = isoatlas.extract(
        volume, float(iso), topology="faces", space="voxel", border="closed", coarse=coarse
    )
    for level in mesh.levels:
        status, verdict = verdict_on(
            oracle, folder / "padded.nrrd", iso, level.vertices + 1, level.faces)
        pairs, loops = verdict["self_intersections"]["pairs"], verdict["boundary_loops"]
        off = off_the_boundary(level, volume.array.shape)
        is_first = level.number == 0
        row = (
            f"| {label if is_first else ''} | {'coarse' if is_first else 'default bound'} "
            f"| {len(level.faces):,} | {level.report['caps']['triangles']:,} "
            f"| {'equal' if status == 0 else 'differs'} | {loops} | {pairs} | {off:.2g} |"
        )
        yield row, status == 0 and loops == 0 and pairs == 0 and off <= 1e-9 * max(
            volume.array.shape)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("oracle", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path, default=DATA)
    parser.add_argument("--only", nargs="*", default=[""], help="parts of the names of volumes")
    parser.add_argument("--coarse", action="store_true")
    parser.add_argument("--out", type=pathlib.Path)
    args = parser.parse_args()
    for needed in (args.oracle, args.data / "TOPOLOGY.tsv"):
        if not needed.is_file():
            print(f"SKIPPED: no {needed}")
            return SKIPPED
    with open(args.data / "TOPOLOGY.tsv") as file:
        table = [row for row in csv.DictReader(file, delimiter="\t")
                 if any(name in row["file"] for name in args.only)]
    rows, failures = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for entry in table:
            volume = isoatlas.read(args.data / entry["file"])
            label = f"{entry['file']}@{entry['isovalue']}"
            for row, passes in rows_of(args.oracle, pathlib.Path(folder), label, volume,
                                       entry["isovalue"], args.coarse):
                rows.append(row)
                failures += not passes
                print(row if passes else f"{row} FAILED", flush=True)
    summary = f"{len(rows) - failures} of {len(rows)} levels pass."
    print(summary)
    out = args.out or (None if args.coarse else ROOT / "docs/results.md")
    if out:
        text = "\n".join([INTRODUCTION, *HEADER, *rows, "", summary, ""])
        out.write_text(with_new_sections(out.read_text(), text))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
