# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from typing import Any, Literal, Sequence

import numpy as np
import numpy.typing as npt

from ._arrays import Array, as_samples, as_triple
from ._extract import Side, extract
from ._progress import ProgressLike
from ._volume import XYZ
from ._words import Length, Number, Refine
from .errors import BadArgumentError

_CHUNK = 65_536  # vertices processed at a time: limits the size of temporary arrays


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
) -> tuple[
    npt.NDArray[Any], npt.NDArray[np.int32], npt.NDArray[np.float32], npt.NDArray[np.float32]
]:
    """Replace ``skimage.measure.marching_cubes``: the same arguments and the same four results.

    The mesh differs: it is the mesh of `extract`, adaptive, with certified topology and far fewer
    triangles. By default it is within half a voxel of the isosurface; scikit-image's mesh is
    closer. A sample equal to ``level`` is inside. NaN is refused unless ``nan`` assigns it to a
    side. ``mask`` is not supported.

    Parameters
    ----------
    volume : (M, N, P) array
        As for `extract`; never converted to float32.
    level : float, optional
        The isovalue. Default: the mean of the smallest and the largest sample.
    spacing : 3 floats
        Distance between samples along each axis, in the order of the array's axes.
    gradient_direction : {"descent", "ascent"}
        As in scikit-image, which uses the left-hand rule: with ``"descent"``, faces are clockwise
        seen from the side of lower samples.
    step_size : int
        Use only every n-th sample along each axis.
    allow_degenerate : bool
        No effect: no triangle is degenerate.
    method : {"lewiner", "lorensen"}
        No effect: both give the same mesh.
    mask : None
        Any other value raises ``NotImplementedError``.
    max_distance, refine, coarse, allow_self_intersections, nan, progress, threads
        As for `extract`. scikit-image does not have these arguments.

    Returns
    -------
    verts : (V, 3) float32 array; float64 with a ``spacing``
        Coordinates in the order of the array's axes.
    faces : (F, 3) int32 array
        Indices of vertices.
    normals : (V, 3) float32 array
        Unit normals: the negative gradient of the data at each vertex, so they point towards lower
        samples. With a ``spacing`` they are in world coordinates; scikit-image's are in grid
        coordinates.
    values : (V,) float32 array
        Per vertex, the largest sample at the corners of the grid cell that contains it.

    Raises
    ------
    ValueError
        ``level`` is outside the range of the samples, the array is not 3-D, or it has fewer than 2
        samples along an axis.
    isoatlas.Error
        As for `extract`.
    """
    if mask is not None:
        raise NotImplementedError(
            "mask is not supported: crop the array, "
            "or set unwanted samples to a value below the level"
        )
    if gradient_direction not in ("descent", "ascent"):
        raise BadArgumentError(
            f"gradient_direction: expected one of descent, ascent, got {gradient_direction!r}"
        )
    if method not in ("lewiner", "lorensen"):
        raise BadArgumentError(f"method: expected one of lewiner, lorensen, got {method!r}")
    step = int(step_size)
    if step < 1:
        raise BadArgumentError(f"step_size: expected a whole number, 1 or more, got {step_size!r}")
    if isinstance(spacing, XYZ):
        raise BadArgumentError(
            "spacing: it is that of a Volume, in the order x, y, z; "
            "expected the order of the array's axes: spacing=volume.spacing[::-1]"
        )
    array = as_samples(volume)[::step, ::step, ::step]
    world = as_triple(spacing, "spacing")
    if level is None:
        if array.size == 0:
            raise BadArgumentError(f"the array has no samples, its shape is {array.shape}")
        # The range is that of the finite samples. extract() refuses the others unless `nan` is set.
        samples = array[np.isfinite(array)] if array.dtype.kind == "f" else array
        level = 0.5 * float(samples.min()) + 0.5 * float(samples.max()) if samples.size else 0.0
    elif not math.isfinite(level):
        raise BadArgumentError(f"level: expected a finite number, got '{level}'")
    steps = (world[0] * step, world[1] * step, world[2] * step)
    mesh = extract(
        array,
        level,
        spacing=steps,
        order="ijk",
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
    vertices: npt.NDArray[Any] = (
        mesh.vertices.astype(np.float32) if world == (1.0, 1.0, 1.0) else mesh.vertices.copy()
    )
    return vertices, faces, normals.astype(np.float32), values.astype(np.float32)


def _from_data(
    array: Array,
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.int64],
    spacing: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Unit normals against the gradient of the data, and the largest sample of the grid cell.

    Both are per vertex.
    """
    normals = np.empty(vertices.shape)
    values = np.empty(len(vertices))
    with np.errstate(invalid="ignore"):  # infinite and NaN samples, allowed with `nan`
        for begin in range(0, len(vertices), _CHUNK):
            piece = slice(begin, begin + _CHUNK)
            gradients, values[piece] = _gradients(array, vertices[piece] / spacing)
            normals[piece] = -gradients / spacing
        lengths = np.linalg.norm(normals, axis=1)
        normals /= lengths[:, np.newaxis]
    flat = ~(np.isfinite(lengths) & (lengths > 0))
    if flat.any():  # the data have no gradient there: use the mesh
        normals[flat] = _mesh_normals(vertices, faces)[flat]
    return normals, values


def _gradients(
    array: Array, points: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Gradient and largest sample of each point's grid cell.

    The gradient is interpolated from the central differences at the corners of the grid cell. One
    unit of length is the distance between samples.
    """
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
            difference = array[tuple(after.T)].astype(np.float64) - array[tuple(before.T)].astype(
                np.float64
            )
            gradients[:, axis] += weight * difference / (after[:, axis] - before[:, axis])
    return gradients, largest


def _mesh_normals(
    vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.int64]
) -> npt.NDArray[np.float64]:
    """Unit normals of the vertices: means of the triangles' normals, weighted by area."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    areas = np.cross(b - a, c - a)
    normals = np.zeros(vertices.shape)
    for corner in range(3):
        np.add.at(normals, faces[:, corner], areas)
    lengths = np.linalg.norm(normals, axis=1)
    lengths[lengths == 0] = 1
    unit: npt.NDArray[np.float64] = normals / lengths[:, np.newaxis]
    return unit
