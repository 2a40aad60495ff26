# SPDX-License-Identifier: Apache-2.0
"""Where things are: orders of axes, of memory and of coordinates, and which way faces face."""
import itertools

import numpy as np
import pytest

import isoatlas
from conftest import enclosed, topology, torus

SPACING = (0.7, 1.1, 1.9)
ORIGIN = (10.0, -20.0, 35.0)


def rotation(mirror):
    a, b = 0.4, -0.9
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    tilt = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    return turn @ tilt @ np.diag([1, -1 if mirror else 1, 1])


def in_memory_order(array, axes):
    """The same array, with memory running slowest along axes[0]."""
    return np.ascontiguousarray(array.transpose(axes)).transpose(np.argsort(axes))


def is_on_surface(volume, index):
    """A few vertices are moved, within their grid cells, so that triangles do not meet; of wrong axes none would be on it."""
    away = np.abs(sampled(volume, index))
    return np.median(away) < 1e-6 and away.max() < 0.5


def sampled(volume, index):
    """The trilinear interpolant at sample-index coordinates."""
    low = np.clip(np.floor(index).astype(int), 0, np.array(volume.shape) - 2)
    t = index - low
    value = np.zeros(len(index))
    for corner in itertools.product((0, 1), repeat=3):
        weight = np.where(corner, t, 1 - t).prod(axis=1)
        value += weight * volume[tuple((low + corner).T)]
    return value


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize("order", ["ijk", "xyz"])
@pytest.mark.parametrize("axes", list(itertools.permutations(range(3))))
def test_vertices_are_where_the_volume_is_zero_and_faces_face_outward(axes, order, mirror):
    volume = torus(dtype=np.float64)
    direction = rotation(mirror)
    mesh = isoatlas.extract(
        in_memory_order(volume, axes), 0.0, spacing=SPACING, origin=ORIGIN, direction=direction, order=order, coarse=True
    )
    index = np.linalg.solve(direction, (mesh.vertices - ORIGIN).T).T / SPACING
    if order == "xyz":
        index = index[:, ::-1]
    assert is_on_surface(volume, index)
    assert enclosed(mesh.vertices, mesh.faces) > 0
    assert mesh.levels[0].report["genus"] == 1


@pytest.mark.parametrize("axes", list(itertools.permutations(range(3))))
@pytest.mark.parametrize("order", ["ijk", "xyz"])
def test_voxel_coordinates_are_indices(axes, order):
    volume = torus(dtype=np.float64)
    mesh = isoatlas.extract(in_memory_order(volume, axes), 0.0, spacing=SPACING, origin=ORIGIN, order=order, space="voxel", coarse=True)
    index = mesh.vertices if order == "ijk" else mesh.vertices[:, ::-1]
    assert is_on_surface(volume, index)
    assert enclosed(mesh.vertices, mesh.faces) > 0


def test_orders_of_one_array_are_mirror_images():
    volume = torus()
    ijk = isoatlas.extract(volume, 0.0, spacing=SPACING, origin=ORIGIN)
    xyz = isoatlas.extract(volume, 0.0, spacing=SPACING[::-1], origin=ORIGIN[::-1], order="xyz")
    assert np.array_equal(ijk.vertices[:, ::-1], xyz.vertices)
    for a, b in zip(ijk.levels, xyz.levels):
        assert np.array_equal(a.faces[:, [0, 2, 1]], b.faces)


def test_orders_of_memory_have_the_same_topology():
    noise = np.random.default_rng(11).random((14, 15, 16)).astype(np.float32)
    found = [
        topology(isoatlas.extract(in_memory_order(noise, axes), 0.5, coarse=True, allow_self_intersections=True).levels[0].report)
        for axes in itertools.permutations(range(3))
    ]
    assert all(one == found[0] for one in found)


@pytest.mark.parametrize("axes", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
def test_ras_negates_x_and_y(axes):
    volume = in_memory_order(torus(), axes)
    lps = isoatlas.extract(volume, 0.0, spacing=SPACING, origin=ORIGIN, order="xyz", measure_samples=1000)
    ras = isoatlas.extract(volume, 0.0, spacing=SPACING, origin=ORIGIN, order="xyz", measure_samples=1000, space="ras")
    assert np.array_equal(lps.vertices * (-1, -1, 1), ras.vertices) and np.array_equal(lps.faces, ras.faces)
    far = [m.levels[1].report["measured"]["mesh_to_surface"]["farthest"] for m in (lps, ras)]
    assert far[1] == [-far[0][0], -far[0][1], far[0][2]]
    with pytest.raises(isoatlas.BadArgumentError, match="order='xyz'"):
        isoatlas.extract(volume, 0.0, space="ras")


def test_files_say_a_space_only_where_there_is_one(tmp_path):
    for order, space, said in (("xyz", "lps", "LPS"), ("xyz", "ras", "RAS"), ("ijk", "lps", ""), ("ijk", "voxel", "voxel")):
        mesh = isoatlas.extract(torus(), 0.0, order=order, space=space, coarse=True)
        mesh.save(tmp_path / "m.ply")
        assert mesh.space == said and isoatlas.read_mesh(tmp_path / "m.ply").space == said


def test_direction_may_be_nine_numbers():
    volume, direction = torus(), rotation(True)
    flat = isoatlas.extract(volume, 0.0, direction=direction.ravel(), coarse=True)
    assert np.array_equal(flat.vertices, isoatlas.extract(volume, 0.0, direction=direction.tolist(), coarse=True).vertices)
