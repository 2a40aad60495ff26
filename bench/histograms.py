#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the histograms of the paper's figure 12 as an SVG.

They compare the aspect ratios of the triangles of marching cubes and isoatlas.

    /usr/bin/python3 bench/histograms.py ISOATLAS VOLUME.nrrd ISOVALUE OUT.svg [extract options]

Needs Debian's python3-vtk9 and python3-numpy.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy
import vtk
from picture import read_nrrd
from vtk.util import numpy_support

BINS = 20
WIDTH, HEIGHT, MARGIN = 360, 220, 46


def marching_cubes(volume, isovalue):
    """The number of triangles, and the share of triangles per bin of the aspect ratio."""
    image = read_nrrd(volume)
    surface = vtk.vtkMarchingCubes()
    surface.SetInputData(image)
    surface.SetValue(0, isovalue)
    surface.ComputeNormalsOff()
    surface.Update()
    mesh = surface.GetOutput()
    points = numpy_support.vtk_to_numpy(mesh.GetPoints().GetData()).astype(float)
    corners = numpy_support.vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    edges = numpy.linalg.norm(points[corners] - points[numpy.roll(corners, 1, axis=1)], axis=2)
    ratio = edges.min(axis=1) / edges.max(axis=1)
    return len(ratio), numpy.histogram(ratio, BINS, (0, 1))[0] / len(ratio)


def ours(tool, volume, isovalue, options):
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "r.json"
        outputs = ["-o", pathlib.Path(folder) / "m.ply", "--report", report, "-q"]
        subprocess.run([tool, "extract", volume, "--iso", str(isovalue), *outputs, *options])
        level = json.loads(report.read_text())["levels"][-1]
    counts = numpy.array(level["quality"]["aspect_ratio"]["histogram"])
    return level["triangles"], counts / counts.sum()


def chart(x, title, shares, top):
    out = [
        f'<g transform="translate({x},0)">',
        f'<text x="{MARGIN}" y="22" font-size="14">{title}</text>',
    ]
    w, h = WIDTH - MARGIN - 10, HEIGHT - 40 - 36
    for k in range(0, 5):
        y = 40 + h - h * k / 4
        out.append(
            f'<line x1="{MARGIN}" y1="{y:.1f}" x2="{MARGIN + w}" y2="{y:.1f}" stroke="#ddd"/>'
            f'<text x="{MARGIN - 6}" y="{y + 4:.1f}" font-size="11" text-anchor="end">'
            f"{100 * top * k / 4:.0f} %</text>"
        )
    for k, share in enumerate(shares):
        bar = h * share / top
        colour = "#c8553d" if (k + 1) / BINS <= 0.35 else "#3a6ea5"
        out.append(
            f'<rect x="{MARGIN + w * k / BINS + 1:.1f}" y="{40 + h - bar:.1f}" '
            f'width="{w / BINS - 2:.1f}" height="{bar:.1f}" fill="{colour}"/>'
        )
    third = MARGIN + w / 3
    out.append(
        f'<line x1="{third:.1f}" y1="36" x2="{third:.1f}" y2="{40 + h}" '
        f'stroke="#555" stroke-dasharray="4 3"/>'
        f'<text x="{third + 4:.1f}" y="48" font-size="11">1/3</text>'
    )
    for k in range(0, 6):
        out.append(
            f'<text x="{MARGIN + w * k / 5:.1f}" y="{40 + h + 16}" font-size="11" '
            f'text-anchor="middle">{k / 5:g}</text>'
        )
    out.append(
        f'<text x="{MARGIN + w / 2}" y="{40 + h + 31}" font-size="11" '
        f'text-anchor="middle">shortest / longest edge</text></g>'
    )
    return "\n".join(out)


def main():
    tool, volume, isovalue, out, *options = sys.argv[1:]
    theirs, mine = marching_cubes(volume, float(isovalue)), ours(tool, volume, isovalue, options)
    top = max(theirs[1].max(), mine[1].max()) * 1.05
    pathlib.Path(out).write_text(
        "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH}" height="{HEIGHT}" '
                'font-family="sans-serif" fill="#222">',
                '<rect width="100%" height="100%" fill="white"/>',
                chart(0, f"marching cubes, {theirs[0]:,} triangles", theirs[1], top),
                chart(WIDTH, f"isoatlas, {mine[0]:,} triangles", mine[1], top),
                "</svg>",
                "",
            ]
        )
    )


if __name__ == "__main__":
    main()
