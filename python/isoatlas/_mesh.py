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
        0 is the coarsest level.
    vertices : (V, 3) float64 array, read-only
        Positions in the unit of the volume's spacing. With ``placement="surface"``, the vertices of
        the previous level come first, at the same indices.
    faces : (F, 3) uint32 array, read-only
        Indices of vertices, counter-clockwise seen from outside.
    distance : (V,) float32 array, read-only, or None
        Per vertex, the largest two-sided distance between the mesh and the isosurface in the
        vertex's Voronoi cell, in the unit of the volume's spacing; ``max_distance`` bounds it. None
        if it was not measured (``coarse=True``, files of other programs).
    report : dict
        Data of the level, with the keys of ``levels[]`` in docs/reference/report.md. Empty if the
        mesh was read from a file without them.
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
    """Nested levels of triangle meshes: the result of `extract` and of `read`.

    Arrays are read-only views, not copies, because levels share their vertices. Use
    ``mesh.vertices.copy()`` to get an array that you can change. Arrays stay valid after the mesh
    is deleted.
    """

    def __init__(self, core: _core.Levels) -> None:
        """Private: use `extract` or `read`."""
        self._core = core

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """Vertices of the finest level: (V, 3) float64, read-only, in the unit of the spacing."""
        return self.levels[-1].vertices

    @property
    def faces(self) -> npt.NDArray[np.uint32]:
        """Faces of the finest level: (F, 3) uint32, read-only.

        Indices of vertices, counter-clockwise seen from outside.
        """
        return self.levels[-1].faces

    @functools.cached_property
    def levels(self) -> Sequence[Level]:
        """All levels, coarse to fine; at least one."""
        return tuple(Level(self._core, k, report) for k, report in enumerate(self.report["levels"]))

    @functools.cached_property
    def report(self) -> dict[str, Any]:
        """The report of ``isoatlas extract --report`` as a dict, see docs/reference/report.md.

        ``files`` is empty, because no files are written yet. A mesh that was read has only
        ``levels``, with the data that the file holds for each level.
        """
        text = self._core.report()
        if text:
            report: dict[str, Any] = json.loads(text)
            return report
        reports = [json.loads(level) or {} for level in self._core.level_reports()]
        return {"levels": reports or [{} for _ in range(len(self._core))]}

    @property
    def placement(self) -> str:
        """Vertex placement: ``"surface"`` (the same in all levels) or ``"balanced"``."""
        return self._core.placement

    @property
    def space(self) -> str:
        """System of coordinates that files state: ``"LPS"``, ``"RAS"`` or ``"voxel"``.

        Empty if it is unknown, as for arrays with ``order="ijk"``.
        """
        return self._core.space

    @property
    def unmet(self) -> list[str]:
        """One line for each requested bound that is violated, as the command line prints it.

        Empty if all bounds are satisfied.
        """
        return [
            f"level {k}: {c['quantity']} {_bound_text(c['bound'], c['unit'])}: "
            f"reached {_bound_text(c['reached'], c['unit'])}"
            + (f": {c['reason']}" if c["reason"] else "")
            for k, level in enumerate(self.report["levels"])
            for c in level.get("constraints", ())
            if not c["satisfied"] and not c["default"]
        ]

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        report: str | os.PathLike[str] | None = None,
        glb_per_level: bool = False,
    ) -> None:
        """Write the mesh to files: the same bytes as the ``-o`` option of the command line.

        Either all files are written completely, or none is.

        Parameters
        ----------
        path : str or path
            ``NAME.ply``, ``.stl``, ``.obj``, ``.off``, ``.vtp``, ``.3mf`` or ``.gii`` holds the
            finest level; with ``{level}`` in the name there is one file per level. ``NAME.glb`` and
            ``NAME.vtm`` hold all levels. See docs/reference/files.md for their contents.
        report : str or path, optional
            Also write the report, like ``--report``. Only for a result of `extract`.
        glb_per_level : bool
            With ``NAME.glb``: also write ``NAME-0.glb``, ``NAME-1.glb``, ... and ``NAME.json``,
            which lists them.

        Warns
        -----
        FileWarning
            Rounding to float32 in ``.stl``, ``.gii`` or ``.glb`` causes self-intersections, because
            the volume is very far from the origin.

        Raises
        ------
        BadFileError
            An ``OSError``: a file cannot be written, or float32 in ``.stl``, ``.gii`` or ``.glb``
            would merge vertices or move them too far.
        UnsupportedError
            A ``ValueError``: an unknown extension.
        BadArgumentError
            A ``ValueError``: a file would replace the volume that was read, or another output.
        """
        if warning := self._core.save(path, report, glb_per_level):
            warnings.warn(warning, FileWarning, stacklevel=2)

    def to_vtk(self, level: int = -1) -> vtkPolyData:
        """Copy a level to a ``vtkPolyData``. `Level.distance` becomes point array ``max_distance``.

        Parameters
        ----------
        level : int
            Index into `levels`; the default is the finest.

        Raises
        ------
        ImportError
            VTK is not installed (Debian: python3-vtk9).
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
        """Copy a level to a ``pyvista.PolyData``, like `to_vtk`.

        Raises
        ------
        ImportError
            PyVista or VTK is not installed.
        """
        try:
            import pyvista
        except ImportError as error:
            raise ImportError("to_pyvista() needs the package pyvista") from error
        return pyvista.wrap(self.to_vtk(level))

    def to_trimesh(self, level: int = -1) -> trimesh.Trimesh:
        """Copy a level to a ``trimesh.Trimesh`` with the same vertices and faces.

        Parameters
        ----------
        level : int
            Index into `levels`; the default is the finest.

        Raises
        ------
        ImportError
            trimesh is not installed.
        """
        try:
            import trimesh
        except ImportError as error:
            raise ImportError("to_trimesh() needs the package trimesh") from error
        it = self.levels[level]
        return trimesh.Trimesh(
            vertices=it.vertices.copy(), faces=it.faces.astype(np.int64), process=False
        )

    def __repr__(self) -> str:
        text = _size_text(self.vertices, self.faces)
        if len(self.levels) > 1:
            text += f", {len(self.levels)} levels"
        finest = self.levels[-1].report
        if "genus" in finest:
            text += "; " + ", ".join(
                _counted(finest[key], noun)
                for key, noun in (
                    ("components", "component"),
                    ("genus", ""),
                    ("boundary_loops", "boundary loop"),
                )
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
    noun = "vertex" if len(vertices) == 1 else "vertices"
    return f"{len(vertices):,} {noun}, {_counted(len(faces), 'face')}"
