# SPDX-License-Identifier: Apache-2.0
"""Volume, area and bounds of meshes and of their components."""

import math

import numpy as np
import pytest

import isoatlas
from conftest import enclosed_volume, torus


def ball(centre, radius, shape=(40, 30, 30)):
    i, j, k = np.indices(shape)
    return radius - np.sqrt((i - centre[0]) ** 2 + (j - centre[1]) ** 2 + (k - centre[2]) ** 2)


TWO = np.maximum(ball((11, 14, 15), 8), ball((30, 14.5, 15), 5))


def test_ball():
    mesh = isoatlas.extract(ball((11, 14, 15), 8), 0.0, max_distance=0.05, supersample=2)
    assert mesh.closed and mesh.volume == pytest.approx(4 / 3 * math.pi * 8**3, rel=0.02)
    assert mesh.area == pytest.approx(4 * math.pi * 8**2, rel=0.01)
    assert mesh.bounds == pytest.approx(np.array([[3, 6, 7], [19, 22, 23]]), abs=0.06)
    assert mesh.volume == pytest.approx(enclosed_volume(mesh.vertices, mesh.faces), rel=1e-12)


def test_components_are_sorted_by_area():
    mesh = isoatlas.extract(TWO, 0.0)
    large, small = mesh.components
    assert large.area > small.area and large.volume > small.volume > 0
    assert (large.genus, large.boundary_loops, large.closed) == (0, 0, True)
    assert large.triangles + small.triangles == len(mesh.faces)
    assert large.vertices + small.vertices == len(mesh.vertices)
    assert mesh.volume == large.volume + small.volume and mesh.area == large.area + small.area
    assert large.bounds[0, 0] < 4 and large.bounds[1, 0] < 20 < small.bounds[0, 0]
    assert np.array_equal(mesh.bounds[0], np.minimum(large.bounds[0], small.bounds[0]))
    assert np.array_equal(mesh.bounds[1], np.maximum(large.bounds[1], small.bounds[1]))
    for component in mesh.components:
        vertex = mesh.vertices[component.first_vertex]
        assert (component.bounds[0] <= vertex).all() and (vertex <= component.bounds[1]).all()
    assert repr(large).startswith(f"<isoatlas.Component: {large.triangles} triangles, genus 0, clo")
    assert mesh.levels[0].volume != mesh.volume
    for array in (TWO, TWO[::-1]):  # the small one has the first vertex of one of them
        one, two = isoatlas.extract(array.copy(), 0.0).components
        assert one.area > two.area and {0} < {one.first_vertex, two.first_vertex}


def test_a_cavity_has_a_negative_volume():
    shell = np.minimum(ball((11, 14, 15), 8), -ball((11, 14, 15), 4))
    outer, inner = isoatlas.extract(shell, 0.0).components
    assert outer.volume > 0 > inner.volume
    mesh = isoatlas.extract(shell, 0.0)
    assert mesh.volume == outer.volume + inner.volume
    assert mesh.volume == pytest.approx(4 / 3 * math.pi * (8**3 - 4**3), rel=0.1)


def test_an_open_component_encloses_nothing():
    mesh = isoatlas.extract(TWO[:31], 0.0)
    closed, cut = mesh.components
    assert closed.closed and not cut.closed and cut.boundary_loops == 1
    assert math.isnan(cut.volume) and closed.volume > 0
    assert math.isnan(mesh.volume) and not mesh.closed and mesh.area > 0
    assert "1 boundary loop, area" in repr(cut) and "volume" not in repr(cut)


def test_units_and_genus():
    mesh = isoatlas.extract(torus(), 0.0, spacing=(2, 2, 2))
    (component,) = mesh.components
    assert component.genus == 1
    voxels = isoatlas.extract(torus(), 0.0, spacing=(2, 2, 2), space="voxel")
    assert mesh.volume == pytest.approx(8 * voxels.volume)
    assert mesh.area == pytest.approx(4 * voxels.area)


def test_far_from_the_origin_volumes_keep_their_digits():
    near = isoatlas.extract(ball((11, 14, 15), 8), 0.0)
    far = isoatlas.extract(ball((11, 14, 15), 8), 0.0, origin=(2.0**30,) * 3)
    assert far.volume == pytest.approx(near.volume, rel=1e-6)


def test_meshes_of_other_programs(tmp_path):
    off = "OFF\n5 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"
    (tmp_path / "tetrahedron.off").write_text(off)
    mesh = isoatlas.read_mesh(tmp_path / "tetrahedron.off")
    assert mesh.volume == pytest.approx(1 / 6) and mesh.closed
    assert np.array_equal(mesh.bounds, [[0, 0, 0], [1, 1, 1]])  # vertex 4 is in no triangle
    (tmp_path / "fan.off").write_text(off.replace("5 4 0", "5 5 0") + "3 0 1 4\n")
    mesh = isoatlas.read_mesh(tmp_path / "fan.off")
    (component,) = mesh.components
    assert component.genus is None and component.boundary_loops is None and not mesh.closed
    assert math.isnan(mesh.volume) and "not a manifold" in repr(component)


def test_agrees_with_trimesh():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    mesh = isoatlas.extract(TWO, 0.0)
    theirs = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert mesh.volume == pytest.approx(theirs.volume) and mesh.area == pytest.approx(theirs.area)
    assert np.allclose(mesh.bounds, theirs.bounds)
