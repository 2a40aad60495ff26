#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the section "Volumes in blocks" of docs/results.md.

  bench/blocks.py ORACLE [--data FOLDER] [--only NAME ...] [--coarse | --distances] [--out FILE]

Meshes all isosurfaces of TOPOLOGY.tsv whole and in blocks, at level 0 and within the default bound.
ORACLE, a program from outside the project, compares each level of the blocks with the volume: the
same topology, component by component, and no self-intersections. The number of triangles is
compared with that of the whole. Exit status 1: a level fails; 77: no data or no oracle.

With --distances instead the section "Distances in blocks": the volume in one block, which must
give the same file as without blocks, the largest distance from the isosurface, measured, in blocks
of 64 and in the whole, and a requested bound, which blocks must satisfy where the whole does.

PYTHONPATH must contain the Python module of build/release. Takes about an hour, with --distances
twenty minutes; --coarse: level 0 alone, in blocks of 64, and nothing is written without --out.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import isoatlas
from oracle_check import DATA, ROOT, SKIPPED, verdict_on, write_nrrd
from results import with_new_sections

BLOCKS = ["64", "100,60,37", "128"]
TITLE = "## Volumes in blocks"
INTRODUCTION = f"""{TITLE}

Written by `bench/blocks.py`: `--block-size`, `--topology faces`, level 0 and the level within the
default bound. An oracle from outside the project compares each level with the volume: the topology
component by component, and all pairs of triangles, exactly. "Triangles" is their number divided by
that of the same level of the whole volume.
"""
HEADER = [
    "| isosurface | block | blocks | level | triangles | topology | intersecting pairs "
    "| distance proved |",
    "|---|---|---:|---|---:|---|---:|---:|",
]
DISTANCES = """## Distances in blocks

Written by `bench/blocks.py --distances`: levels within the default bound, with `--topology faces`.
"One block": the file of a run with one block compared with that of a run without blocks. The
largest distance between the mesh and the isosurface, in either direction, is measured by
`isoatlas check` at 200,000 samples, in voxels. The default bound is tested at the samples of
refinement and not proved, so measured distances can exceed it between these samples, in blocks as
in the whole. With a requested bound of half a voxel: the result in the report, which is "proved" if
the bound is proved for every point, "satisfied" if it holds at all samples, or the largest distance
and the number of Voronoi cells that cannot become smaller.
"""
DISTANCES_HEADER = [
    "| isosurface | one block | default | distance, whole | distance, blocks of 64 "
    "| 0.5 requested, whole | 0.5 requested, blocks of 64 |",
    "|---|---|---:|---:|---:|---|---|",
]


def rows_of(oracle, folder, label, path, iso, coarse):
    """Yields the row of each level, and whether it passes."""
    volume = isoatlas.read(path)
    write_nrrd(folder / "volume.nrrd", volume.array)
    voxel = min(volume.spacing)
    options = ["--topology", "faces", "--space", "voxel", *(["--coarse"] if coarse else [])]
    whole = isoatlas.extract(volume, float(iso), topology="faces", space="voxel", coarse=coarse)
    for block in BLOCKS[:1] if coarse else BLOCKS:
        mesh, report = folder / "blocks.vtm", folder / "blocks.json"
        report.unlink(missing_ok=True)  # so that a failed run cannot leave an old one
        done = subprocess.run(
            [sys.executable, "-m", "isoatlas", "extract", path, "--iso", iso, *options, "-q",
             "--block-size", block, "-o", mesh, "--report", report],
            capture_output=True, text=True,
        )
        if done.returncode not in (0, 1):
            yield f"| {label} | {block} | {done.stderr.strip()} |", False
            continue
        levels = isoatlas.read_mesh(mesh).levels
        facts = json.loads(report.read_text())
        for level, fact, reference in zip(levels, facts["levels"], whole.levels):
            status, verdict = verdict_on(
                oracle, folder / "volume.nrrd", iso, level.vertices, level.faces)
            pairs = verdict["self_intersections"]["pairs"]
            proved = fact["distance_at_most"]
            x, y, z = facts["blocks"]["counts"]
            yield (
                f"| {label} | {block.replace(',', ' x ')} | {x * y * z} "
                f"| {'coarse' if level.number == 0 else 'default bound'} "
                f"| {len(level.faces) / len(reference.faces):.2f} "
                f"| {'equal' if status == 0 else 'differs'} | {pairs} "
                f"| {'' if proved is None else f'{proved / voxel:.2f} voxels'} |"
            ), status == 0 and pairs == 0
            label = ""


def extract_to(mesh, path, iso, *options):
    """Writes the mesh within the default bound, and returns that bound in world units."""
    report = mesh.with_suffix(".json")
    report.unlink(missing_ok=True)
    subprocess.run(
        [sys.executable, "-m", "isoatlas", "extract", path, "--iso", iso, "--topology", "faces",
         "-q", *options, "-o", mesh, "--report", report],
        capture_output=True, text=True,
    )
    return json.loads(report.read_text())["levels"][-1]["constraints"][0]["bound"]


def distance_of(mesh, path, iso):
    """The largest distance between a mesh and the isosurface, and a voxel, in world units."""
    done = subprocess.run(
        [sys.executable, "-m", "isoatlas", "check", mesh, "--volume", path, "--iso", iso,
         "--topology", "faces", "--json"],
        capture_output=True, text=True,
    )
    measured = json.loads(done.stdout)["distance"]
    return measured["maximum"], measured["voxel"]


def requested_bound(mesh, path, iso, *options):
    """The result for a requested bound of half a voxel, and whether the bound is satisfied."""
    report = mesh.with_suffix(".json")
    report.unlink(missing_ok=True)
    subprocess.run(
        [sys.executable, "-m", "isoatlas", "extract", path, "--iso", iso, "--topology", "faces",
         "-q", "--refine", "max-distance:0.5vx", *options, "-o", mesh, "--report", report],
        capture_output=True, text=True,
    )
    level = json.loads(report.read_text())["levels"][-1]
    result = level["constraints"][0]
    if level["distance_at_most"] is not None:
        return "proved", True
    if result["satisfied"]:
        return "satisfied", True
    voxels = 0.5 * result["reached"] / result["bound"]
    return f"{voxels:.2f}, {level['at_limit']['count']} cells", False


def distance_rows_of(folder, label, path, iso):
    """Yields the row of a volume, and whether it passes."""
    names = whole, one, blocks = [folder / f"{name}.ply" for name in ("whole", "one", "blocks")]
    bound = extract_to(whole, path, iso)
    extract_to(one, path, iso, "--block-size", "100000")
    extract_to(blocks, path, iso, "--block-size", "64")
    same = one.read_bytes() == whole.read_bytes()
    (before, voxel), (after, _) = distance_of(whole, path, iso), distance_of(blocks, path, iso)
    in_whole, kept_in_whole = requested_bound(whole, path, iso)
    in_blocks, kept_in_blocks = requested_bound(blocks, path, iso, "--block-size", "64")
    yield (
        f"| {label} | {'equal' if same else 'differs'} | {bound / voxel:.3f} "
        f"| {before / voxel:.3f} | {after / voxel:.3f} | {in_whole} | {in_blocks} |"
    ), same and (kept_in_blocks or not kept_in_whole)
    for name in names:
        name.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("oracle", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path, default=DATA)
    parser.add_argument("--only", nargs="*", default=[""], help="parts of the names of volumes")
    parser.add_argument("--coarse", action="store_true")
    parser.add_argument("--distances", action="store_true")
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
            label = f"{entry['file']}@{entry['isovalue']}"
            volume = pathlib.Path(folder), label, args.data / entry["file"], entry["isovalue"]
            for row, passes in (distance_rows_of(*volume) if args.distances
                                else rows_of(args.oracle, *volume, args.coarse)):
                rows.append(row)
                failures += not passes
                print(row if passes else f"{row} FAILED", flush=True)
    rows_name = "volumes" if args.distances else "levels"
    summary = f"{len(rows) - failures} of {len(rows)} {rows_name} pass."
    print(summary)
    out = args.out or (None if args.coarse else ROOT / "docs/results.md")
    if out:
        head = [DISTANCES, *DISTANCES_HEADER] if args.distances else [INTRODUCTION, *HEADER]
        text = "\n".join([*head, *rows, "", summary, ""])
        out.write_text(with_new_sections(out.read_text(), text))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
