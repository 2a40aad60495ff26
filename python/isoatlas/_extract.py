# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from typing import Any, Literal, Sequence

import numpy.typing as npt

from . import _core
from ._mesh import Mesh
from ._progress import ProgressLike, watched
from ._volume import Order, Volume, core_volume
from ._words import Length, Number, Refine, isovalue, levels, words

Side = Literal["above", "below"]


def extract(
    volume: npt.ArrayLike | Volume,
    iso: Number,
    *,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    order: Order | None = None,
    inside: Side = "above",
    nan: Side | None = None,
    topology: Literal["trilinear", "faces"] = "trilinear",
    interpolation: Literal["trilinear", "tricubic"] = "trilinear",
    supersample: int = 1,
    adaptive_supersample: int = 6,
    min_component_size: Length | None = None,
    keep_components: int | None = None,
    coarse: bool = False,
    refine: Refine | None = None,
    max_distance: Length | None = None,
    mean_distance: Length | None = None,
    area_curvature: float | None = None,
    area_curvature_smooth: float | None = None,
    geodesic_ratio: float | None = None,
    normal_angle: float | str | None = None,
    max_vertices: int | None = None,
    min_vertices: int | None = None,
    min_edge: Length | None = None,
    max_edge: Length | None = None,
    min_aspect: float | None = None,
    max_radius: Length | None = None,
    covering: Literal["sizing-field", "halving"] = "sizing-field",
    event_persistence: Length | None = None,
    allow_self_intersections: bool = False,
    placement: Literal["surface", "balanced"] = "surface",
    space: Literal["lps", "ras", "voxel"] = "lps",
    measure: bool = False,
    measure_samples: int | None = None,
    progress: ProgressLike = None,
    threads: int | None = None,
) -> Mesh:
    """Mesh the surface on which a volume has the value ``iso``, with certified topology.

    Every level of the result is a 2-manifold, consistently oriented and homeomorphic to the isosurface, component by component; that
    was checked. Options mean what those of ``isoatlas extract`` mean (docs/reference/command-line.md).

    A length is a number, in the unit of ``spacing``, or a text: ``"3vx"`` is three times the smallest spacing, ``"2.5mm"`` is converted to the
    unit of the `Volume`, which must have one.

    Parameters
    ----------
    volume : (M, N, P) array, or Volume
        Any integer or floating-point type, or bool; at least 2 samples along each axis. Neither C-contiguous arrays, nor
        Fortran-contiguous ones, nor such with their axes transposed are copied; other strides, byte orders and float16 are, once.
        A `Volume` has its own spacing, origin and direction, and is ``order="xyz"``.
    iso : float
        The isovalue. For integers a value between two integers, like 80.5, is best.
    spacing : 3 floats
        World length of one step along each axis, above 0.
    origin : 3 floats
        World position of the first sample.
    direction : (3, 3) array, optional
        Its columns are the unit vectors of the axes; a mirror image is allowed. Default: the identity.
    order : {"ijk", "xyz"}, optional
        What the order of the coordinates is, in ``spacing``, ``origin``, ``direction`` and in all that comes out. ``"ijk"``, the default for
        arrays, is that of the array's axes, as in scikit-image: ``volume[i, j, k]`` is at
        ``origin + direction @ (spacing * (i, j, k))``. ``"xyz"`` is the opposite order, for arrays indexed ``[z, y, x]`` as SimpleITK's
        ``GetArrayFromImage`` makes them: ``volume[z, y, x]`` is at ``origin + direction @ (spacing * (x, y, z))``.
    inside : {"above", "below"}
        Which samples are inside. A sample equal to ``iso`` is inside either way. Faces are counter-clockwise seen from outside.
    nan : {"below", "above"}, optional
        On which side of ``iso`` NaN is; infinities are then on the side of their sign. Default: they are refused.
    topology : {"trilinear", "faces"}
        What the surface is inside a cell: that of the trilinear interpolant, with its tunnels, or one disk per loop on the cell's faces.
    interpolation : {"trilinear", "tricubic"}
        What the surface is between samples: moves vertices and changes distances, not the topology (unless supersampled).
    supersample : int
        Mesh the surface of the volume upsampled so many times along each axis.
    adaptive_supersample : int, 0 to 8
        How often, in each refined level, the surface may be sampled more finely where a bound cannot be kept otherwise.
    min_component_size : float or str, optional
        Leave out components that enclose less: world units cubed, or ``"10vx"``. What was left out is in ``report["dropped"]``.
    keep_components : int, optional
        Leave out all but so many largest ones.
    coarse : bool
        Only level 0, the coarsest mesh that keeps the topology.
    refine : str, dict or a list of them, optional
        One more level for each, refined from the last one until it is met: ``"max-distance:0.5vx,normal-angle:20deg"`` or
        ``{"max_distance": "0.5vx", "normal_angle": 20}``; what stands first is more important. Default: one level, at the bounds that
        follow, and within half a voxel of the surface (or an eighth of the largest spacing, where that
        is more) if none of them is a metric.
    max_distance, mean_distance : float or str, optional
        Bounds for all levels after level 0 (with ``coarse`` for level 0), here to ``min_aspect``. They are more important than those of ``refine``, and
        the more important the earlier they come in this list. This one: largest and mean distance of the mesh from the surface, lengths.
    area_curvature, area_curvature_smooth, geodesic_ratio : float, optional
        Ratios above 1.
    normal_angle : float or str, optional
        Turn of the normal within a cell, degrees.
    max_vertices, min_vertices : int, optional
        4 or more. Topology comes first: where it alone needs more than ``max_vertices``, there are more.
    min_edge, max_edge : float or str, optional
        Lengths of edges.
    min_aspect : float, optional
        Shortest over longest edge of a triangle, between 0 and 1.
    max_radius : float or str, optional
        Largest radius of the disks that cover the surface. Default: half the longest side of the volume.
    covering : {"sizing-field", "halving"}
        How disks cover the surface; ``"halving"`` is the paper's own.
    event_persistence : float or str, optional
        Holes in a growing disk that close again within this length do not limit it. Default: ``"1.5vx"``, with ``"halving"`` 0.
    allow_self_intersections : bool
        Leave triangles as they are that meet others beyond the corners and edges they share; faster.
    placement : {"surface", "balanced"}
        Vertices on the surface, the same in all levels; or moved in each level so that the mesh lies evenly on both sides.
    space : {"lps", "ras", "voxel"}
        Coordinates of the result: as given; with x and y negated (``order="xyz"`` only); or indices of samples.
    measure : bool
        Measure each level against the isosurface, with 200,000 samples each way.
    measure_samples : int, optional
        The same with so many samples.
    progress : function of (stage: str, fraction: float), or bool, optional
        Called on this thread, some 20 times a second, with the name of a stage and how much of the whole is done, 0 to 1, which never falls. What it raises
        stops the work and comes out of here. ``True``: a bar of tqdm.
    threads : int, optional
        Default: as many as the machine has. The result does not depend on it.

    Returns
    -------
    Mesh
        ``vertices`` (V, 3) float64 and ``faces`` (F, 3) uint32 of the finest level, ``levels``, coarse to fine, and ``report``.
        Bounds that could not be met are no error: see ``Mesh.unmet``.

    Raises
    ------
    BadArgumentError
        A ``ValueError``: an argument is out of its domain.
    UnsupportedError
        A ``ValueError``: NaN or infinite samples without ``nan``; complex samples; not 3-D; values that float64 cannot hold (``longdouble``).
    EmptySurfaceError
        A ``ValueError``: every sample is on one side of ``iso``.
    OutOfMemoryError
        A ``MemoryError``.
    KeyboardInterrupt
        Ctrl-C, within a second, if this is called on the main thread.

    Notes
    -----
    Other Python threads run meanwhile; they must not change the samples. The same values in C and in Fortran order give meshes of the
    same topology, but not with the same vertices: memory is read in its own order.
    """
    core = core_volume(volume, spacing, origin, direction, order)
    if measure and measure_samples is None:
        measure_samples = 200_000
    settings: dict[str, Any] = {
        "nan": nan,
        "inside": inside,
        "topology": topology,
        "interpolation": interpolation,
        "supersample": supersample,
        "adaptive_supersample": adaptive_supersample,
        "min_component_size": min_component_size,
        "keep_components": keep_components,
        "max_radius": max_radius,
        "covering": covering,
        "event_persistence": event_persistence,
        "placement": placement,
        "space": space,
        "measure_samples": measure_samples,
        "threads": threads,
    }
    constraints = {
        "max_distance": max_distance,
        "mean_distance": mean_distance,
        "area_curvature": area_curvature,
        "area_curvature_smooth": area_curvature_smooth,
        "geodesic_ratio": geodesic_ratio,
        "normal_angle": normal_angle,
        "max_vertices": max_vertices,
        "min_vertices": min_vertices,
        "min_edge": min_edge,
        "max_edge": max_edge,
        "min_aspect": min_aspect,
    }
    request = _core.ExtractWords(
        [("iso", isovalue("iso", iso)), *words(settings)], words(constraints), levels(refine), bool(coarse), bool(allow_self_intersections)
    )
    with watched(progress) as callback:
        return Mesh(_core.extract(core, request, callback))
