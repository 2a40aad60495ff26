# SPDX-License-Identifier: Apache-2.0
"""The installed wheel with the current packages of PyPI: real conversions, in both directions.

It runs in the virtual environment that test_wheel.py makes.
"""

import subprocess
import sys

import meshio
import numpy as np
import pytest
import pyvista
import skimage.measure
import trimesh
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import isoatlas

VOLUME = isoatlas.examples.load_protein()
MESH = isoatlas.extract(VOLUME, 100, refine=[{"max_distance": "1vx"}, {"max_distance": "0.5vx"}])


def image_of(volume):
    image = vtk.vtkImageData()
    image.SetDimensions(volume.array.shape[::-1])
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    samples = numpy_to_vtk(np.ascontiguousarray(volume.array).ravel(), deep=True)
    samples.SetName("density")
    image.GetPointData().SetScalars(samples)
    return image


def test_polydata_to_and_from():
    polydata = MESH.to_pyvista()
    assert isinstance(polydata, pyvista.PolyData) and polydata.is_manifold
    assert polydata.volume == pytest.approx(MESH.volume, rel=1e-6)
    report = isoatlas.check(polydata)
    assert report["manifold"] and report["genus"] == MESH.report["levels"][-1]["genus"] == 8


def test_multiblock_of_the_accessor():
    blocks = pyvista.wrap(image_of(VOLUME)).isoatlas.extract(
        100, all_levels=True, refine=[{"max_distance": "1vx"}, {"max_distance": "0.5vx"}]
    )
    assert isinstance(blocks, pyvista.MultiBlock) and len(blocks) == len(MESH.levels)
    for block, level in zip(blocks, MESH.levels):
        assert np.array_equal(block.points, level.vertices)
        assert np.array_equal(block.regular_faces, level.faces)


def test_image_data_of_vtk_by_file(tmp_path):
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(tmp_path / "v.vti"))
    writer.SetInputData(image_of(VOLUME))
    assert writer.Write() == 1
    volume = isoatlas.read_volume(tmp_path / "v.vti")
    assert volume.array.dtype == VOLUME.array.dtype
    assert np.array_equal(volume.array, VOLUME.array)


def test_vtk_reads_the_written_files(tmp_path):
    MESH.save(tmp_path / "m.vtp")
    MESH.save(tmp_path / "m.vtm")
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(tmp_path / "m.vtp"))
    reader.Update()
    polydata = reader.GetOutput()
    assert np.array_equal(vtk_to_numpy(polydata.GetPoints().GetData()), MESH.vertices)
    cells = vtk_to_numpy(polydata.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    assert np.array_equal(cells, MESH.faces)
    levels = pyvista.read(tmp_path / "m.vtm")
    assert [block.n_cells for block in levels] == [len(level.faces) for level in MESH.levels]
    assert np.array_equal(levels[-1].point_data["max_distance"], MESH.levels[-1].distance)


def test_vtk_writes_what_isoatlas_reads(tmp_path):
    MESH.to_pyvista().save(tmp_path / "theirs.vtp")
    again = isoatlas.read_mesh(tmp_path / "theirs.vtp")
    assert np.array_equal(again.vertices, MESH.vertices)
    assert np.array_equal(again.faces, MESH.faces)


def test_trimesh_takes_the_arrays():
    theirs = trimesh.Trimesh(MESH.vertices, MESH.faces, process=False)
    assert np.shares_memory(theirs.faces, MESH.faces)
    assert np.shares_memory(theirs.vertices, MESH.vertices)
    assert theirs.is_watertight and theirs.is_winding_consistent
    assert theirs.volume == pytest.approx(MESH.volume)
    assert isoatlas.check(theirs)["genus"] == 8


@pytest.mark.parametrize("extension", ["ply", "obj", "stl", "off", "vtk"])
def test_meshio_writes_and_reads(extension, tmp_path):
    theirs = tmp_path / f"theirs.{extension}"
    meshio.Mesh(MESH.vertices, [("triangle", MESH.faces)]).write(theirs)
    again = meshio.read(theirs)
    assert np.array_equal(np.vstack([it.data for it in again.cells if it.type == "triangle"]),
                          MESH.faces) or extension == "stl"
    if extension == "vtk":
        return
    ours = isoatlas.read_mesh(theirs)
    assert len(ours.faces) == len(MESH.faces)
    assert isoatlas.check(ours)["genus"] == 8
    MESH.save(tmp_path / f"ours.{extension}")
    read = meshio.read(tmp_path / f"ours.{extension}")
    assert sum(len(it.data) for it in read.cells if it.type == "triangle") == len(MESH.faces)


def test_marching_cubes_of_scikit_image():
    array = VOLUME.array.astype(np.float32)
    theirs = skimage.measure.marching_cubes(array, 100.5)
    ours = isoatlas.marching_cubes(array, 100.5)
    assert [it.dtype for it in ours] == [it.dtype for it in theirs]
    volumes = [abs(trimesh.Trimesh(v, f, process=False).volume) for v, f, *_ in (ours, theirs)]
    assert volumes[0] == pytest.approx(volumes[1], rel=0.1)  # chords of a very thin structure
    assert len(ours[1]) < len(theirs[1]) / 5
    for corner in (np.min, np.max):
        assert np.allclose(corner(theirs[0], axis=0), corner(ours[0], axis=0), atol=0.6)


BOTH = """
import sys
order = sys.argv[1].split(",")
for name in order:
    __import__(name)
import isoatlas.pyvista, pyvista, vtk
mesh = isoatlas.extract(isoatlas.examples.load_protein(), 100)
grid = pyvista.Wavelet()
surface = grid.isoatlas.extract(157.5)
contour = grid.contour([157.5])
mesh.save("m.vtp"), mesh.save("m.html"), surface.save("s.vtp")
assert pyvista.read("m.vtp").n_cells == len(mesh.faces) == 3002
assert len(isoatlas.read("s.vtp").faces) == surface.n_cells
print("done", surface.n_cells, contour.n_cells)
"""


@pytest.mark.parametrize("order", ["vtk,isoatlas", "isoatlas,vtk", "pyvista,isoatlas",
                                   "isoatlas,pyvista", "vtk,trimesh,skimage,isoatlas"])
@pytest.mark.parametrize("global_symbols", [False, True])
def test_orders_of_imports(order, global_symbols, tmp_path):
    """Also if the libraries of all modules share their symbols, as in ParaView."""
    flags = "import os, sys\nsys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)\n"
    code = (flags if global_symbols else "") + BOTH
    done = subprocess.run([sys.executable, "-c", code, order], cwd=tmp_path, capture_output=True,
                          text=True)
    assert done.returncode == 0 and done.stdout.startswith("done"), (done.returncode, done.stderr)


def test_a_page_is_shown(tmp_path):
    page = MESH.to_html()
    assert "isoatlas-geometry" in page and len(page) > 500_000
