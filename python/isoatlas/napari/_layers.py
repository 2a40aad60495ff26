# SPDX-License-Identifier: Apache-2.0
"""From the data of a napari layer to a mesh, and from a mesh to the data of a Surface layer."""

from __future__ import annotations

from typing import Any, Literal, Sequence

import numpy as np
import numpy.typing as npt

from .._extract import extract
from .._mesh import Mesh
from .._progress import ProgressLike
from .._words import Number
from ..errors import BadArgumentError, UnsupportedError

# Transforms of a layer that its Surface layer shares.
_TRANSFORMS = ("scale", "translate", "rotate", "shear", "affine", "units", "axis_labels")


def layer_samples(layer: Any, step: Sequence[int] | None = None) -> npt.NDArray[Any]:
    """The 3-D array of a layer: its finest scale, at one time point.

    Parameters
    ----------
    layer : napari.layers.Image or napari.layers.Labels
    step : indices, optional
        The position along each axis of the layer's data; used for the axes before the last three.
        Default: 0.

    Raises
    ------
    UnsupportedError
        A ``ValueError``: an RGB image, or fewer than 3 dimensions.
    """
    if getattr(layer, "rgb", False):
        raise UnsupportedError(f"{layer.name}: an RGB image has no isosurface; split its channels")
    data = layer.data[0] if layer.multiscale else layer.data
    if data.ndim < 3:
        raise UnsupportedError(f"{layer.name}: it has {data.ndim} dimensions, expected 3 or more")
    before = data.ndim - 3
    first = [0] * before if step is None else list(step)[:before]
    return np.asarray(data[tuple(int(i) for i in first)])


def _label_field(samples: npt.NDArray[Any], label: int, smooth: float) -> npt.NDArray[Any]:
    """The mask of a label, smoothed by a Gaussian; its surface is at 0.5."""
    if samples.dtype.kind not in "biu":
        raise UnsupportedError(f"labels of type {samples.dtype}, expected integers")
    mask: npt.NDArray[Any] = samples == label
    if not mask.any():
        found = ", ".join(map(str, np.unique(samples)[:12]))
        raise BadArgumentError(f"label: no sample has the label {label}; the labels are {found}")
    if smooth <= 0:
        return mask.view(np.uint8)
    from scipy.ndimage import gaussian_filter

    field: npt.NDArray[Any] = gaussian_filter(mask.astype(np.float32), smooth)
    return field


def mesh_layer(
    layer: Any,
    value: Number | None = None,
    *,
    smooth: float = 1.0,
    step: Sequence[int] | None = None,
    levels: int | None = None,
    max_distance: float = 0.5,
    max_vertices: int | None = None,
    keep_components: int | None = None,
    border: Literal["open", "closed"] = "open",
    progress: ProgressLike = None,
    threads: int | None = None,
) -> Mesh:
    """Mesh an ``Image`` layer at an isovalue, or one label of a ``Labels`` layer.

    Distances are those of the layer's ``scale``; its rotation, shear and affine transform are not
    applied. Vertices are in the order of the array's axes, in units of ``scale``.

    Parameters
    ----------
    layer : napari.layers.Image or napari.layers.Labels
        3-D, or with more axes in front, of which ``step`` selects one position.
    value : float, optional
        The isovalue; for ``Labels`` the label. Default: the middle of the contrast limits; the
        selected label.
    smooth : float
        ``Labels`` only: standard deviation, in voxels, of the Gaussian that smooths the mask of the
        label before it is meshed at 0.5. It removes the staircase of the voxels, and details
        thinner than about two voxels. 0: mesh the mask itself.
    step : indices, optional
        Position along the axes before the last three.
    levels : int, 1 to 16, optional
        Number of levels of detail. The distance of the finest is ``max_distance``; each coarser one
        has twice the distance of the next, or less, so that the coarsest keeps a recognisable
        shape. Default: the coarsest mesh that preserves the topology, and one level within
        ``max_distance``.
    max_distance : float
        Upper bound of the two-sided distance of the finest level, in voxels (smallest ``scale``).
    max_vertices, keep_components, border, progress, threads
        As for `isoatlas.extract`.

    Returns
    -------
    Mesh

    Raises
    ------
    isoatlas.Error
        As for `isoatlas.extract`; RGB images, images with fewer than 3 dimensions, and labels that
        do not occur are refused as ``ValueError``.
    """
    samples = layer_samples(layer, step)
    iso: Any = value
    if is_labels(layer):
        samples = _label_field(samples, int(layer.selected_label if iso is None else iso), smooth)
        iso = 0.5
    elif iso is None:
        low, high = layer.contrast_limits
        iso = 0.5 * (float(low) + float(high))
    scale = np.abs(np.asarray(layer.scale, dtype=float))[-3:]
    return extract(
        samples,
        iso,
        spacing=scale.tolist(),
        order="ijk",
        levels=levels,
        max_distance=f"{max_distance!r}vx",
        max_vertices=max_vertices,
        keep_components=keep_components,
        border=border,
        progress=progress,
        threads=threads,
    )


def is_labels(layer: Any) -> bool:
    """Whether the layer holds labels, not intensities."""
    return hasattr(layer, "selected_label")


def surface_data(
    layer: Any, mesh: Mesh, level: int = -1, *, color_by_distance: bool = False
) -> tuple[tuple[npt.NDArray[Any], ...], dict[str, Any], str]:
    """The layer data tuple of a level: ``(vertices, faces, values)``, options, ``"surface"``.

    Parameters
    ----------
    layer : napari.layers.Image or napari.layers.Labels
        The layer that was meshed. The surface has its transforms, so that it lies in the image.
    mesh : Mesh
        The result of `mesh_layer`.
    level : int
        Index into ``mesh.levels``; default: the finest.
    color_by_distance : bool
        Values are the distance between mesh and isosurface; otherwise they are 1.
    """
    it = mesh.levels[level]
    scale = np.abs(np.asarray(layer.scale, dtype=float))[-3:]
    vertices = it.vertices / scale
    has_colors = color_by_distance and it.distance is not None
    values = it.distance if has_colors else np.ones(len(vertices), np.float32)
    options: dict[str, Any] = {
        "name": f"{layer.name} mesh",
        "shading": "smooth",
        "metadata": {"isoatlas": mesh},
    }
    if has_colors:
        options["colormap"] = "viridis"
    else:
        options["colormap"] = "gray"
        options["contrast_limits"] = (0.0, 1.0)
    for name in _TRANSFORMS:
        transform = _last_axes(name, getattr(layer, name, None))
        if transform is not None:
            options[name] = transform
    return (vertices, it.faces.astype(np.int64), np.asarray(values)), options, "surface"


def _last_axes(name: str, transform: Any) -> Any:
    """The part of a layer's transform that acts on its last three axes; None: the default."""
    if transform is None:
        return None
    if name == "affine":
        matrix = np.asarray(transform)
        size = len(matrix) - 1
        keep = [*range(size - 3, size), size]
        return matrix[np.ix_(keep, keep)]
    if name == "rotate":
        return np.asarray(transform)[-3:, -3:]
    if name == "shear":
        shear = np.asarray(transform)
        return shear if len(shear) == 3 else None
    return transform[-3:]
