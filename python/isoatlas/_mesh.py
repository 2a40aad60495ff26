# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import functools
import math
import os
import pathlib
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np
import numpy.typing as npt

from . import _core, _html
from ._report import level_of, report_of
from .errors import FileWarning

if TYPE_CHECKING:
    import pyvista
    import trimesh
    from vtkmodules.vtkCommonDataModel import vtkPolyData


@dataclass(frozen=True, eq=False)
class Component:
    """A connected piece of a mesh. Lengths are in the unit of the vertices.

    Attributes
    ----------
    vertices, triangles : int
        Their numbers.
    genus, boundary_loops : int or None
        The number of handles, each boundary loop counted as capped by a disk, and the number of
        boundary loops. None if the mesh is not a consistently oriented manifold.
    closed : bool
        Whether it is a manifold without boundary.
    area : float
        Area of its triangles.
    volume : float
        The enclosed volume; negative if the triangles face inward, as around a cavity. NaN if the
        component is not closed.
    bounds : (2, 3) float64 array
        The smallest and the largest coordinates.
    first_vertex : int
        The smallest index of its vertices.
    """

    vertices: int
    triangles: int
    genus: int | None
    boundary_loops: int | None
    closed: bool
    area: float
    volume: float
    bounds: npt.NDArray[np.float64]
    first_vertex: int

    def __repr__(self) -> str:
        if self.genus is None or self.boundary_loops is None:
            topology = "not a manifold"
        else:
            loops = _counted(self.boundary_loops, "boundary loop")
            topology = f"genus {self.genus}, " + ("closed" if self.closed else loops)
        volume = "" if math.isnan(self.volume) else f", volume {self.volume:.6g}"
        triangles = _counted(self.triangles, "triangle")
        return f"<isoatlas.Component: {triangles}, {topology}, area {self.area:.6g}{volume}>"


class Level:
    """One level of detail of a `Mesh`. Its arrays are read-only.

    Attributes
    ----------
    number : int
        0 is the coarsest level.
    report : dict
        Data of the level, with the keys of ``levels[]`` in docs/reference/report.md; names of
        metrics and constraints are those of the arguments (``max_distance``). Empty if the mesh was
        read from a file without them.
    """

    def __init__(self, core: _core.Levels, number: int, report: dict[str, Any]) -> None:
        """Private: use `Mesh.levels`."""
        self._core = core
        self.number = number
        self.report = report

    @functools.cached_property
    def vertices(self) -> npt.NDArray[np.float64]:
        """(V, 3) float64: positions in the unit of the volume's spacing.

        With ``placement="surface"``, the vertices of the previous level come first, at the same
        indices.
        """
        return self._core.vertices(self.number)

    @functools.cached_property
    def faces(self) -> npt.NDArray[np.int64]:
        """(F, 3) int64: indices of vertices, counter-clockwise seen from outside.

        trimesh, VTK and PyVista use an array of this type without a copy.
        """
        faces = self._core.faces(self.number).astype(np.int64)
        faces.flags.writeable = False
        return faces

    @functools.cached_property
    def distance(self) -> npt.NDArray[np.float32] | None:
        """(V,) float32, or None if it was not measured (``coarse=True``, other programs' files).

        Per vertex, the largest two-sided distance between the mesh and the isosurface in the
        vertex's Voronoi cell, in the unit of the volume's spacing; ``max_distance`` bounds it.
        """
        return self._core.distance(self.number)

    @functools.cached_property
    def components(self) -> Sequence[Component]:
        """The connected pieces, the one with the largest area first. O(F log F), once."""
        return tuple(
            Component(
                vertices=vertices,
                triangles=triangles,
                genus=genus,
                boundary_loops=loops,
                closed=loops == 0,
                area=area,
                volume=volume,
                bounds=np.array((low, high)),
                first_vertex=first,
            )
            for first, vertices, triangles, genus, loops, area, volume, low, high in (
                self._core.components(self.number)
            )
        )

    @property
    def closed(self) -> bool:
        """Whether the level is a consistently oriented manifold without boundary."""
        return len(self.components) > 0 and all(it.closed for it in self.components)

    @property
    def volume(self) -> float:
        """The enclosed volume, without cavities: the sum over the components; NaN unless closed.

        Where the volume boundary cuts the surface, the mesh is open and encloses nothing.
        """
        return math.fsum(it.volume for it in self.components)

    @property
    def area(self) -> float:
        """The area of all triangles."""
        return math.fsum(it.area for it in self.components)

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """(2, 3) float64: the smallest and the largest coordinates; NaN without triangles."""
        boxes = np.array([component.bounds for component in self.components])
        if not len(boxes):
            return np.full((2, 3), np.nan)
        return np.array((boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)))

    def __reduce__(self) -> tuple[Any, ...]:
        return Level, (self._core, self.number, self.report)

    def __repr__(self) -> str:
        return f"<isoatlas.Level {self.number}: {_size_text(len(self.vertices), len(self.faces))}>"


class Mesh:
    """Nested levels of triangle meshes: the result of `extract` and of `read`.

    Arrays are read-only, because levels share their vertices. Use ``mesh.vertices.copy()`` to get
    an array that you can change. Arrays stay valid after the mesh is deleted. A mesh can be pickled
    and copied, for example to be returned by another process. In a notebook, a mesh as the last
    line of a cell is shown in 3-D.
    """

    def __init__(self, core: _core.Levels, states_order: bool = True) -> None:
        """Private: use `extract` or `read`."""
        self._core = core
        self._states_order = states_order

    @property
    def vertices(self) -> npt.NDArray[np.float64]:
        """Vertices of the finest level: (V, 3) float64, read-only, in the unit of the spacing."""
        return self.levels[-1].vertices

    @property
    def faces(self) -> npt.NDArray[np.int64]:
        """Faces of the finest level: (F, 3) int64, read-only.

        Indices of vertices, counter-clockwise seen from outside.
        """
        return self.levels[-1].faces

    @property
    def components(self) -> Sequence[Component]:
        """The connected pieces of the finest level, the one with the largest area first."""
        return self.levels[-1].components

    @property
    def closed(self) -> bool:
        """Whether the finest level has no boundary."""
        return self.levels[-1].closed

    @property
    def volume(self) -> float:
        """The volume that the finest level encloses, without cavities; NaN unless it is closed.

        In the unit of the vertices, cubed. See also ``components[k].volume``.
        """
        return self.levels[-1].volume

    @property
    def area(self) -> float:
        """The area of the finest level, in the unit of the vertices, squared."""
        return self.levels[-1].area

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """(2, 3) float64: the smallest and the largest coordinates of the finest level."""
        return self.levels[-1].bounds

    @functools.cached_property
    def levels(self) -> Sequence[Level]:
        """All levels, coarse to fine; at least one."""
        return tuple(Level(self._core, k, report) for k, report in enumerate(self.report["levels"]))

    @functools.cached_property
    def report(self) -> dict[str, Any]:
        """The report of ``isoatlas extract --report`` as a dict, see docs/reference/report.md.

        Metrics, constraints and ``parameters`` have the names of the arguments of `extract`:
        ``mesh.report["levels"][-1]["metrics"]["max_distance"]``. ``files`` is empty, because no
        files are written yet. A mesh that was read has only ``levels``, with the data that the file
        holds for each level.
        """
        if text := self._core.report():
            return report_of(text)
        reports = [level_of(level) for level in self._core.level_reports()]
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
        """One line for each requested bound that is violated.

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

        ``NAME.html`` is the page that `show` opens. Either all files are written completely, or
        none is.

        Parameters
        ----------
        path : str or path
            ``NAME.ply``, ``.stl``, ``.obj``, ``.off``, ``.vtp``, ``.3mf`` or ``.gii`` holds the
            finest level; with ``{level}`` in the name there is one file per level. ``NAME.glb`` and
            ``NAME.vtm`` hold all levels. See docs/reference/files.md for their contents.
            ``NAME.html`` is a page that shows all levels in any browser, see docs/report.md.
        report : str or path, optional
            Also write the report, like ``--report``. Only for a result of `extract`.
        glb_per_level : bool
            With ``NAME.glb``: also write ``NAME-0.glb``, ``NAME-1.glb``, ... and ``NAME.json``,
            which lists them.

        Warns
        -----
        FileWarning
            Rounding to float32 in ``.stl``, ``.gii`` or ``.glb`` causes self-intersections, because
            the volume is very far from the origin. Or the mesh is that of an array without
            ``order``: if the array is indexed ``[z, y, x]``, the file has a mirror image.

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
        if not self._states_order and not _html.is_page(path):
            warnings.warn(
                f"{os.fsdecode(path)}: x, y, z are the axes 0, 1, 2 of the array; for an array "
                "indexed [z, y, x] this is a mirror image, expected order='xyz' in extract(); "
                "order='ijk' confirms the axes",
                FileWarning,
                stacklevel=2,
            )

    def save_neuroglancer(self, folder: str | os.PathLike[str]) -> None:
        """Write all levels as a multi-resolution mesh for Neuroglancer: as ``--neuroglancer``.

        See docs/reference/files.md for the contents. Either all files are written, or none is.

        Parameters
        ----------
        folder : str or path
            Is made if it does not exist. In Neuroglancer the source is
            ``precomputed://`` and the address of the folder; the mesh is segment 1.

        Raises
        ------
        BadFileError
            An ``OSError``: a file cannot be written, the folder has the description of something
            else, or 16 bits per coordinate would change the topology.
        """
        self._core.save_neuroglancer(folder)

    def to_html(self) -> str:
        """The page that shows all levels in 3-D, as a text. It loads nothing from a network.

        See docs/report.md for what it shows. It has about 0.6 MB and 10 bytes per triangle.

        Raises
        ------
        UnsupportedError
            A ``ValueError``: isoatlas was built without pages (``ISOATLAS_BUILD_PAGE=OFF``).
        """
        return self._core.page(len(self._core))

    def show(self, path: str | os.PathLike[str] | None = None) -> pathlib.Path | None:
        """Show the mesh in 3-D: in a notebook below the cell, otherwise in the browser.

        Parameters
        ----------
        path : str or path, optional
            Write the page to this file, ``NAME.html``, and open it in the browser, also in a
            notebook. Default: a new temporary file, which stays until the system removes it.

        Returns
        -------
        Path or None
            The file of the page; None in a notebook.

        Warns
        -----
        RuntimeWarning
            No browser could be opened. The text has the name of the file.

        Raises
        ------
        UnsupportedError, BadFileError
            As `to_html` and `save`.
        """
        if path is None and _html.show_in_notebook(self):
            return None
        file = _html.page_path(path)
        self.save(file)
        _html.open_in_browser(file)
        return file

    def _repr_html_(self) -> str:
        """What a notebook shows: the page of all levels, or of as many as 4 MB can hold."""
        return _html.for_notebook(
            repr(self), len(self._core), self._core.page, self._core.triangle_counts()
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return Mesh, (self._core, self._states_order)

    def to_vtk(self, level: int = -1) -> vtkPolyData:
        """Copy a level to a ``vtkPolyData``. `Level.distance` becomes point array ``max_distance``.

        If it was made with ``border="closed"``, the cell array ``cap`` is 1 on the caps and 0
        elsewhere, as in ``.vtp`` files.

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
            numpy_to_vtkIdTypeArray(it.faces.ravel(), deep=True),
        )
        mesh = vtkPolyData()
        mesh.SetPoints(points)
        mesh.SetPolys(cells)
        if it.distance is not None:
            array = numpy_to_vtk(it.distance, deep=True)
            array.SetName("max_distance")
            mesh.GetPointData().AddArray(array)
        if caps := it.report.get("caps"):
            is_cap = np.arange(count) >= count - caps["triangles"]  # the caps are the last faces
            array = numpy_to_vtk(is_cap.astype(np.uint8), deep=True)
            array.SetName("cap")
            mesh.GetCellData().AddArray(array)
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
        return trimesh.Trimesh(vertices=it.vertices.copy(), faces=it.faces.copy(), process=False)

    def __repr__(self) -> str:
        text = _size_text(len(self.vertices), len(self.faces))
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


def _size_text(vertices: int, faces: int) -> str:
    return f"{vertices:,} {'vertex' if vertices == 1 else 'vertices'}, {_counted(faces, 'face')}"
