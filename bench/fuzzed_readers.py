#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rewrites the table "Fuzzed readers" of docs/results.md from build/corpus/runs.tsv.

scripts/fuzz_files.sh adds a line to this file for each run.
"""

import pathlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
NAMES = {
    "nrrd": "NRRD",
    "nii": "NIfTI, Analyze",
    "mha": "MetaImage",
    "tif": "TIFF",
    "dcm": "DICOM",
    "vtk": "legacy VTK",
    "vti": "VTK XML (.vti)",
    "vtr": "VTK XML (.vtr)",
    "npy": "NumPy",
    "mrc": "MRC",
    "mgh": "MGH",
    "png": "PNG slices",
    "ply": "PLY",
    "stl": "STL",
    "obj": "OBJ",
    "off": "OFF",
    "vtp": "VTP",
    "glb": "GLB",
    "3mf": "3MF",
    "gii": "GIfTI",
    "json": "report JSON",
}
# Findings of the fuzzers; each has a test.
FINDINGS = {
    "mrc": "1: overflow for an axis with the smallest integer",
    "vtp": "1: VTK's parser allocated 2^39 bytes",
    "nii": "1: infinite loop after an empty gzip member",
    "tif": "1: listed a million channels before it checked the size",
    "mha": "1: made 100,000 file names before it opened a file",
}


def main():
    runs = [line.split("\t") for line in (ROOT / "build/corpus/runs.tsv").read_text().splitlines()]
    lines = [
        "| format | CPU seconds | executions | covered edges | findings |",
        "|---|---:|---:|---:|---|",
    ]
    total = [0, 0]
    for key, name in NAMES.items():
        mine = [[int(x) for x in run[1:]] for run in runs if run[0] == key]
        if not mine:
            continue
        seconds, executions, edges = (
            sum(r[0] for r in mine),
            sum(r[1] for r in mine),
            max(r[2] for r in mine),
        )
        total = [total[0] + seconds, total[1] + executions]
        lines.append(
            f"| {name} | {seconds:,} | {executions:,} | {edges:,} | {FINDINGS.get(key, 'none')} |"
        )
    lines.append(f"| all | {total[0]:,} | {total[1]:,} | | {len(FINDINGS)} |")
    results = ROOT / "docs/results.md"
    text = results.read_text()
    start = text.index("| format | CPU seconds | executions")
    results.write_text(text[:start] + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
