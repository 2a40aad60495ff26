# SPDX-License-Identifier: Apache-2.0
"""Typical code of users. test_typing.py checks its types with mypy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

import isoatlas
from isoatlas import errors, examples


def bar(stage: str, fraction: float) -> None:
    print(stage, fraction)


def use(array: npt.NDArray[np.int16], folder: Path) -> float:
    volume: isoatlas.Volume = isoatlas.read_volume(
        folder / "v.nrrd", raw_size=(1, 2, 3), raw_type="int8"
    )
    mesh: isoatlas.Mesh = isoatlas.extract(
        volume,
        300.5,
        max_distance="0.5vx",
        refine=[{"max_distance": 2, "normal_angle": "20deg"}, "max-edge:3"],
    )
    mesh = isoatlas.extract(
        array,
        3,
        spacing=[1, 2, 3],
        direction=np.eye(3),
        order="xyz",
        inside="below",
        progress=bar,
        threads=2,
    )
    mesh = isoatlas.extract(array, np.float32(3), progress=True)
    vertices: npt.NDArray[np.float64] = mesh.levels[0].vertices
    faces: npt.NDArray[np.int64] = mesh.faces
    largest: isoatlas.Component = mesh.components[0]
    size: float = largest.volume + mesh.area + float(mesh.bounds[0, 0]) + volume.spacing.x
    mask = volume.replace(array=volume.array > 3, origin=[1, 2, 3])
    mesh = isoatlas.extract(mask.array, 0.5, spacing=isoatlas.XYZ(0.2, 0.2, 1))
    page: str = mesh.to_html()
    shown: Path | None = mesh.show(folder / "m.html")
    print(size, page, shown, examples.load_protein().array, isoatlas.check(mesh)["closed"])
    mesh.save(folder / "m.glb", report="m.json", glb_per_level=True)
    verts, triangles, normals, values = isoatlas.marching_cubes(
        array, 1.5, spacing=(1.0, 1.0, 2.0), step_size=2
    )
    normal: npt.NDArray[np.float32] = normals
    report = isoatlas.check(vertices, faces, self_intersections=True, volume=volume, iso=300.5)
    either = isoatlas.read("m.ply")
    if isinstance(either, isoatlas.Mesh):
        either.save("n.ply")
    try:
        isoatlas.read_mesh("x")
    except errors.BadFileError as error:
        print(error.code.upper())
    return (
        float(report["distance"]["maximum"])
        + float(normal[0, 0])
        + float(values[0])
        + len(triangles)
        + float(verts[0, 0])
    )


def misuse(array: npt.NDArray[np.int16]) -> None:
    isoatlas.extract(array, 3, inside="up")  # type: ignore[arg-type]
    isoatlas.extract()  # type: ignore[call-arg]
    isoatlas.extract(array, 3, max_dist=2)  # type: ignore[call-arg]
    isoatlas.extract(array, 3).faces = 1  # type: ignore
    isoatlas.extract(array, 3).volume()  # type: ignore[operator]
