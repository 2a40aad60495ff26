# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from typing import Any, Literal, Sequence

import numpy as np
import numpy.typing as npt

from ._arrays import Array, as_samples, as_triple
from ._extract import Side, extract
from ._progress import ProgressLike
from ._words import Length, Number, Refine
from .errors import BadArgumentError

_CHUNK = 65_536  # vertices whose surroundings are looked up at once: keeps the copies small


def marching_cubes(
    volume: npt.ArrayLike,
    level: Number | None = None,
    *,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    gradient_direction: Literal["descent", "ascent"] = "descent",
    step_size: int = 1,
    allow_degenerate: bool = True,
    method: Literal["lewiner", "lorensen"] = "lewiner",
    mask: npt.ArrayLike | None = None,
    max_distance: Length | None = None,
    refine: Refine | None = None,
    coarse: bool = False,
    allow_self_intersections: bool = False,
    nan: Side | None = None,
    progress: ProgressLike = None,
    threads: int | None = None,
) -> tuple[npt.NDArray[Any], npt.NDArray[np.int32], npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """In place of ``skimage.measure.marching_cubes``: the same arguments, the same four results; another mesh.

    What is different: the mesh is `extract`'s, adaptive, with far fewer triangles, within half a voxel of the surface by default (scikit-image's
    is finer than that), and of certified topology. A sample equal to ``level`` is inside. NaN is refused unless ``nan`` says where it is.
    ``mask`` is not supported.

    Parameters
    ----------
    volume : (M, N, P) array
        As for `extract`; never converted to float32.
    level : float, optional
        Default: half-way between the least and the largest sample.
    spacing : 3 floats
        In the order of the array's axes.
    gradient_direction : {"descent", "ascent"}
        As in scikit-image, where it goes by the left hand: with ``"descent"`` faces are clockwise seen from where samples are lower.
    step_size : int
        Only every so manieth sample along each axis is looked at.
    allow_degenerate : bool
        No triangle is degenerate, whatever it is.
    method : {"lewiner", "lorensen"}
        The mesh is the same with both.
    mask : None
        ``NotImplementedError`` for anything else.
    max_distance, refine, coarse, allow_self_intersections, nan, progress, threads
        As for `extract`, which scikit-image does not have.

    Returns
    -------
    verts : (V, 3) float32, or float64 with a ``spacing``
        In the order of the array's axes.
    faces : (F, 3) int32
    normals : (V, 3) float32
        Of length 1, down the gradient of the data at each vertex, towards lower samples. With a ``spacing`` they are those of the world;
        scikit-image's are those of the grid.
    values : (V,) float32
        The largest sample at the corners of the cell that a vertex is in.

    Raises
    ------
    ValueError
        ``level`` is not within the range of the samples; the array is not 3-D, or has less than 2 samples along an axis; and as `extract`.
    """
    if mask is not None:
        raise NotImplementedError("mask is not supported: cut the array, or set what is not wanted to a value below the level")
    if gradient_direction not in ("descent", "ascent"):
        raise BadArgumentError(f"gradient_direction: expected one of descent, ascent, got {gradient_direction!r}")
    if method not in ("lewiner", "lorensen"):
        raise BadArgumentError(f"method: expected one of lewiner, lorensen, got {method!r}")
    step = int(step_size)
    if step < 1:
        raise BadArgumentError(f"step_size: expected a whole number, 1 or more, got {step_size!r}")
    array = as_samples(volume)[::step, ::step, ::step]
    world = as_triple(spacing, "spacing")
    if level is None:
        if array.size == 0:
            raise BadArgumentError(f"the array has no samples, its shape is {array.shape}")
        # What is not finite has a side, but no place between the others; without one extract() says that it is there.
        samples = array[np.isfinite(array)] if array.dtype.kind == "f" else array
        level = 0.5 * float(samples.min()) + 0.5 * float(samples.max()) if samples.size else 0.0
    elif not math.isfinite(level):
        raise BadArgumentError(f"level: expected a finite number, got '{level}'")
    steps = (world[0] * step, world[1] * step, world[2] * step)
    mesh = extract(
        array,
        level,
        spacing=steps,
        max_distance=max_distance,
        refine=refine,
        coarse=coarse,
        allow_self_intersections=allow_self_intersections,
        nan=nan,
        progress=progress,
        threads=threads,
    )
    faces = mesh.faces.astype(np.int32)
    if gradient_direction == "descent":
        faces = faces[:, ::-1]
    normals, values = _from_data(array, mesh.vertices, mesh.faces, np.asarray(steps))
    vertices: npt.NDArray[Any] = mesh.vertices.astype(np.float32) if world == (1.0, 1.0, 1.0) else mesh.vertices.copy()
    return vertices, faces, normals.astype(np.float32), values.astype(np.float32)


def _from_data(
    array: Array, vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.uint32], spacing: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Normals, of length 1, against the gradient of the data, and the largest sample of the cell around each vertex."""
    normals = np.empty(vertices.shape)
    values = np.empty(len(vertices))
    with np.errstate(invalid="ignore"):  # infinite and NaN samples, if they are allowed
        for begin in range(0, len(vertices), _CHUNK):
            piece = slice(begin, begin + _CHUNK)
            gradients, values[piece] = _gradients(array, vertices[piece] / spacing)
            normals[piece] = -gradients / spacing
        lengths = np.linalg.norm(normals, axis=1)
        normals /= lengths[:, np.newaxis]
    flat = ~(np.isfinite(lengths) & (lengths > 0))
    if flat.any():  # the data say nothing there: the mesh does
        normals[flat] = _mesh_normals(vertices, faces)[flat]
    return normals, values


def _gradients(array: Array, points: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Central differences at the corners of each point's cell, interpolated; and the largest sample of the corners. In steps of the grid."""
    last = np.array(array.shape) - 1
    cells = np.clip(np.floor(points).astype(np.intp), 0, last - 1)
    inside = np.clip(points - cells, 0.0, 1.0)
    gradients = np.zeros(points.shape)
    largest = np.full(len(points), -np.inf)
    for corner in np.ndindex(2, 2, 2):
        index = cells + corner
        weight = np.where(corner, inside, 1.0 - inside).prod(axis=1)
        largest = np.fmax(largest, array[tuple(index.T)].astype(np.float64))
        for axis in range(3):
            before, after = index.copy(), index.copy()
            before[:, axis] = np.maximum(index[:, axis] - 1, 0)
            after[:, axis] = np.minimum(index[:, axis] + 1, last[axis])
            difference = array[tuple(after.T)].astype(np.float64) - array[tuple(before.T)].astype(np.float64)
            gradients[:, axis] += weight * difference / (after[:, axis] - before[:, axis])
    return gradients, largest


def _mesh_normals(vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.uint32]) -> npt.NDArray[np.float64]:
    """Those of the triangles around each vertex, by area."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    areas = np.cross(b - a, c - a)
    normals = np.zeros(vertices.shape)
    for corner in range(3):
        np.add.at(normals, faces[:, corner], areas)
    lengths = np.linalg.norm(normals, axis=1)
    lengths[lengths == 0] = 1
    unit: npt.NDArray[np.float64] = normals / lengths[:, np.newaxis]
    return unit
