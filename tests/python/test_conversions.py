# SPDX-License-Identifier: Apache-2.0
import importlib.util
import json
import sys
import types

import numpy as np
import pytest

import isoatlas
from conftest import torus

MESH = isoatlas.extract(
    torus(), 0.0, order="ijk", refine=["max-distance:1vx", "max-distance:0.5vx"]
)


def check_vtk(polydata, level):
    from vtkmodules.util.numpy_support import vtk_to_numpy

    assert polydata.GetPoints().GetDataType() == 11  # VTK_DOUBLE
    assert np.array_equal(vtk_to_numpy(polydata.GetPoints().GetData()), level.vertices)
    cells = vtk_to_numpy(polydata.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    assert np.array_equal(cells, level.faces) and polydata.GetNumberOfPolys() == len(level.faces)


def test_to_vtk():
    pytest.importorskip("vtkmodules", reason="VTK is not installed")
    check_vtk(MESH.to_vtk(), MESH.levels[-1])
    polydata = MESH.to_vtk(level=0)
    check_vtk(polydata, MESH.levels[0])
    polydata.GetPoints().SetPoint(0, 1e3, 0, 0)  # a copy
    assert MESH.vertices[0, 0] != 1e3


def test_caps_are_a_cell_array():
    pytest.importorskip("vtkmodules", reason="VTK is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    assert MESH.to_vtk().GetCellData().GetArray("cap") is None
    half = torus()[:, : torus().shape[1] // 2]
    closed = isoatlas.extract(half, 0.0, order="ijk", border="closed", refine=["max-distance:1vx"])
    for level in range(2):
        caps = vtk_to_numpy(closed.to_vtk(level).GetCellData().GetArray("cap"))
        it = closed.levels[level]
        side = (it.vertices[it.faces, 1] == half.shape[1] - 1).all(axis=1)
        assert np.array_equal(caps == 1, side) and side.any()


def test_vtk_agrees_about_volume_and_edges():
    pytest.importorskip("vtkmodules", reason="VTK is not installed")
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties

    mass = vtkMassProperties()
    mass.SetInputData(MESH.to_vtk())
    a, b, c = (MESH.vertices[MESH.faces[:, k]] for k in range(3))
    assert mass.GetVolume() == pytest.approx(
        np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6, rel=1e-6
    )
    edges = vtkFeatureEdges()
    edges.SetInputData(MESH.to_vtk())
    edges.FeatureEdgesOff()
    edges.Update()
    assert edges.GetOutput().GetNumberOfCells() == 0  # closed and manifold


def test_to_pyvista():
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    mesh = MESH.to_pyvista()
    assert isinstance(mesh, pyvista.PolyData) and mesh.is_manifold
    assert np.array_equal(mesh.points, MESH.vertices)
    assert np.array_equal(mesh.faces.reshape(-1, 4)[:, 1:], MESH.faces)


def test_to_trimesh():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    mesh = MESH.to_trimesh(level=1)
    assert isinstance(mesh, trimesh.Trimesh) and mesh.is_watertight and mesh.volume > 0
    assert np.array_equal(mesh.vertices, MESH.levels[1].vertices)
    assert np.array_equal(mesh.faces, MESH.levels[1].faces)


def test_pyvista_gets_the_polydata(monkeypatch):
    pytest.importorskip("vtkmodules", reason="VTK is not installed")
    monkeypatch.setitem(
        sys.modules, "pyvista", types.SimpleNamespace(wrap=lambda it: ("wrapped", it))
    )
    wrapped, polydata = MESH.to_pyvista(level=1)
    assert wrapped == "wrapped"
    check_vtk(polydata, MESH.levels[1])


def test_faces_are_taken_without_a_copy():
    """By VTK and by trimesh, from the arrays of the mesh itself."""
    faces = MESH.faces
    assert faces.dtype == np.int64 and faces.flags.c_contiguous and not faces.flags.writeable
    assert MESH.faces is faces
    ran = 0
    if importlib.util.find_spec("vtkmodules"):
        from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray, vtk_to_numpy
        from vtkmodules.vtkCommonDataModel import vtkCellArray

        cells = vtkCellArray()
        connectivity = numpy_to_vtkIdTypeArray(faces.ravel(), deep=False)
        offsets = np.arange(0, faces.size + 1, 3, dtype=np.int64)
        cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True), connectivity)
        assert np.shares_memory(vtk_to_numpy(cells.GetConnectivityArray()), faces)
        ran += 1
    if importlib.util.find_spec("trimesh"):
        import trimesh

        theirs = trimesh.Trimesh(MESH.vertices, faces, process=False)
        assert np.shares_memory(theirs.faces, faces)
        assert np.shares_memory(theirs.vertices, MESH.vertices)
        ran += 1
    if not ran:
        pytest.skip("neither VTK nor trimesh is installed")


def test_trimesh_gets_copies(monkeypatch):
    monkeypatch.setitem(
        sys.modules, "trimesh", types.SimpleNamespace(Trimesh=lambda **given: given)
    )
    given = MESH.to_trimesh()
    assert given["process"] is False
    assert np.array_equal(given["vertices"], MESH.vertices) and given["vertices"].flags.writeable
    assert np.array_equal(given["faces"], MESH.faces) and given["faces"].dtype == np.int64


@pytest.mark.parametrize(
    ("method", "package"),
    [("to_vtk", "vtkmodules"), ("to_pyvista", "pyvista"), ("to_trimesh", "trimesh")],
)
def test_errors_name_the_missing_package(method, package, monkeypatch):
    for name in [name for name in sys.modules if name.split(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=f"{method}\\(\\) needs the package"):
        getattr(MESH, method)()


def test_distances_of_vertices(tmp_path):
    for level in MESH.levels:
        assert level.distance.dtype == np.float32 and level.distance.shape == (len(level.vertices),)
        maximum = level.report["metrics"]["max_distance"]["maximum"]
        assert level.distance.max() == np.float32(maximum)
        assert not level.distance.flags.writeable
    MESH.save(tmp_path / "m.vtm")
    for level, again in zip(MESH.levels, isoatlas.read(tmp_path / "m.vtm").levels):
        assert np.array_equal(level.distance, again.distance)
    assert isoatlas.extract(torus(), 0.0, coarse=True).levels[0].distance is None
    pytest.importorskip("vtkmodules", reason="VTK is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    assert np.array_equal(
        vtk_to_numpy(MESH.to_vtk().GetPointData().GetArray("max_distance")),
        MESH.levels[-1].distance,
    )


def test_save_neuroglancer(tmp_path):
    MESH.save_neuroglancer(tmp_path / "mesh")
    info = json.loads((tmp_path / "mesh" / "info").read_text())
    assert info["@type"] == "neuroglancer_multilod_draco"
    manifest = (tmp_path / "mesh" / "1.index").read_bytes()
    assert np.frombuffer(manifest, "<u4", 1, 24)[0] == len(MESH.levels)
    (tmp_path / "image").mkdir()
    (tmp_path / "image" / "info").write_text('{"type": "image"}')
    with pytest.raises(isoatlas.BadFileError, match="describes something else"):
        MESH.save_neuroglancer(tmp_path / "image")
    assert sorted(p.name for p in (tmp_path / "image").iterdir()) == ["info"]
