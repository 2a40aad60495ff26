#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Meshes random small volumes with all grids, options and file formats, and checks the files.

  bench/random_volumes.py ORACLE [--count 10000] [--first 0] [--tool build/release/bin/isoatlas]

The files are read by code that shares nothing with isoatlas: VTK, nibabel, and functions of this
script. ORACLE, a program from outside the project, counts self-intersections and triangles without
area exactly. Winding numbers check orientation and nesting: next to each component of a closed
mesh, the winding number is 1 on the inner side and 0 on the outer side. Defects in a file that was
written with status 0 are printed with the number of the volume; --first NUMBER --count 1 repeats
it.
"""

import argparse
import collections
import concurrent.futures
import json
import math
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
import zipfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
FORMATS = ["ply", "stl", "obj", "off", "vtp", "3mf", "gii", "glb"]


def rotation(rng):
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def smooth(a, times):
    for _ in range(times):
        for axis in range(3):
            a = (np.roll(a, 1, axis) + 2 * a + np.roll(a, -1, axis)) / 4
    return a


def samples(pick, rng, size):
    """The name of a random kind of volume, and its samples, around 0.5."""
    kind = pick.choice(["noise", "noise", "smooth", "mask", "ties", "sheets", "balls"])
    a = rng.random(size)
    if kind == "smooth":
        a = smooth(a, pick.randint(1, 3))
    elif kind == "mask":
        a = (smooth(a, pick.randint(0, 2)) > 0.5).astype(float)
    elif kind == "ties":
        a = np.floor(a * 5) / 4  # a quarter of the samples equal the isovalue
    elif kind == "sheets":
        a = 0.2 + 0.02 * a
        for _ in range(pick.randint(1, 4)):
            axis = pick.randrange(3)
            a[(slice(None),) * axis + (pick.randrange(size[axis]),)] += 0.5
    elif kind == "balls":
        at = np.stack(np.meshgrid(*[np.arange(n) for n in size], indexing="ij"), -1)
        centres = [
            (rng.random(3) * np.array(size), 0.5 + rng.random() * max(size) / 3)
            for _ in range(pick.randint(1, 5))
        ]
        a = 0.5 + np.max([r - np.linalg.norm(at - c, axis=-1) for c, r in centres], axis=0)
    return kind, a


def grid(pick, rng):
    """The name of a random kind of grid, its spacing, direction (axes in columns) and origin."""
    kind = pick.choice(["plain", "plain", "rotated", "mirrored", "anisotropic", "far", "very far"])
    spacing, direction, origin = np.ones(3), np.eye(3), np.zeros(3)
    if kind != "plain":
        direction = rotation(rng)
        spacing = np.full(3, 0.1 + rng.random())
    if kind == "mirrored":
        direction[:, 0] *= -1
    if kind == "anisotropic":
        spacing = spacing * np.array(pick.choice([(1, 1, 6), (1, 3, 1), (0.2, 1, 1), (1, 1, 40)]))
    if kind == "far":
        origin = 10 ** pick.uniform(1, 4) * rng.normal(size=3)
    if kind == "very far":
        spacing = np.ones(3)
        origin = 10 ** pick.uniform(4, 10.5) * np.sign(rng.normal(size=3))
    return kind, spacing, direction, origin


def options(pick):
    # A copy, because more options are appended.
    out = list(
        pick.choice(
            [
                [],
                [],
                ["--coarse"],
                ["--coarse"],
                ["--refine=max-distance:1vx", "--refine=max-distance:0.5vx"],
                ["--max-distance", "0.3vx"],
                ["--min-aspect", "0.3"],
            ]
        )
    )
    if pick.random() < 0.1:
        out += ["--supersample", "2"]
    if pick.random() < 0.1:
        out += ["--topology", "faces"]
    if pick.random() < 0.1 and "--coarse" not in out:
        out += ["--placement", "balanced"]
    if pick.random() < 0.05:
        out += ["--covering", "halving"]
    if pick.random() < 0.1:
        out += ["--interpolation", "tricubic"]
    if pick.random() < 0.1:
        out += ["--keep-components", "1"]
    if pick.random() < 0.3:
        out += ["--space", pick.choice(["voxel", "ras"])]
    if pick.random() < 0.05:
        out += ["--adaptive-supersample", "0"]
    return out


def write_nrrd(path, a, spacing, direction, origin):
    vectors = " ".join(
        "(" + ",".join(repr(float(x)) for x in direction[:, k] * spacing[k]) + ")" for k in range(3)
    )
    header = (
        "NRRD0004\ntype: double\ndimension: 3\nspace: left-posterior-superior\n"
        f"sizes: {' '.join(map(str, a.shape))}\nspace directions: {vectors}\n"
        f"space origin: ({','.join(repr(float(x)) for x in origin)})\n"
        "endian: little\nencoding: raw\n\n"
    )
    path.write_bytes(header.encode() + a.astype("<f8").tobytes(order="F"))


def read_text_mesh(path):
    vertices, faces = [], []
    lines = [line.split("#")[0].split() for line in path.read_text().splitlines()]
    lines = [line for line in lines if line]
    if path.suffix == ".obj":
        for line in lines:
            if line[0] == "v":
                vertices.append([float(x) for x in line[1:4]])
            elif line[0] == "f":
                faces.append([int(x.split("/")[0]) - 1 for x in line[1:4]])
    else:
        vertex_count, face_count = int(lines[1][0]), int(lines[1][1])
        vertices = [[float(x) for x in line[:3]] for line in lines[2 : 2 + vertex_count]]
        faces = [
            [int(x) for x in line[1:4]]
            for line in lines[2 + vertex_count : 2 + vertex_count + face_count]
        ]
    return np.array(vertices), np.array(faces)


def read_ply(path):
    data = path.read_bytes()
    end = data.index(b"end_header\n") + 11
    header = data[:end].decode().split("\n")
    counts = [int(line.split()[2]) for line in header if line.startswith("element")]
    properties = [
        line.split()[1] for line in header if line.startswith("property") and "list" not in line
    ]
    names = [
        line.split()[2] for line in header if line.startswith("property") and "list" not in line
    ]
    types = {"double": "<f8", "float": "<f4", "uchar": "u1", "uint": "<u4", "int": "<i4"}
    vertex = np.dtype([(n, types[p]) for n, p in zip(names, properties)])
    v = np.frombuffer(data, vertex, counts[0], end)
    f = np.frombuffer(
        data, np.dtype([("n", "u1"), ("i", "<u4", 3)]), counts[1], end + vertex.itemsize * counts[0]
    )
    return np.stack([v["x"], v["y"], v["z"]], -1).astype(float), f["i"].astype(np.int64)


def read_stl(path):
    data = path.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(data, triangle, count, 84)["corners"].reshape(-1, 3)
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    return vertices.astype(float), index.reshape(-1, 3)


def read_glb(path):
    """Read the finest level, without its translation."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    j = json.loads(data[20 : 20 + length])
    binary = data[28 + length :]

    def array(accessor, kind, width):
        a = j["accessors"][accessor]
        view = j["bufferViews"][a["bufferView"]]
        return np.frombuffer(binary, kind, a["count"] * width, view.get("byteOffset", 0)).reshape(
            -1, width
        )

    mesh = j["meshes"][0]["primitives"][0]
    positions = array(mesh["attributes"]["POSITION"], "<f4", 3).astype(float)
    return positions, array(mesh["indices"], "<u4", 1).reshape(-1, 3)


def read_3mf(path):
    with zipfile.ZipFile(path) as archive:
        root = xml.etree.ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    name = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    vertices = [[float(v.get(k)) for k in "xyz"] for v in root.iter(name + "vertex")]
    corners = ("v1", "v2", "v3")
    faces = [[int(t.get(corner)) for corner in corners] for t in root.iter(name + "triangle")]
    return np.array(vertices), np.array(faces)


def read_gii(path):
    import nibabel

    image = nibabel.load(path)
    return image.agg_data("pointset").astype(float), image.agg_data("triangle")


def read_vtp(path):
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    mesh = reader.GetOutput()
    return (
        vtk_to_numpy(mesh.GetPoints().GetData()).astype(float),
        vtk_to_numpy(mesh.GetPolys().GetData()).reshape(-1, 4)[:, 1:],
    )


READERS = {
    ".ply": read_ply,
    ".stl": read_stl,
    ".obj": read_text_mesh,
    ".off": read_text_mesh,
    ".vtp": read_vtp,
    ".3mf": read_3mf,
    ".gii": read_gii,
    ".glb": read_glb,
}


def winding(vertices, faces, p):
    """The winding number of a closed mesh around the point p."""
    a, b, c = (vertices[faces[:, k]] - p for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    over = np.einsum("ij,ij->i", a, np.cross(b, c))
    under = (
        la * lb * lc
        + np.einsum("ij,ij->i", a, b) * lc
        + np.einsum("ij,ij->i", b, c) * la
        + np.einsum("ij,ij->i", c, a) * lb
    )
    return np.arctan2(over, under).sum() / (2 * math.pi)


def components(faces, count):
    """Per face, the smallest vertex of its component."""
    parent = np.arange(count)
    while True:  # spreads the smallest vertex of each component
        low = parent[faces].min(axis=1)
        new = parent.copy()
        for k in range(3):
            np.minimum.at(new, faces[:, k], low)
        if np.array_equal(new, parent):
            return parent[faces[:, 0]]
        parent = new


def misplaced(vertices, faces):
    """Number of components with wrong winding numbers at their largest triangle.

    They must be 0 on its outer side and 1 on its inner side.
    """
    scale = np.ptp(vertices, axis=0).max()
    vertices = (vertices - vertices.mean(axis=0)) / scale
    normal = np.cross(
        vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]]
    )
    area = np.linalg.norm(normal, axis=1)
    component = components(faces, len(vertices))
    wrong = 0
    for c in np.unique(component):
        mine = np.flatnonzero(component == c)
        t = mine[np.argmax(area[mine])]
        centre, n = vertices[faces[t]].mean(axis=0), normal[t] / area[t]
        # The points must be closer to the triangle than any other triangle of an embedded mesh.
        # If they are not, smaller steps are tried.
        for step in (1e-6, 1e-8, 1e-10):
            outer = winding(vertices, faces, centre + step * n)
            inner = winding(vertices, faces, centre - step * n)
            if abs(outer) < 1e-3 and abs(inner - 1) < 1e-3:
                break
        else:
            wrong += 1
    return wrong


def check(number, tool, oracle, folder):
    """Mesh the random volume of this number. Returns its kinds, the status and the defects."""
    pick, rng = random.Random(number), np.random.default_rng(number)
    size = tuple(pick.randint(3, 9) for _ in range(3))
    kind, a = samples(pick, rng, size)
    grid_kind, spacing, direction, origin = grid(pick, rng)
    inside = pick.choice(["above", "below"])
    closed = pick.random() < 0.75
    if closed:
        a = np.pad(a, 1, constant_values=-0.5 if inside == "above" else 1.5)
    extension = pick.choice(FORMATS)
    chosen = options(pick)
    volume, mesh, copy = (
        folder / f"{number}{end}" for end in (".nrrd", "." + extension, ".oracle.off")
    )
    write_nrrd(volume, a, spacing, direction, origin)
    command = [tool, "extract", volume, "--iso", "0.5", "--inside", inside, "-o", mesh]
    command += ["--threads", "1", "-q", *chosen]
    done = subprocess.run(command, capture_output=True, text=True)
    result = {
        "number": number,
        "status": done.returncode,
        "samples": kind,
        "grid": grid_kind,
        "format": extension,
        "options": " ".join(chosen),
        "message": done.stderr.strip(),
    }
    if done.returncode in (0, 1):
        vertices, faces = READERS[mesh.suffix](mesh)
        with copy.open("w") as out:
            out.write(f"OFF\n{len(vertices)} {len(faces)} 0\n")
            out.writelines(" ".join(repr(float(x)) for x in v) + "\n" for v in vertices)
            out.writelines(f"3 {f[0]} {f[1]} {f[2]}\n" for f in faces)
        output = subprocess.run(
            [oracle, "mesh", copy, "--self-intersections", "--json"], capture_output=True, text=True
        ).stdout
        report = json.loads(output)["mesh"]
        result["triangles"] = len(faces)
        result["pairs"] = report["self_intersections"]["pairs"]
        result["without area"] = report["faces_with_zero_area"]
        result["misplaced"] = (
            misplaced(vertices, faces) if closed and "keep" not in result["options"] else 0
        )
    for path in (volume, mesh, copy):
        path.unlink(missing_ok=True)
    return result


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    arguments.add_argument("oracle", type=pathlib.Path)
    arguments.add_argument("--tool", type=pathlib.Path, default=ROOT / "build/release/bin/isoatlas")
    arguments.add_argument("--count", type=int, default=10000)
    arguments.add_argument("--first", type=int, default=0)
    arguments.add_argument("--jobs", type=int, default=2)
    args = arguments.parse_args()
    total, by_grid, bad = collections.Counter(), collections.Counter(), 0
    with (
        tempfile.TemporaryDirectory() as folder,
        concurrent.futures.ProcessPoolExecutor(args.jobs) as pool,
    ):
        numbers = range(args.first, args.first + args.count)
        jobs = [
            pool.submit(check, n, args.tool, args.oracle, pathlib.Path(folder)) for n in numbers
        ]
        for job in jobs:
            r = job.result()
            total[f"status {r['status']}"] += 1
            wrong = {k: r[k] for k in ("pairs", "without area", "misplaced") if r.get(k)}
            total["triangles"] += r.get("triangles", 0)
            if r["status"] == 0:
                for k, v in wrong.items():
                    total[k] += v
                bad += bool(wrong)
            by_grid[f"{r['grid']}: status {r['status']}"] += 1
            if (
                (r["status"] == 0 and wrong)
                or r["status"] not in (0, 1, 2)
                or (r["status"] == 1 and wrong)
            ):
                print(json.dumps(r), flush=True)
            elif (
                r["status"] == 2
                and "empty" not in r["message"]
                and "no surface" not in r["message"]
                and "float" not in r["message"]
            ):
                print(json.dumps(r), flush=True)
    print(f"{args.count} volumes: " + ", ".join(f"{v} {k}" for k, v in sorted(total.items())))
    print(", ".join(f"{v} {k}" for k, v in sorted(by_grid.items())))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
