# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from typing import Any, Literal, Sequence

import numpy.typing as npt

from . import _core
from ._mask import mask_field
from ._mesh import Mesh
from ._progress import ProgressLike, progress_callback
from ._volume import Order, Volume, core_volume, states_order
from ._words import Length, Number, Refine, isovalue, points, words
from ._words import levels as level_words
from .errors import BadArgumentError

Side = Literal["above", "below"]


def extract(
    volume: npt.ArrayLike | Volume,
    iso: Number | None = None,
    *,
    label: int | Sequence[int] | None = None,
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
    keep_near: npt.ArrayLike | None = None,
    drop_near: npt.ArrayLike | None = None,
    coarse: bool = False,
    levels: int | None = None,
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
    border: Literal["open", "closed"] = "open",
    placement: Literal["surface", "balanced"] = "surface",
    space: Literal["lps", "ras", "voxel"] = "lps",
    measure: bool = False,
    measure_samples: int | None = None,
    progress: ProgressLike = None,
    threads: int | None = None,
) -> Mesh:
    """Mesh the isosurface of a volume, with certified topology.

    The isosurface is the surface on which the volume has the value ``iso``. Every level of the
    result is a consistently oriented 2-manifold, and each of its components is homeomorphic to a
    component of the isosurface. A certificate verifies this for each level.

    The options have the meaning of those of ``isoatlas extract``, see
    docs/reference/command-line.md. A length is a number in the unit of ``spacing``, or a text:
    ``"3vx"`` is three times the smallest spacing; ``"2.5mm"`` is converted to the unit of the
    `Volume`, which must have one.

    Parameters
    ----------
    volume : (M, N, P) array or Volume
        Samples of any integer or floating-point type or bool, at least 2 along each axis. Arrays in
        C or Fortran order and their transposed views are not copied. Other strides, other byte
        orders and float16 are copied once. A `Volume` has its own spacing, origin and direction,
        and its order is ``"xyz"``.
    iso : float, optional
        The isovalue. For integer samples choose a value between two integers, such as 80.5.
        Required without ``label``.
    label : int or sequence of int, optional
        For a segmentation, in place of ``iso``: mesh the samples with this label, or with one of
        these. The surface is the isosurface at 0 of `mask_field`, with ``topology="faces"``.
    spacing : 3 floats
        Distance between samples along each axis, above 0.
    origin : 3 floats
        World position of the first sample.
    direction : (3, 3) array, optional
        The columns are the unit vectors of the axes. A mirror image is allowed. Default: the
        identity.
    order : {"ijk", "xyz"}, optional
        Order of the coordinates in ``spacing``, ``origin``, ``direction`` and in the result.
        ``"ijk"`` is the order of the array's axes, as in scikit-image: ``volume[i, j, k]`` is at
        ``origin + direction @ (spacing * (i, j, k))``. ``"xyz"`` is the opposite order, for arrays
        indexed ``[z, y, x]``, such as those of SimpleITK's ``GetArrayFromImage``:
        ``volume[z, y, x]`` is at ``origin + direction @ (spacing * (x, y, z))``. The spacing,
        origin and direction of a `Volume` imply ``"xyz"``. Otherwise an order is required if the
        geometry is not the same in both orders; without it, coordinates are in the order of the
        array's axes, and ``Mesh.save`` warns.
    inside : {"above", "below"}
        Which samples are inside: those above or those below ``iso``. A sample equal to ``iso`` is
        always inside. Faces are counter-clockwise seen from outside.
    nan : {"below", "above"}, optional
        The side of ``iso`` to which NaN samples belong; infinities then belong to the side of their
        sign. Default: NaN and infinity are refused.
    topology : {"trilinear", "faces"}
        Topology of the surface inside a grid cell: that of the trilinear interpolant, with tunnels,
        or one disk per closed loop on the faces of the grid cell.
    interpolation : {"trilinear", "tricubic"}
        Interpolation between samples; tricubic is smooth. It affects vertex positions and
        distances, not the topology (unless ``supersample`` is above 1).
    supersample : int
        Mesh the surface of the volume upsampled by this factor along each axis. A factor K needs
        about K² times the time and memory.
    adaptive_supersample : int, 0 to 8
        Upper limit, per refined level, on how often the surface is subdivided where a bound cannot
        be satisfied otherwise.
    min_component_size : float or str, optional
        Drop components that enclose less volume: a number in world units cubed, or ``"10vx"``. The
        dropped components are listed in ``report["dropped"]``.
    keep_components : int, optional
        Keep only this number of largest components.
    keep_near, drop_near : (3,) or (n, 3) array_like, optional
        Points in the coordinates of the mesh (``space``). Keep only, or drop, the components that
        are nearest to them. If the volume boundary cuts a part into several components, all of them
        are kept or dropped.
    coarse : bool
        Return only level 0, the coarsest mesh that preserves the topology.
    levels : int, 1 to 16, optional
        Make this number of levels. The finest has the bound ``max_distance``; each coarser one has
        twice the bound of the next, or less, so that the coarsest keeps a recognisable shape. Not
        with ``coarse`` or ``refine``.
    refine : str, dict, or list of these, optional
        Each entry adds one level, refined from the previous level until it satisfies the
        constraints of the entry: ``{"max_distance": "0.5vx", "normal_angle": 20}``, with the names
        of the arguments below, in the order of their priority. The text of ``--refine``,
        ``"max_distance:0.5vx,normal_angle:20deg"``, is accepted as well. Default: one level that
        satisfies the bounds below. If none of these bounds is a metric, the level is within half a
        voxel of the surface (or within an eighth of the largest spacing, if that is more).
    max_distance, mean_distance : float or str, optional
        Upper bounds of the largest two-sided distance and of the mean distance between mesh and
        surface: lengths. This bound and the following ones, up to ``min_aspect``, apply to all
        levels after level 0; with ``coarse`` they are checked on level 0. They have priority over
        those of ``refine``; among them, earlier ones in this list have priority.
    area_curvature, area_curvature_smooth, geodesic_ratio : float, optional
        Upper bounds of ratios; above 1.
    normal_angle : float or str, optional
        Upper bound of the change of the surface normal within a Voronoi cell, in degrees.
    max_vertices, min_vertices : int, optional
        Bounds of the number of vertices, 4 or more. Topology has priority over ``max_vertices``.
    min_edge, max_edge : float or str, optional
        Bounds of the edge lengths.
    min_aspect : float, optional
        Lower bound of the shortest edge of a triangle divided by its longest; between 0 and 1.
    max_radius : float or str, optional
        Largest radius of the disks that cover the surface: a length. Default: half the longest side
        of the volume.
    covering : {"sizing-field", "halving"}
        How disks cover the surface. ``"halving"`` is the method of the paper.
    event_persistence : float or str, optional
        Holes in a growing disk that close again within this length do not limit the disk. Default:
        ``"1.5vx"``; 0 with ``covering="halving"``.
    allow_self_intersections : bool
        Keep triangles that intersect; faster, and fewer triangles.
    border : {"open", "closed"}
        The mesh where the volume boundary cuts the surface: it ends there, or it is closed by
        planar caps on the volume boundary, as if everything beyond were outside. The caps are the
        last ``caps.triangles`` faces of each level, see `Mesh.report`.
    placement : {"surface", "balanced"}
        Vertex placement: on the surface and the same in all levels, or displaced in each level so
        that the mesh lies evenly on both sides of the surface.
    space : {"lps", "ras", "voxel"}
        Coordinates of the result: world coordinates; world coordinates with x and y negated (only
        with ``order="xyz"``); or sample indices.
    measure : bool
        Measure the two-sided distance between each level and the isosurface, with 200,000 samples
        in each direction.
    measure_samples : int, optional
        The same with this number of samples.
    progress : function of (stage: str, fraction: float), or bool, optional
        Called on the calling thread, about 20 times a second, with the name of a stage and the
        completed fraction of all work, from 0 to 1; the fraction never falls. If the function
        raises an exception, the work stops and `extract` raises the exception. True shows a bar of
        tqdm.
    threads : int, optional
        Number of threads. Default: as many as the machine has. The result does not depend on it.

    Returns
    -------
    Mesh
        ``vertices`` (V, 3) float64 and ``faces`` (F, 3) int64 of the finest level; ``levels``,
        from coarse to fine; and ``report``. A violated bound is not an error: see ``Mesh.unmet``.

    Raises
    ------
    BadArgumentError
        A ``ValueError``: an argument is out of its domain, or ``order`` is required.
    UnsupportedError
        A ``ValueError``: NaN or infinite samples without ``nan``, complex samples, an array that is
        not 3-D, or values that float64 cannot hold (``longdouble``).
    EmptySurfaceError
        A ``ValueError``: all samples are on one side of ``iso``.
    OutOfMemoryError
        A ``MemoryError``.
    KeyboardInterrupt
        Within a second after Ctrl-C, if `extract` is called on the main thread.

    Notes
    -----
    The method is that of Gavriliu, Carranza, Breen and Barr, "Fast extraction of adaptive
    multiresolution meshes with guaranteed properties from volumetric data", IEEE Visualization
    2001.

    Other Python threads run during the work; they must not change the samples. The samples are read
    in the order in which they lie in memory. The same values in C and in Fortran order therefore
    give meshes with the same topology but with other vertices.
    """
    if (iso is None) == (label is None):
        raise BadArgumentError("iso: expected an isovalue, or the label of a segmentation")
    if label is not None:
        for name, value, default in (
            ("inside", inside, "above"),
            ("nan", nan, None),
            ("topology", topology, "trilinear"),
        ):
            if value != default:
                raise BadArgumentError(f"{name}: not for a label, got {value!r}")
        volume = mask_field(volume, label, spacing=spacing, order=order, threads=threads)
        iso, topology = 0, "faces"
    assert iso is not None
    core = core_volume(volume, spacing, origin, direction, order)
    if measure and measure_samples is None:
        measure_samples = 200_000
    request = request_of(
        iso,
        nan=nan,
        inside=inside,
        topology=topology,
        interpolation=interpolation,
        supersample=supersample,
        adaptive_supersample=adaptive_supersample,
        min_component_size=min_component_size,
        keep_components=keep_components,
        keep_near=keep_near,
        drop_near=drop_near,
        coarse=coarse,
        levels=levels,
        refine=refine,
        max_distance=max_distance,
        mean_distance=mean_distance,
        area_curvature=area_curvature,
        area_curvature_smooth=area_curvature_smooth,
        geodesic_ratio=geodesic_ratio,
        normal_angle=normal_angle,
        max_vertices=max_vertices,
        min_vertices=min_vertices,
        min_edge=min_edge,
        max_edge=max_edge,
        min_aspect=min_aspect,
        max_radius=max_radius,
        covering=covering,
        event_persistence=event_persistence,
        allow_self_intersections=allow_self_intersections,
        border=border,
        placement=placement,
        space=space,
        measure_samples=measure_samples,
        threads=threads,
    )
    with progress_callback(progress) as callback:
        core_levels = _core.extract(core, request, callback)
    return Mesh(core_levels, states_order(volume, order, spacing, origin, direction))


_SETTINGS = (
    "nan",
    "inside",
    "topology",
    "interpolation",
    "supersample",
    "adaptive_supersample",
    "min_component_size",
    "keep_components",
    "levels",
    "max_radius",
    "covering",
    "event_persistence",
    "border",
    "placement",
    "space",
    "measure_samples",
    "threads",
)
# In the order of their priority.
_CONSTRAINTS = (
    "max_distance",
    "mean_distance",
    "area_curvature",
    "area_curvature_smooth",
    "geodesic_ratio",
    "normal_angle",
    "max_vertices",
    "min_vertices",
    "min_edge",
    "max_edge",
    "min_aspect",
)
_OTHERS = ("keep_near", "drop_near", "coarse", "refine", "allow_self_intersections")


def request_of(iso: Number, **options: Any) -> _core.ExtractWords:
    """The options of `extract` in the form of the extension.

    Raises
    ------
    TypeError
        An option that `extract` does not have.
    """
    for name in options:
        if name not in _SETTINGS + _CONSTRAINTS + _OTHERS:
            raise TypeError(f"unexpected option {name!r}; expected those of isoatlas.extract")
    given = options.get
    return _core.ExtractWords(
        [
            ("iso", isovalue("iso", iso)),
            *words({name: given(name) for name in _SETTINGS}),
            *points("keep_near", given("keep_near")),
            *points("drop_near", given("drop_near")),
        ],
        words({name: given(name) for name in _CONSTRAINTS}),
        level_words(given("refine")),
        bool(given("coarse")),
        bool(given("allow_self_intersections")),
    )
