# SPDX-License-Identifier: Apache-2.0
"""The accessor of PyVista's grids."""

import json
import subprocess
import sys

import numpy as np
import pytest

pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")

import isoatlas  # noqa: E402  after PyVista, so that it adds the accessor
import isoatlas.pyvista  # noqa: E402
from conftest import torus  # noqa: E402


def grid_of(array, **geometry):
    """A grid with the samples array[z, y, x]."""
    grid = pyvista.ImageData(dimensions=array.shape[::-1], **geometry)
    grid.point_data["density"] = array.ravel()
    return grid


GEOMETRY = {"spacing": (0.5, 1, 2), "origin": (7, 8, 9)}


def test_polydata_is_the_mesh():
    expected = isoatlas.extract(torus(), 0.0, order="xyz", **GEOMETRY)
    polydata = grid_of(torus(), **GEOMETRY).isoatlas.extract(0.0)
    assert isinstance(polydata, pyvista.PolyData) and polydata.is_manifold
    assert np.array_equal(polydata.points, expected.vertices)
    assert np.array_equal(polydata.faces.reshape(-1, 4)[:, 1:], expected.faces)
    assert np.array_equal(polydata.point_data["max_distance"], expected.levels[-1].distance)
    assert polydata.volume == pytest.approx(expected.volume)
    report = json.loads(polydata.field_data["isoatlas_report"][0])
    assert report["levels"][-1]["genus"] == 1 and report["parameters"]["iso"] == 0.0


def test_agrees_with_pyvistas_contour():
    grid = grid_of(torus(), **GEOMETRY)
    ours, theirs = grid.isoatlas.extract(0.0), grid.contour([0.0], scalars="density")
    assert np.allclose(ours.bounds, theirs.bounds, atol=0.5)
    assert ours.volume == pytest.approx(theirs.volume, rel=0.05)


def test_all_levels():
    grid = grid_of(torus())
    refine = [{"max_distance": "1vx"}, {"max_distance": "0.5vx"}]
    blocks = grid.isoatlas.extract(0.0, all_levels=True, refine=refine)
    assert isinstance(blocks, pyvista.MultiBlock)
    assert blocks.keys() == ["level 0", "level 1", "level 2"]
    sizes = [block.n_points for block in blocks]
    assert sizes == sorted(sizes) and sizes[0] < sizes[-1]
    report = json.loads(blocks.field_data["isoatlas_report"][0])
    assert [level["vertices"] for level in report["levels"]] == sizes


def test_turned_and_cropped_grids():
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    grid = grid_of(torus(), **GEOMETRY)
    if not hasattr(grid, "direction_matrix"):
        pytest.skip("this PyVista has no direction matrix")
    grid.direction_matrix = turn
    part = grid_of(torus(), **GEOMETRY).extract_subset((2, 13, 1, 20, 0, 25))
    assert part.extent[0] == 2 or part.origin != GEOMETRY["origin"]
    for cut in (grid, part):
        inside = cut.points[cut.point_data["density"] > 0]
        bounds = np.array(cut.isoatlas.extract(0.0).bounds)
        low, high = inside.min(axis=0), inside.max(axis=0)
        assert (bounds[::2] < low).all() and (bounds[1::2] > high).all()
        assert np.allclose(bounds[::2], low, atol=2) and np.allclose(bounds[1::2], high, atol=2)


def test_samples_are_not_copied():
    grid = grid_of(torus())
    assert np.shares_memory(grid.isoatlas.volume().array, grid.point_data["density"])


def test_scalars_are_chosen():
    grid = grid_of(torus())
    grid.point_data["negative"] = -torus().ravel()
    grid.set_active_scalars("density")
    outward = grid.isoatlas.extract(0.0, coarse=True)
    inside = grid.isoatlas.extract(0.0, scalars="negative", inside="below", coarse=True)
    assert np.array_equal(outward.points, inside.points)
    with pytest.raises(isoatlas.BadArgumentError, match="no point data 'x', the grid has density"):
        grid.isoatlas.extract(0.0, scalars="x")


@pytest.mark.parametrize("case", ["none", "cells", "vectors", "flat"])
def test_grids_without_scalars_are_refused(case):
    grid = pyvista.ImageData(dimensions=(5, 5, 1 if case == "flat" else 5))
    if case == "cells":
        grid.cell_data["density"] = np.zeros(grid.n_cells)
    if case in ("vectors", "flat"):
        shape = (grid.n_points, 3) if case == "vectors" else grid.n_points
        grid.point_data["density"] = np.zeros(shape)
        grid.set_active_scalars("density")
    message = {
        "none": "scalars: expected active point data, the grid has none",
        "cells": r"they are cell data: use grid.cell_data_to_point_data\(\)",
        "vectors": r"one number per point of a 3-D grid, got the shape \(125, 3\)",
        "flat": "on 5 x 5 x 1 points",
    }[case]
    with pytest.raises(isoatlas.Error, match=message):
        grid.isoatlas.extract(0.0)


def test_order_belongs_to_the_grid():
    with pytest.raises(isoatlas.BadArgumentError, match="order: the grid has its own"):
        grid_of(torus()).isoatlas.extract(0.0, order="ijk")
    with pytest.raises(isoatlas.BadArgumentError, match="spacing: the volume has its own"):
        grid_of(torus()).isoatlas.extract(0.0, spacing=(1, 2, 3))
    with pytest.raises(TypeError, match="expected a pyvista.ImageData, got ndarray"):
        isoatlas.pyvista.from_grid(torus())


def test_mesh_of_the_accessor(tmp_path):
    mesh = grid_of(torus()).isoatlas.extract_mesh(0.0, coarse=True)
    assert isinstance(mesh, isoatlas.Mesh) and isoatlas.check(mesh.to_pyvista()) == isoatlas.check(
        mesh
    )


@pytest.mark.parametrize(
    "imports",
    [
        "import pyvista, isoatlas",
        "import isoatlas, pyvista, isoatlas.pyvista",
        "import isoatlas.pyvista, pyvista",
    ],
)
def test_order_of_imports(imports):
    code = f"{imports}; print(pyvista.Wavelet().isoatlas.extract(157.5).n_points)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.returncode == 0 and int(run.stdout) > 10, run.stderr
