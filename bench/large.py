#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes a large volume of known topology in blocks, and measures time and memory.

    /usr/bin/python3 bench/large.py TOOL FOLDER [--size 2048,2048,1024] [--compare 1024,1024,512]

The volume is a foam of 8-bit samples: a ball or a torus in each cube of 64 samples, at a random
place and of a random size and orientation. So the surface has a component per cube, and its genus
is the number of tori. It is written by slabs into FOLDER, which needs a byte per sample.

Prints the topology found, the time per c-vertex, the peak of resident memory, and with --compare
the ratios of time per c-vertex: in blocks over in memory, and one worker over two, for a volume of
that size. Needs numpy. The default size takes two minutes.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

import numpy as np

CUBE = 64  # samples
ISOVALUE = 127.5


def solids(size, seed=5):
    """Per cube (z, y, x): centre, radii and axis of its solid. The small radius of a ball is 0."""
    counts = tuple(n // CUBE for n in reversed(size))
    random = np.random.default_rng(seed)
    shape = (*counts, 3)
    axis = random.normal(size=shape)
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    is_torus = random.random(counts) < 0.5
    large = np.where(is_torus, random.uniform(10, 14, counts), random.uniform(8, 13, counts))
    small = np.where(is_torus, random.uniform(3.5, 5, counts), 0)
    reach = (large + small + 4)[..., None]
    centre = reach + random.random(shape) * (CUBE - 1 - 2 * reach)
    return centre, large, small, axis


def cube_samples(centre, large, small, axis):
    """Samples whose isosurface at 127.5 is the solid's surface; 16 per voxel of distance."""
    z, y, x = np.ogrid[:CUBE, :CUBE, :CUBE]
    p = [(x - centre[0]).astype(np.float32), (y - centre[1]).astype(np.float32),
         (z - centre[2]).astype(np.float32)]
    squared = p[0] ** 2 + p[1] ** 2 + p[2] ** 2
    if small == 0:
        distance = np.sqrt(squared) - large
    else:
        along = p[0] * axis[0] + p[1] * axis[1] + p[2] * axis[2]
        around = np.sqrt(np.maximum(squared - along ** 2, 0)) - large
        distance = np.sqrt(around ** 2 + along ** 2) - small
    return np.clip(np.rint(128 - 16 * distance), 0, 255).astype(np.uint8)


def write_volume(path, size):
    """Writes an NRRD file by slabs. Returns the number of solids and of tori."""
    centre, large, small, axis = solids(size)
    counts = large.shape
    header = (f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {size[0]} {size[1]} {size[2]}\n"
              "spacings: 1 1 1\nencoding: raw\n\n")
    with open(path, "wb") as file:
        file.write(header.encode())
        for k in range(counts[0]):
            slab = np.zeros((CUBE, size[1], size[0]), np.uint8)
            for j in range(counts[1]):
                for i in range(counts[2]):
                    at = k, j, i
                    slab[:, j * CUBE:(j + 1) * CUBE, i * CUBE:(i + 1) * CUBE] = cube_samples(
                        centre[at], large[at], small[at], axis[at])
            file.write(slab.tobytes())
    return large.size, int(np.count_nonzero(small))


def run(*command):
    """Runs a command. Returns its wall time and its peak of resident memory in bytes."""
    start = time.monotonic()
    child = subprocess.Popen([str(word) for word in command])
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))}: ended with status {status}")
    return time.monotonic() - start, usage.ru_maxrss * 1024


def extract(tool, volume, *options):
    report = volume.with_suffix(".json")
    seconds, memory = run(tool, "extract", volume, "--iso", ISOVALUE, "-q", "-o",
                          volume.with_suffix(".ply"), "--report", report, *options)
    return seconds, memory, json.loads(report.read_text())


def check(report, solid_count, torus_count):
    for level in report["levels"]:
        found = level["components"], level["genus"], level["boundary_loops"]
        if found != (solid_count, torus_count, 0) or level["self_intersections"] != 0:
            sys.exit(f"expected {solid_count} components of genus {torus_count} in all, found "
                     f"{found} and {level['self_intersections']} self-intersections")


def describe(name, seconds, memory, report):
    c_vertices = report["reference"]["c_vertices"]
    level = report["levels"][-1]
    print(f"{name}: {c_vertices:,} c-vertices, {level['triangles']:,} triangles, {seconds:.0f} s, "
          f"{1e6 * seconds / c_vertices:.2f} us per c-vertex, {memory / 2 ** 30:.2f} GiB",
          flush=True)
    return seconds / c_vertices


def two_workers(tool, volume, block, options):
    """The times of `blocks run` by one process and by two at the same time."""
    times = []
    for workers in (1, 2):
        parts = volume.parent / f"parts-{workers}"
        run("rm", "-rf", parts)
        run(tool, "blocks", "plan", volume, "--iso", ISOVALUE, *options, "--threads", 1,
            "--block-size", block, "-q", "-o", volume.with_suffix(".ply"), "--parts", parts)
        start = time.monotonic()
        children = [subprocess.Popen([str(tool), "blocks", "run", str(parts), "-q"])
                    for _ in range(workers)]
        for child in children:
            if child.wait() != 0:
                sys.exit("isoatlas blocks run failed")
        times.append(time.monotonic() - start)
        run("rm", "-rf", parts)
    return times


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("tool", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("folder", type=pathlib.Path)
    size = {"type": lambda text: tuple(map(int, text.split(",")))}
    parser.add_argument("--size", **size, default=(2048, 2048, 1024))
    parser.add_argument("--compare", **size)
    parser.add_argument("--memory", default="2GiB", help="of a block of the large volume")
    # No multiple of the cubes, so that solids cross blocks.
    parser.add_argument("--block", type=int, default=250, help="in the comparison")
    parser.add_argument("--options", default="--coarse", help="of extract; empty: half a voxel")
    arguments = parser.parse_args()
    options = arguments.options.split()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    if arguments.size != (0, 0, 0):
        volume = arguments.folder / "large.nrrd"
        counts = write_volume(volume, arguments.size)
        found = extract(arguments.tool, volume, "--memory", arguments.memory, *options)
        describe("large, in blocks", *found)
        check(found[2], *counts)
    if arguments.compare:
        volume = arguments.folder / "compared.nrrd"
        counts = write_volume(volume, arguments.compare)
        rates = []
        for name, more in (("in memory", []), ("in blocks", ["--block-size", arguments.block])):
            found = extract(arguments.tool, volume, *more, *options)
            rates.append(describe(name, *found))
            check(found[2], *counts)
        one, two = two_workers(arguments.tool, volume, arguments.block, options)
        print(f"time per c-vertex, in blocks over in memory: {rates[1] / rates[0]:.2f}")
        print(f"blocks run, one worker over two: {one:.0f} s / {two:.0f} s = {one / two:.2f}")


if __name__ == "__main__":
    main()
