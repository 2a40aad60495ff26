#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the section "As written" of docs/results.md: self-intersections, orientation and angles of the files of all isosurfaces of the table.

  bench/as_written.py ORACLE [--data FOLDER]      (with the Python module of build/release on PYTHONPATH; about a quarter of an hour)

Each isosurface, and white noise of 64^3, is meshed coarse, at 1 and at 0.5 voxels; every level is written as .ply and as .stl. ORACLE, a judge
of meshes from outside the project, reads the files and counts. Components that are inverted or misplaced, and dihedral angles, are the product's
own figures; bench/random_volumes.py judges the former by winding numbers.
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


def judged(oracle, mesh):
    done = subprocess.run([oracle, "mesh", mesh, "--self-intersections", "--json"], capture_output=True, text=True)
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
            mesh = isoatlas.extract(volume, iso, refine=["max-distance:1vx", "max-distance:0.5vx"], **options)
            for extension in ("ply", "stl"):
                mesh.save(folder / f"m-{{level}}.{extension}")
            for k, name in enumerate(("coarse", "1 voxel", "0.5 voxels")):
                quality = mesh.levels[k].report["quality"]
                files = {e: judged(args.oracle, folder / f"m-{k}.{e}") for e in ("ply", "stl")}
                pairs = [files[e]["self_intersections"]["pairs"] for e in files]
                flat = [files[e]["faces_with_zero_area"] for e in files]
                turned = mesh.levels[k].report["inverted_components"]
                angles, dihedral = quality["angle_degrees"], quality["dihedral_degrees"]
                lines.append(f"| {label if k == 0 else ''} | {name} | {len(mesh.levels[k].faces):,} | {pairs[0]}, {pairs[1]} | {flat[0]}, {flat[1]} | {turned} | "
                             f"{angles['minimum']:.3g} to {angles['maximum']:.6g} | {angles['above_150']:,} | {dihedral['minimum']:.4g} to {dihedral['maximum']:.5g} |")
                print(lines[-1], flush=True)
                total["triangles", k] += len(mesh.levels[k].faces)
                total["caps", k] += angles["above_150"]
                total["wrong", k] += sum(pairs) + sum(flat) + turned
    text = [TITLE, "", "Written by `bench/as_written.py`. The files of every level are read back and judged exactly by an oracle from",
            "outside the project (`.ply` has doubles, `.stl` float32). Intersecting pairs and zero-area triangles are",
            "counted in the `.ply` and in the `.stl`. \"Misplaced\" are components that are inverted, or that lie inside",
            "another component than on the isosurface. Angles are those of triangles; dihedral angles are measured",
            "between triangles, inside the solid. All angles are in degrees.", "",
            "| isosurface | level | triangles | pairs that meet | without area | misplaced | angles | above 150 | dihedral angles |", "|---|---|---:|---:|---:|---:|---|---:|---|", *lines, ""]
    share = 100 * total["caps", 2] / total["triangles", 2]
    text += [f"In total: {sum(total['wrong', k] for k in range(3))} intersecting pairs, zero-area triangles and misplaced components. At 0.5 voxels,",
             f"{total['caps', 2]:,} of {total['triangles', 2]:,} triangles ({share:.3f} %) have an angle above 150 degrees; the report of a run",
             "lists them with the reason.", ""]
    results = ROOT / "docs/results.md"
    before = results.read_text()
    if TITLE in before:
        start = before.index(TITLE)
        end = before.find("\n## ", start + 1)
        rest = before[end + 1:] if end >= 0 else ""
        before = before[:start]
    else:
        start = before.find("\n## Fuzzed readers")
        before, rest = (before[:start + 1], before[start + 1:]) if start >= 0 else (before + "\n", "")
    results.write_text(before + "\n".join(text) + "\n" + rest)
    return 1 if any(total["wrong", k] for k in range(3)) else 0


if __name__ == "__main__":
    sys.exit(main())
