# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
from typing import Any, Literal, Sequence

import numpy.typing as npt

from . import _core
from ._arrays import as_faces, as_vertices
from ._extract import Side
from ._progress import ProgressLike, progress_callback
from ._volume import Order, Volume, core_volume
from ._words import Number, isovalue, word, words
from .errors import BadArgumentError


def check(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike,
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
    vertices : (V, 3) array of float
        Positions, all finite.
    faces : (F, 3) array of int
        Indices of vertices.
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

    Raises
    ------
    BadArgumentError
        A ``ValueError``: a wrong shape, an index out of range, a coordinate that is not finite, or
        only one of ``iso`` and ``volume``.
    UnsupportedError, EmptySurfaceError, KeyboardInterrupt
        As for `extract`.
    """
    positions = as_vertices(vertices)
    triangles = as_faces(faces, len(positions))
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
