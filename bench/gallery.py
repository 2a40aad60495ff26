#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/gallery.md and its pictures.

The gallery shows volumes similar to the four data sets of the paper at four levels each, smooth
and as hidden-line drawings, as in the paper's figures 11, 13, 14 and 15. Needs the tool
(build/release), the volumes, and Python with VTK (scripts/install_dependencies.sh bench). Takes a
few minutes. Run it with Debian's interpreter: /usr/bin/python3.
"""

import argparse
import json
import pathlib
import re
import shlex
import subprocess
import tempfile
import textwrap

from vtkmodules.vtkFiltersCore import vtkImageAppend
from vtkmodules.vtkIOImage import vtkJPEGWriter, vtkPNGReader, vtkPNGWriter

ROOT = pathlib.Path(__file__).resolve().parent.parent
TILE = "400,400"
INTRODUCTION = """# Gallery

Volumes similar to the paper's data sets, at four levels each, as in its figures 11, 13, 14 and 15.
Made by `bench/gallery.py`. Every level is certified to have the topology of the isosurface, and has
no self-intersections. The upper pictures are smooth-shaded; the lower ones show the same triangles
as hidden-line drawings (`isoatlas picture --style hidden-line`).

Where a number of vertices comes first, as in the paper's figures, the bound on the distance cannot
be satisfied: `isoatlas extract` writes everything and exits with status 1."""
STYLES = {"smooth": ("jpg", vtkJPEGWriter), "hidden-line": ("png", vtkPNGWriter)}


def to_vertices(*counts):
    """Levels with these numbers of vertices, and the smallest error that they allow."""
    return [f"max-vertices:{n},max-distance:0.05vx" for n in counts]


# Name, title, file, options of extract, options of picture, the levels after level 0 (with the
# numbers of triangles of the paper, or with bounds), and the triangles in the paper.
DATA = [
    (
        "head",
        "Head (figure 11)",
        "head_igea_sdf.nrrd",
        ["--iso", "0", "--inside", "below", "--max-radius", "43vx"],
        ["--view", "0.35,-1,0.2"],
        to_vertices(181, 2145, 4378),
        "38, 358, 4,286 and 8,752",
    ),
    (
        "brain",
        "Brain (figure 13)",
        "brain_fa.nii.gz",
        ["--iso", "0.3"],
        ["--view", "-0.8,-0.7,0.5"],
        [f"max-distance:{bound}vx" for bound in (1, 0.5, 0.35)],
        "10,606, 16,354, 37,002 and 49,734, of the volume supersampled eight times",
    ),
    (
        "dendrite",
        "Dendrite (figure 14)",
        "neuron_dendrite.nrrd",
        ["--iso", "127.5"],
        ["--view", "0,-0.3,1", "--up", "1,0,0"],
        to_vertices(6449, 10824, 31953),
        "3,974, 12,898, 21,648 and 63,906",
    ),
    (
        "dragon",
        "Dragon (figure 15)",
        "dragon_sdf.nrrd",
        ["--iso", "0", "--inside", "below"],
        ["--view", "0,-1,0.15"],
        to_vertices(9249, 20955, 32710),
        "4,020, 18,498, 41,910 and 65,420",
    ),
]


def commands(short, source, options, refine, view):
    """Shell commands for a data set, as on the page: the levels, and one of the pictures."""
    extract = shlex.join(["isoatlas", "extract", source, *options, *refine, "-o", f"{short}.glb"])
    style = ["--level", "3", "--style", "hidden-line", "--size", TILE]
    picture = shlex.join(
        ["isoatlas", "picture", f"{short}.glb", *style, *view, "-o", f"{short}.png"]
    )
    # Keeps an option and its value on one line.
    together = [
        re.sub(r"( --?[a-z-]+) ", "\\1\N{NO-BREAK SPACE}", command)
        for command in (extract, picture)
    ]
    lines = [
        textwrap.wrap(
            command, 94, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False
        )
        for command in together
    ]
    return "\n".join(" \\\n".join(command) for command in lines).replace("\N{NO-BREAK SPACE}", " ")


def run(command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(map(str, command))}: {done.stderr.strip()}")


def side_by_side(pictures, out, writer):
    append = vtkImageAppend()
    append.SetAppendAxis(0)
    for picture in pictures:
        reader = vtkPNGReader()
        reader.SetFileName(str(picture))
        append.AddInputConnection(reader.GetOutputPort())
    write = writer()
    write.SetInputConnection(append.GetOutputPort())
    write.SetFileName(str(out))
    if writer is vtkJPEGWriter:
        write.SetQuality(88)
    write.Write()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=pathlib.Path, default=ROOT.parent / "shared" / "data")
    parser.add_argument(
        "--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "bin" / "isoatlas"
    )
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs")
    parser.add_argument("--only", help="write only the pictures of this name, and no page")
    arguments = parser.parse_args()
    images = arguments.out / "images" / "gallery"
    images.mkdir(parents=True, exist_ok=True)

    text = [
        INTRODUCTION,
    ]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for short, title, source, options, view, levels, of_the_paper in DATA:
            if arguments.only not in (None, short):
                continue
            refine = [part for level in levels for part in ("--refine", level)]
            outputs = ["-o", folder / "m.glb", "--report", folder / "r.json", "-q"]
            volume = arguments.data / source
            run([arguments.tool, "extract", volume, *options, *refine, *outputs])
            report = json.loads((folder / "r.json").read_text())
            for style, (extension, writer) in STYLES.items():
                pictures = [folder / f"{style}-{k}.png" for k in range(4)]
                for k, picture in enumerate(pictures):
                    command = [arguments.tool, "picture", folder / "m.glb", "--level", k]
                    command += ["--style", style, "--size", TILE, *view, "-o", picture, "-q"]
                    run(command)
                side_by_side(pictures, images / f"{short}-{style}.{extension}", writer)
            voxel = min(report["input"]["spacing"])
            counts = [f"{level['triangles']:,}" for level in report["levels"]]
            errors = [
                f"{level['metrics']['max-distance']['maximum'] / voxel:.3g}"
                for level in report["levels"]
            ]
            genus, components = report["reference"]["genus"], report["reference"]["components"]
            text += [
                "",
                f"## {title}",
                "",
                f"`{source}`: {components:,} component{'s' if components > 1 else ''}, "
                f"total genus {genus:,}.",
                f"Triangles: {', '.join(counts[:3])} and {counts[3]}.",
                f"Triangles in the paper: {of_the_paper}.",
                f"Largest distance from the isosurface: {', '.join(errors[:3])} and {errors[3]} "
                "voxels.",
                "",
            ]
            print(text[-6], flush=True)
            text += [
                f"[![{title}, smooth](images/gallery/{short}-smooth.jpg)](../bench/gallery.py)",
                "",
                f"[![{title}, hidden lines](images/gallery/{short}-hidden-line.png)]"
                "(../bench/gallery.py)",
                "",
                f"Made by [bench/gallery.py](../bench/gallery.py) `--only {short}`, which runs",
                "these commands, the second one for each level and style:",
                "",
                "```sh",
                *commands(short, source, options, refine, view).splitlines(),
                "```",
            ]
    if arguments.only is None:
        (arguments.out / "gallery.md").write_text("\n".join(text) + "\n")


if __name__ == "__main__":
    main()
