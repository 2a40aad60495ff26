# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import functools
import json
import os
import warnings
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import FileWarning

if TYPE_CHECKING:
    import pyvista
    import trimesh
    from vtkmodules.vtkCommonDataModel import vtkPolyData


class Level:
    """One level of detail of a `Mesh`.

    Attributes
    ----------
    number : int
        0: the coarsest.
    vertices : (V, 3) float64, read-only
        In all levels of ``placement="surface"`` those of the level before come first, at the same indices.
    faces : (F, 3) uint32, read-only
        Indices of vertices, counter-clockwise seen from outside.
    distance : (V,) float32, read-only, or None
        Per vertex the largest distance between its part of the isosurface and the mesh, both ways, in the unit of the volume's spacing:
        what ``max_distance`` bounds. None where nothing was measured (``coarse=True``, files of other programs).
    report : dict
        What is known of it: the keys of ``levels[]`` in docs/reference/report.md. Empty if a file does not say.
    """

    def __init__(self, core: _core.Levels, number: int, report: dict[str, Any]) -> None:
        self.number = number
        self.vertices: npt.NDArray[np.float64] = core.vertices(number)
        self.faces: npt.NDArray[np.uint32] = core.faces(number)
        self.distance: npt.NDArray[np.float32] | None = core.distance(number)
        self.report = report

    def __repr__(self) -> str:
        return f"<isoatlas.Level {self.number}: {_size_text(self.vertices, self.faces)}>"


class Mesh:
    """Nested levels of triangles: what `extract` makes, and `read` reads.

    Arrays are read-only views, not copies: levels share their vertices. Use ``mesh.vertices.copy()`` for one to change; arrays stay
    valid when the mesh is gone.
    """

    def __init__(self, core: _core.Levels) -> None:
        """Not for users: see `extract` and `read`."""
        self._core = core

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """(V, 3) float64, read-only: the vertices of the finest level, in the unit of the volume's spacing."""
        return self.levels[-1].vertices

    @property
    def faces(self) -> npt.NDArray[np.uint32]:
        """(F, 3) uint32, read-only: indices of vertices, counter-clockwise seen from outside; of the finest level."""
        return self.levels[-1].faces

    @functools.cached_property
    def levels(self) -> Sequence[Level]:
        """All levels, coarse to fine; at least one."""
        return tuple(Level(self._core, k, report) for k, report in enumerate(self.report["levels"]))

    @functools.cached_property
    def report(self) -> dict[str, Any]:
        """What ``isoatlas extract --report`` writes (docs/reference/report.md), as it is before files are written: ``files`` is empty.
        Of a mesh that was read only ``levels``, with what the file says of each.
        """
        text = self._core.report()
        if text:
            report: dict[str, Any] = json.loads(text)
            return report
        said = [json.loads(level) or {} for level in self._core.level_reports()]
        return {"levels": said or [{} for _ in range(len(self._core))]}

    @property
    def placement(self) -> str:
        """``"surface"``: a vertex is at the same place in all levels; ``"balanced"``: it may be elsewhere in each."""
        return self._core.placement

    @property
    def space(self) -> str:
        """What files say of the coordinates: ``"LPS"``, ``"RAS"``, ``"voxel"``, or nothing for arrays with ``order="ijk"``."""
        return self._core.space

    @property
    def unmet(self) -> list[str]:
        """A line for each bound that was asked for and could not be met, as the command line prints it; empty: all are met."""
        return [
            f"level {k}: {c['quantity']} {_bound_text(c['bound'], c['unit'])}: reached {_bound_text(c['reached'], c['unit'])}"
            + (f": {c['reason']}" if c["reason"] else "")
            for k, level in enumerate(self.report["levels"])
            for c in level.get("constraints", ())
            if not c["satisfied"] and not c["default"]
        ]

    def save(self, path: str | os.PathLike[str], *, report: str | os.PathLike[str] | None = None, glb_per_level: bool = False) -> None:
        """Write files, whole or not at all; the same bytes as the command line's ``-o``.

        Parameters
        ----------
        path : str or path
            ``NAME.ply``, ``.stl``, ``.obj``, ``.off``, ``.vtp``, ``.3mf`` or ``.gii``: the finest level; with ``{level}`` in the name one file for each level;
            ``NAME.glb``, ``NAME.vtm``: all levels. docs/reference/files.md says what is in them.
        report : str or path, optional
            Write the report too, as ``--report`` does. Only of what `extract` made.
        glb_per_level : bool
            With ``NAME.glb``: also ``NAME-0.glb``, ``NAME-1.glb``, ... and ``NAME.json``, which lists them.

        Warns
        -----
        FileWarning
            Rounding to float32 in ``.stl``, ``.gii`` or ``.glb`` causes self-intersections: the volume is very far from the origin.

        Raises
        ------
        BadFileError
            An ``OSError``: it cannot be written; or float32, in ``.stl``, ``.gii`` and ``.glb``, would merge or move vertices.
        UnsupportedError
            A ``ValueError``: unknown extension.
        BadArgumentError
            A ``ValueError``: a file would replace the volume that was read, or another one.
        """
        if warning := self._core.save(path, report, glb_per_level):
            warnings.warn(warning, FileWarning, stacklevel=2)

    def to_vtk(self, level: int = -1) -> vtkPolyData:
        """A copy as ``vtkPolyData``, of the finest level or of another one; `Level.distance` as the point array ``max_distance``.
        Needs VTK (Debian: python3-vtk9).
        """
        try:
            from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
            from vtkmodules.vtkCommonCore import vtkPoints
            from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
        except ImportError as error:
            raise ImportError("to_vtk() needs the package vtk (Debian: python3-vtk9)") from error
        it = self.levels[level]
        points = vtkPoints()
        points.SetDataTypeToDouble()
        points.SetData(numpy_to_vtk(it.vertices, deep=True))
        count = len(it.faces)
        cells = vtkCellArray()
        cells.SetData(
            numpy_to_vtkIdTypeArray(np.arange(0, 3 * count + 1, 3, dtype=np.int64), deep=True),
            numpy_to_vtkIdTypeArray(it.faces.astype(np.int64).ravel(), deep=True),
        )
        mesh = vtkPolyData()
        mesh.SetPoints(points)
        mesh.SetPolys(cells)
        if it.distance is not None:
            array = numpy_to_vtk(it.distance, deep=True)
            array.SetName("max_distance")
            mesh.GetPointData().AddArray(array)
        return mesh

    def to_pyvista(self, level: int = -1) -> pyvista.PolyData:
        """A copy as ``pyvista.PolyData``, of the finest level or of another one. Needs PyVista."""
        try:
            import pyvista
        except ImportError as error:
            raise ImportError("to_pyvista() needs the package pyvista") from error
        return pyvista.wrap(self.to_vtk(level))

    def to_trimesh(self, level: int = -1) -> trimesh.Trimesh:
        """A copy as ``trimesh.Trimesh``, of the finest level or of another one, with vertices and faces as they are here (``process=False``). Needs trimesh."""
        try:
            import trimesh
        except ImportError as error:
            raise ImportError("to_trimesh() needs the package trimesh") from error
        it = self.levels[level]
        return trimesh.Trimesh(vertices=it.vertices.copy(), faces=it.faces.astype(np.int64), process=False)

    def __repr__(self) -> str:
        text = _size_text(self.vertices, self.faces)
        if len(self.levels) > 1:
            text += f", {len(self.levels)} levels"
        finest = self.levels[-1].report
        if "genus" in finest:
            text += "; " + ", ".join(
                _counted(finest[key], noun) for key, noun in (("components", "component"), ("genus", ""), ("boundary_loops", "boundary loop"))
            )
        return f"<isoatlas.Mesh: {text}>"


def _bound_text(bound: float | None, unit: str) -> str:
    if bound is None:  # JSON has no infinity
        return "inf" + (" degrees" if unit == "degrees" else "")
    if unit == "count":
        return f"{int(bound):,}"
    return f"{bound:.6g}" + (" degrees" if unit == "degrees" else "")


def _counted(count: int, noun: str) -> str:
    if not noun:
        return f"genus {count:,}"
    return f"{count:,} {noun}" + ("" if count == 1 else "s")


def _size_text(vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.uint32]) -> str:
    return f"{len(vertices):,} {'vertex' if len(vertices) == 1 else 'vertices'}, {_counted(len(faces), 'face')}"
