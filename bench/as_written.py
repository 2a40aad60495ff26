#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the section "As written" of docs/results.md: defects and angles of the written files.

  bench/as_written.py ORACLE [--data FOLDER]

Meshes all isosurfaces of TOPOLOGY.tsv, and white noise of 64^3, at level 0 and within 1 and 0.5
voxels, and writes each level as .ply and as .stl. ORACLE, a program from outside the project, reads
the files and counts self-intersections and triangles without area. The numbers of inverted or
misplaced components and the dihedral angles are isoatlas' own; bench/random_volumes.py checks the
former by winding numbers.

PYTHONPATH must contain the Python module of build/release. Takes about a quarter of an hour.
"""

import argparse
import collections
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import isoatlas

ROOT = pathlib.Path(__file__).resolve().parent.parent
TITLE = "## As written"
INTRODUCTION = f"""{TITLE}

Written by `bench/as_written.py`. An oracle from outside the project reads the files of each level
and checks them exactly (`.ply` has doubles, `.stl` float32). Intersecting pairs and zero-area
triangles are counted in the `.ply` and in the `.stl`. "Misplaced" are components that are inverted,
or that lie inside another component than on the isosurface. Angles are those of triangles; dihedral
angles are measured between triangles, inside the solid. All angles are in degrees.
"""


def oracle_report(oracle, mesh):
    """The oracle's report on a mesh file."""
    done = subprocess.run(
        [oracle, "mesh", mesh, "--self-intersections", "--json"], capture_output=True, text=True
    )
    return json.loads(done.stdout)["mesh"]


def surfaces(data):
    with open(data / "TOPOLOGY.tsv") as file:
        for row in csv.DictReader(file, delimiter="\t"):
            volume = isoatlas.read(data / row["file"])
            yield f"{row['file']}@{row['isovalue']}", volume, float(row["isovalue"])
    noise = np.random.default_rng(64).random((64, 64, 64)).astype(np.float32)
    yield "white noise 64^3@0.5", noise, 0.5


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("oracle", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared/data")
    args = parser.parse_args()
    lines, total = [], collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for label, volume, iso in surfaces(args.data):
            options = {"nan": "below"} if "nan" in label else {}
            mesh = isoatlas.extract(
                volume, iso, refine=["max-distance:1vx", "max-distance:0.5vx"], **options
            )
            for extension in ("ply", "stl"):
                mesh.save(folder / f"m-{{level}}.{extension}")
            for k, name in enumerate(("coarse", "1 voxel", "0.5 voxels")):
                quality = mesh.levels[k].report["quality"]
                files = {
                    extension: oracle_report(args.oracle, folder / f"m-{k}.{extension}")
                    for extension in ("ply", "stl")
                }
                pairs = [files[e]["self_intersections"]["pairs"] for e in files]
                flat = [files[e]["faces_with_zero_area"] for e in files]
                inverted = mesh.levels[k].report["inverted_components"]
                angles, dihedral = quality["angle_degrees"], quality["dihedral_degrees"]
                lines.append(
                    f"| {label if k == 0 else ''} | {name} | {len(mesh.levels[k].faces):,} "
                    f"| {pairs[0]}, {pairs[1]} | {flat[0]}, {flat[1]} | {inverted} "
                    f"| {angles['minimum']:.3g} to {angles['maximum']:.6g} "
                    f"| {angles['above_150']:,} "
                    f"| {dihedral['minimum']:.4g} to {dihedral['maximum']:.5g} |"
                )
                print(lines[-1], flush=True)
                total["triangles", k] += len(mesh.levels[k].faces)
                total["caps", k] += angles["above_150"]
                total["wrong", k] += sum(pairs) + sum(flat) + inverted
    text = [
        INTRODUCTION,
        "| isosurface | level | triangles | intersecting pairs | without area | misplaced | angles "
        "| above 150 | dihedral angles |",
        "|---|---|---:|---:|---:|---:|---|---:|---|",
        *lines,
        "",
    ]
    defects = sum(total["wrong", k] for k in range(3))
    caps, triangles = total["caps", 2], total["triangles", 2]
    text += [
        f"In total: {defects} intersecting pairs, zero-area triangles and misplaced components.",
        f"At 0.5 voxels, {caps:,} of {triangles:,} triangles ({100 * caps / triangles:.3f} %) have",
        "an angle above 150 degrees; the report of a run lists them with the reason.",
        "",
    ]
    results = ROOT / "docs/results.md"
    before = results.read_text()
    if TITLE in before:
        start = before.index(TITLE)
        end = before.find("\n## ", start + 1)
        rest = before[end + 1 :] if end >= 0 else ""
        before = before[:start]
    else:
        start = before.find("\n## Fuzzed readers")
        before, rest = (
            (before[: start + 1], before[start + 1 :]) if start >= 0 else (before + "\n", "")
        )
    results.write_text(before + "\n".join(text) + "\n" + rest)
    return 1 if any(total["wrong", k] for k in range(3)) else 0


if __name__ == "__main__":
    sys.exit(main())
