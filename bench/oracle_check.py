# SPDX-License-Identifier: Apache-2.0
"""Checks meshes with the oracle, a program from outside the project."""

import json
import os
import pathlib
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATA = pathlib.Path(os.environ.get("ISOATLAS_TEST_DATA") or ROOT.parent / "shared" / "data")
SKIPPED = 77  # exit status


def write_nrrd(path, array):
    """The samples, [z, y, x], as NRRD."""
    kinds = {"f": (np.float64, "double"), "i": (np.int64, "int64"), "u": (np.int64, "int64")}
    kind, name = kinds[array.dtype.kind]
    sizes = " ".join(map(str, array.shape[::-1]))
    header = f"NRRD0004\ntype: {name}\ndimension: 3\nsizes: {sizes}\nendian: little\n"
    path.write_bytes(f"{header}encoding: raw\n\n".encode() + array.astype(kind).tobytes())


def write_ply(path, vertices, faces):
    rows = np.empty(len(faces), dtype=[("size", "u1"), ("corners", "<i4", 3)])
    rows["size"], rows["corners"] = 3, faces
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    path.write_bytes(header.encode() + vertices.astype("<f8").tobytes() + rows.tobytes())


def verdict_on(oracle, volume, iso, vertices, faces):
    """The oracle's status and report about a mesh in sample indices of an NRRD file."""
    mesh = volume.with_suffix(".ply")
    write_ply(mesh, vertices, faces)
    done = subprocess.run(
        [oracle, "volume", volume, "--iso", iso, "--mesh", mesh, "--mesh-space", "index",
         "--rules", "c", "--no-distance", "--self-intersections", "--require", "c", "--json"],
        capture_output=True, text=True,
    )
    if done.returncode not in (0, 1):
        sys.exit(f"the oracle: exit status {done.returncode}: {done.stderr.strip()}")
    return done.returncode, json.loads(done.stdout)["mesh"]["report"]
