# SPDX-License-Identifier: Apache-2.0
"""Meshes of PyVista's grids: ``grid.isoatlas.extract(isovalue)``.

    >>> import isoatlas.pyvista
    >>> import pyvista
    >>> grid = pyvista.Wavelet()
    >>> grid.isoatlas.extract(157.5).plot()

Importing this module adds the accessor ``isoatlas`` to ``pyvista.ImageData``. ``import isoatlas``
does so if PyVista was imported before; PyVista 0.48 and later does it when the accessor is used.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista

from ._extract import extract
from ._mesh import Mesh
from ._volume import Volume
from ._words import Number
from .errors import BadArgumentError, UnsupportedError

__all__ = ["ImageDataAccessor", "from_grid", "to_multiblock", "to_polydata"]

_Grid: Any = pyvista.ImageData


class ImageDataAccessor:
    """``grid.isoatlas``: isosurfaces of a ``pyvista.ImageData``."""

    def __init__(self, grid: Any) -> None:
        self._grid = grid

    def volume(self, scalars: str | None = None) -> Volume:
        """The point data as a `Volume`; the samples are not copied. See `from_grid`."""
        return from_grid(self._grid, scalars)

    def extract(
        self,
        iso: Number,
        *,
        scalars: str | None = None,
        all_levels: bool = False,
        **options: Any,
    ) -> Any:
        """Mesh the isosurface at ``iso``, with certified topology.

        Parameters
        ----------
        iso : float
            The isovalue.
        scalars : str, optional
            Name of the point data. Default: the active scalars.
        all_levels : bool
            Return all levels of detail, not only the finest.
        **options
            As for `isoatlas.extract`, such as ``max_distance="0.5vx"``, ``keep_components=1``,
            ``progress=True``.

        Returns
        -------
        pyvista.PolyData or pyvista.MultiBlock
            The finest level, with the point data ``max_distance`` (as `Level.distance`) and, with
            ``border="closed"``, the cell data ``cap``, 1 on caps; or with ``all_levels`` a
            MultiBlock, ``"level 0"`` (the coarsest) to the finest. Coordinates are those of the
            grid. The field data ``"isoatlas_report"`` is the report of the extraction
            (`Mesh.report`) as JSON.

        Raises
        ------
        BadArgumentError, UnsupportedError, EmptySurfaceError, OutOfMemoryError
            As `isoatlas.extract` and `from_grid`.
        """
        mesh = self.extract_mesh(iso, scalars=scalars, **options)
        return to_multiblock(mesh) if all_levels else to_polydata(mesh)

    def extract_mesh(self, iso: Number, *, scalars: str | None = None, **options: Any) -> Mesh:
        """Like `extract`, but returns an isoatlas `Mesh`, to save it or to use its report."""
        if options.get("order") is not None:
            raise BadArgumentError("order: the grid has its own, expected it with an array only")
        return extract(self.volume(scalars), iso, **options)


def from_grid(grid: Any, scalars: str | None = None) -> Volume:
    """The point data of a ``pyvista.ImageData`` as a `Volume`; the samples are not copied.

    Raises
    ------
    TypeError
        ``grid`` is not a ``pyvista.ImageData``.
    BadArgumentError
        A ``ValueError``: there are no such point data.
    UnsupportedError
        A ``ValueError``: vectors, or a grid that is not 3-D.
    """
    if not isinstance(grid, _Grid):
        raise TypeError(f"grid: expected a pyvista.ImageData, got {type(grid).__name__}")
    samples = _scalars_of(grid, scalars)
    nx, ny, nz = grid.dimensions
    if samples.ndim != 1 or min(nx, ny, nz) < 2:
        raise UnsupportedError(
            f"scalars: expected one number per point of a 3-D grid, got the shape {samples.shape} "
            f"on {nx} x {ny} x {nz} points"
        )
    spacing = np.array(grid.spacing, np.float64)
    direction = np.array(getattr(grid, "direction_matrix", np.eye(3)), np.float64)
    first = np.array(grid.extent[::2], np.float64)  # index of the first point
    origin = np.array(grid.origin, np.float64) + direction @ (spacing * first)
    return Volume(
        samples.reshape(nz, ny, nx),
        spacing=spacing.tolist(),
        origin=origin.tolist(),
        direction=direction,
    )


def _scalars_of(grid: Any, name: str | None) -> npt.NDArray[Any]:
    if name is None:
        name = grid.point_data.active_scalars_name
        if name is None and len(grid.point_data) == 1:
            name = grid.point_data.keys()[0]
        if name is None:
            where = "they are cell data: use grid.cell_data_to_point_data()"
            if len(grid.point_data):
                where = f"choose one of {', '.join(grid.point_data.keys())}"
            elif not len(grid.cell_data):
                where = "the grid has none"
            raise BadArgumentError(f"scalars: expected active point data, {where}")
    if name not in grid.point_data:
        names = ", ".join(grid.point_data.keys()) or "none"
        raise BadArgumentError(f"scalars: there are no point data {name!r}, the grid has {names}")
    return np.asarray(grid.point_data[name])


def to_polydata(mesh: Mesh, level: int = -1) -> Any:
    """A level as ``pyvista.PolyData``, with the report in its field data. See `Mesh.to_pyvista`."""
    polydata = mesh.to_pyvista(level)
    _add_report(polydata, mesh)
    return polydata


def to_multiblock(mesh: Mesh) -> Any:
    """All levels as a ``pyvista.MultiBlock``, coarse to fine, with the report in its field data."""
    blocks: Any = pyvista.MultiBlock()
    for level in mesh.levels:
        blocks[f"level {level.number}"] = mesh.to_pyvista(level.number)
    _add_report(blocks, mesh)
    return blocks


def _add_report(data: Any, mesh: Mesh) -> None:
    data.field_data["isoatlas_report"] = [json.dumps(mesh.report)]


def _register() -> None:
    if hasattr(pyvista, "register_dataset_accessor"):  # 0.48 and later
        pyvista.register_dataset_accessor("isoatlas", _Grid)(ImageDataAccessor)
    else:
        _Grid.isoatlas = property(ImageDataAccessor)


_register()
