# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
from typing import Any, Literal, Protocol, Sequence

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import as_faces, as_vertices
from ._extract import Side
from ._progress import ProgressLike, progress_callback
from ._volume import Order, Volume, core_volume
from ._words import Number, isovalue, word, words
from .errors import BadArgumentError, UnsupportedError


class TriangleMesh(Protocol):
    """What `check` accepts as a mesh: a `Mesh`, a `Level`, a ``trimesh.Trimesh``."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


def check(
    mesh: TriangleMesh | npt.ArrayLike,
    faces: npt.ArrayLike | None = None,
    *,
    self_intersections: bool = False,
    volume: npt.ArrayLike | Volume | None = None,
    iso: Number | None = None,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    order: Order | None = None,
    inside: Side = "above",
    topology: Literal["trilinear", "faces"] = "trilinear",
    interpolation: Literal["trilinear", "tricubic"] = "trilinear",
    nan: Side | None = None,
    space: Literal["lps", "ras", "voxel"] = "lps",
    samples: int = 200_000,
    progress: ProgressLike = None,
    threads: int | None = None,
) -> dict[str, Any]:
    """Check the topology of any triangle mesh, and measure its shape and distance to an isosurface.

    Parameters
    ----------
    mesh : Mesh, Level, trimesh.Trimesh, pyvista.PolyData, or (V, 3) array of float
        The mesh, or the positions of its vertices, all finite.
    faces : (F, 3) array of int, optional
        Indices of vertices; only with an array of positions.
    self_intersections : bool
        Also find all pairs of triangles that intersect. The test is exact.
    volume : (M, N, P) array or Volume, optional
        Measure the two-sided distance between the mesh and the isosurface of this volume at
        ``iso``. The arguments ``spacing``, ``origin``, ``direction``, ``order``, ``inside``,
        ``topology``, ``interpolation``, ``nan`` and ``space`` have the meaning of `extract`. The
        mesh must be in the coordinates in which `extract` would return it.
    iso : float, optional
        The isovalue; required with ``volume``, refused without.
    samples : int
        Number of sample points on each of the two surfaces, spread evenly over its area.
    progress, threads
        As for `extract`.

    Returns
    -------
    dict
        The JSON that ``isoatlas check --json`` prints, see ``isoatlas-check-1`` in
        docs/reference/report.md. ``path`` is None.

    Examples
    --------
    ``check(mesh)["manifold"]``, ``check(vertices, faces, self_intersections=True)``

    Raises
    ------
    BadArgumentError
        A ``ValueError``: a wrong shape, an index out of range, a coordinate that is not finite, or
        only one of ``iso`` and ``volume``.
    UnsupportedError, EmptySurfaceError, KeyboardInterrupt
        As for `extract`.
    """
    vertices, corners = _arrays_of(mesh, faces)
    positions = as_vertices(vertices)
    triangles = as_faces(corners, len(positions))
    if (volume is None) != (iso is None):
        raise BadArgumentError("volume and iso: expected both or none of them")
    core = None
    options: list[tuple[str, str]] = []
    if volume is not None:
        core = core_volume(volume, spacing, origin, direction, order)
        named = {
            "inside": inside,
            "topology": topology,
            "interpolation": interpolation,
            "nan": nan,
            "space": space,
            "samples": samples,
        }
        options = [("iso", isovalue("iso", iso)), *words(named)]
    count = int(word("threads", 0 if threads is None else threads))
    if count < 0:
        raise BadArgumentError(f"threads: expected a whole number, 0 or more, got '{count}'")
    with progress_callback(progress) as callback:
        text = _core.check(
            positions, triangles, bool(self_intersections), core, options, count, callback
        )
    report: dict[str, Any] = json.loads(text)
    return report


def _arrays_of(mesh: Any, faces: Any) -> tuple[Any, Any]:
    """Vertices and faces.

    Raises
    ------
    TypeError
        Faces with a mesh, which has its own; or an array without faces.
    UnsupportedError
        A PolyData with other faces than triangles.
    """
    if faces is None and hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    if faces is None and hasattr(mesh, "points") and hasattr(mesh, "is_all_triangles"):
        if not mesh.is_all_triangles:
            raise UnsupportedError(
                "mesh: expected a PolyData of triangles, got other faces: use mesh.triangulate()"
            )
        return mesh.points, np.asarray(mesh.faces).reshape(-1, 4)[:, 1:]
    if hasattr(mesh, "faces"):
        raise TypeError("faces: the mesh has its own, expected them with an array of vertices only")
    if faces is None:
        raise TypeError(
            f"mesh: expected a mesh, or an array of vertices and faces, got {type(mesh).__name__}"
        )
    return mesh, faces
