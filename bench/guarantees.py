#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the section "Guarantees past the paper" of docs/results.md.

The section has self-intersections, triangle shape and the cost of both on all isosurfaces of
TOPOLOGY.tsv. Needs the tool (build/release), the volumes and a built oracle. Takes about half an
hour.
"""

import argparse
import collections
import csv
import json
import pathlib
import random
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
TITLE = "## Guarantees past the paper"
LEVELS = ["--refine", "max-distance:1vx", "--refine", "max-distance:0.5vx"]
SMOOTH = {
    "head_igea_sdf.nrrd@0",
    "dragon_sdf.nrrd@0",
    "neuron_dendrite.nrrd@127.5",
    "ct_engine.nrrd@80.5",
}


def cpu_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        sys.exit(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def extract(tool, source, iso, folder, *options):
    report = folder / "r.json"
    outputs = ["-o", folder / "m-{level}.ply", "--space", "voxel", "--report", report]
    command = [tool, "extract", *source, "--iso", iso, *outputs, "--threads", "1", "-q"]
    seconds = cpu_seconds([*command, *LEVELS, *options])
    return json.loads(report.read_text()), seconds


def pairs(oracle, mesh):
    done = subprocess.run(
        [oracle, "mesh", mesh, "--self-intersections", "--json"], capture_output=True, text=True
    )
    return json.loads(done.stdout)["mesh"]["self_intersections"]["pairs"]


# Options that switch off one step each, then all of them.
STEPS = {
    "all (default)": [],
    "trilinear topology: `--topology faces`": ["--topology", "faces"],
    "embedding: `--allow-self-intersections`": ["--allow-self-intersections"],
    "adaptive supersampling: `--adaptive-supersample 0`": ["--adaptive-supersample", "0"],
    "shape of refined levels: `--min-aspect 0.001`": ["--min-aspect", "0.001"],
}
STEPS["all four"] = sum(STEPS.values(), [])
STEPS_ON = [
    "dragon_sdf.nrrd@0",
    "ct_engine.nrrd@128",
    "brain_white_matter.nii.gz@127.5",
    "vessels_aneurism.nrrd@60.5",
    "mri_noisy_b0.nii.gz@600",
]


def steps_table(tool, oracle, rows, folder):
    lines = []
    for label, source, iso in rows:
        if label not in STEPS_ON:
            continue
        base = None
        for step, options in STEPS.items():
            report, seconds = extract(tool, source, iso, folder, *options)
            fine = report["levels"][2]
            reached = {c["quantity"]: c["reached"] for c in fine["constraints"]}["max-distance"]
            base = base or (fine["triangles"], seconds)
            shape = fine["quality"]["aspect_ratio"]
            lines.append(
                f"| {label} | {step} | {fine['triangles']:,} | {fine['triangles'] / base[0]:.2f} "
                f"| {seconds:.1f} | {seconds / base[1]:.2f} "
                f"| {sum(pairs(oracle, folder / f'm-{k}.ply') for k in range(3))} "
                f"| {percent(shape['share_below_third'])} | {shape['minimum']:.3f} "
                f"| {reached / min(report['input']['spacing']):.3f} |"
            )
            print(lines[-1], flush=True)
    return "\n".join(lines)


def worst_triangles(label, level):
    """Table rows for the three worst triangles of a level with an aspect ratio below 0.1."""
    rows = [
        f"| {label} | {', '.join(f'{x:.1f}' for x in t['position'])} "
        f"| {t['aspect_ratio']:.3f} | {t['obstacle']} |"
        for t in level["bad_triangles"]["worst"]
        if t["aspect_ratio"] < 0.1
    ]
    return list(dict.fromkeys(rows))[:3]  # several triangles share an edge


WORST_TRIANGLES = """### Where triangles are below aspect ratio 0.1

The three worst triangles of the 0.5-voxel level on each surface, with the centroid in sample-index
coordinates and the obstacle that prevents a better position of the ends of the shortest edge. The
report lists all others (`levels[].bad_triangles`).

| surface | position | aspect ratio | obstacle |
|---|---|---:|---|
"""


def percent(share):
    return "0" if share == 0 else f"{100 * share:.2f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument("--oracle", type=pathlib.Path, required=True, help="the oracle program")
    parser.add_argument(
        "--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "bin" / "isoatlas"
    )
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs" / "results.md")
    parser.add_argument("--only", help="only rows whose name starts with this; writes no page")
    arguments = parser.parse_args()

    lines, worst = [], []
    total = collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        noise = folder / "noise.raw"
        noise.write_bytes(random.Random(1).randbytes(64**3))
        rows = [
            ("white noise 64^3", [noise, "--raw-size", "64,64,64", "--raw-type", "uint8"], "127.5")
        ]
        with open(arguments.data / "TOPOLOGY.tsv") as table:
            for row in csv.DictReader(table, delimiter="\t"):
                rows.append(
                    (
                        f"{row['file']}@{row['isovalue']}",
                        [arguments.data / row["file"]],
                        row["isovalue"],
                    )
                )
        steps = (
            "" if arguments.only else steps_table(arguments.tool, arguments.oracle, rows, folder)
        )
        for label, source, iso in rows:
            if arguments.only and not label.startswith(arguments.only):
                continue
            report, seconds = extract(arguments.tool, source, iso, folder)
            found = [pairs(arguments.oracle, folder / f"m-{k}.ply") for k in range(3)]
            without, seconds_without = extract(
                arguments.tool, source, iso, folder, "--allow-self-intersections"
            )
            found_without = [pairs(arguments.oracle, folder / f"m-{k}.ply") for k in range(3)]
            fine, fine_without = report["levels"][2], without["levels"][2]
            shape = fine["quality"]["aspect_ratio"]
            obstacles = collections.Counter(t["obstacle"] for t in fine["bad_triangles"]["worst"])
            worst += worst_triangles(label, fine)
            total.update(
                {
                    "pairs": sum(found),
                    "before": sum(found_without),
                    "triangles": fine["triangles"],
                    "bad": fine["bad_triangles"]["count"],
                }
            )
            subdivision = report["subdivision"]
            lines.append(
                f"| {label}{' (smooth)' if label in SMOOTH else ''} "
                f"| {found[0]} / {found[1]} / {found[2]} "
                f"| {found_without[0]} / {found_without[1]} / {found_without[2]} "
                f"| {fine['triangles']:,} | {fine['triangles'] / fine_without['triangles']:.2f} "
                f"| {seconds:.1f} | {seconds / seconds_without:.1f} "
                f"| {subdivision['added_c_vertices']:,} ({subdivision['max_depth']}) "
                f"| {percent(shape['share_below_third'])} | {shape['minimum']:.3f} "
                f"| {', '.join(f'{n} {o}' for o, n in obstacles.most_common()) or '-'} |"
            )
            print(lines[-1], flush=True)
    columns = (
        "surface | pairs at 0 / 1 / 0.5 voxel | without | triangles | over without | CPU s "
        "| over without | added c-vertices | below 1/3 | least | obstacles"
    )
    text = (
        f"""{TITLE}

Written by `bench/guarantees.py`. Level 0 and levels with bounds of 1 and 0.5 voxels in one run,
with default options and one thread; the independent oracle counts intersecting pairs. "Without"
means with `--allow-self-intersections` and otherwise equal options. "Added c-vertices" are those of
adaptive supersampling, with the depth in brackets. Shape is that of the 0.5-voxel level; the last
column counts the [obstacles](reference/report.md) of its triangles below 1/3, for the first 1,000.

| {columns} |
|---|---|---|---|---|---|---|---|---|---|---|
"""
        + "\n".join(lines)
        + f"""

In total: {total['pairs']} pairs ({total['before']:,} without);
{total['bad']:,} of {total['triangles']:,} triangles below 1/3.

{WORST_TRIANGLES}{chr(10).join(worst)}

### What each step costs

The same three levels with one step omitted. Pairs are those of all three levels. Triangles, shape
and the largest distance (voxels; the bound was 0.5) are those of the 0.5-voxel level. Level 0
separates its vertices in all rows, because that is not a separate step.

| surface | without | triangles | over default | CPU s | over default | pairs | below 1/3 | least \
| distance |
|---|---|---|---|---|---|---|---|---|---|
{steps}
"""
    )
    if arguments.only:
        return
    old = arguments.out.read_text()
    at = old.find(TITLE)
    arguments.out.write_text((old if at < 0 else old[:at]).rstrip() + "\n\n" + text)


if __name__ == "__main__":
    main()
