# SPDX-License-Identifier: Apache-2.0
"""Orders of axes, memory and coordinates: positions and orientation of the mesh."""

import itertools
import warnings

import numpy as np
import pytest

import isoatlas
from conftest import enclosed_volume, topology, torus

SPACING = (0.7, 1.1, 1.9)
ORIGIN = (10.0, -20.0, 35.0)


def rotation(mirror):
    a, b = 0.4, -0.9
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    tilt = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    return turn @ tilt @ np.diag([1, -1 if mirror else 1, 1])


def in_memory_order(array, axes):
    """A copy of the array whose largest stride is along axes[0] and smallest along axes[2]."""
    return np.ascontiguousarray(array.transpose(axes)).transpose(np.argsort(axes))


def is_on_surface(volume, index):
    """Whether the vertices are on the surface where the volume is 0.

    A few vertices may be displaced within their grid cells to separate triangles. With wrong axes,
    no vertex would be on the surface.
    """
    values = np.abs(sampled(volume, index))
    return np.median(values) < 1e-6 and values.max() < 0.5


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
def test_vertices_are_on_the_surface_and_faces_are_outward(axes, order, mirror):
    volume = torus(dtype=np.float64)
    direction = rotation(mirror)
    mesh = isoatlas.extract(
        in_memory_order(volume, axes),
        0.0,
        spacing=SPACING,
        origin=ORIGIN,
        direction=direction,
        order=order,
        coarse=True,
    )
    index = np.linalg.solve(direction, (mesh.vertices - ORIGIN).T).T / SPACING
    if order == "xyz":
        index = index[:, ::-1]
    assert is_on_surface(volume, index)
    assert enclosed_volume(mesh.vertices, mesh.faces) > 0
    assert mesh.levels[0].report["genus"] == 1


@pytest.mark.parametrize("axes", list(itertools.permutations(range(3))))
@pytest.mark.parametrize("order", ["ijk", "xyz"])
def test_voxel_coordinates_are_indices(axes, order):
    volume = torus(dtype=np.float64)
    mesh = isoatlas.extract(
        in_memory_order(volume, axes),
        0.0,
        spacing=SPACING,
        origin=ORIGIN,
        order=order,
        space="voxel",
        coarse=True,
    )
    index = mesh.vertices if order == "ijk" else mesh.vertices[:, ::-1]
    assert is_on_surface(volume, index)
    assert enclosed_volume(mesh.vertices, mesh.faces) > 0


def test_orders_of_one_array_are_mirror_images():
    volume = torus()
    ijk = isoatlas.extract(volume, 0.0, spacing=SPACING, origin=ORIGIN, order="ijk")
    xyz = isoatlas.extract(volume, 0.0, spacing=SPACING[::-1], origin=ORIGIN[::-1], order="xyz")
    assert np.array_equal(ijk.vertices[:, ::-1], xyz.vertices)
    for a, b in zip(ijk.levels, xyz.levels):
        assert np.array_equal(a.faces[:, [0, 2, 1]], b.faces)


def test_orders_of_memory_have_the_same_topology():
    noise = np.random.default_rng(11).random((14, 15, 16)).astype(np.float32)
    found = []
    for axes in itertools.permutations(range(3)):
        array = in_memory_order(noise, axes)
        mesh = isoatlas.extract(array, 0.5, coarse=True, allow_self_intersections=True)
        found.append(topology(mesh.levels[0].report))
    assert all(numbers == found[0] for numbers in found)


@pytest.mark.parametrize("axes", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
def test_ras_negates_x_and_y(axes):
    volume = in_memory_order(torus(), axes)
    options = {"spacing": SPACING, "origin": ORIGIN, "order": "xyz", "measure_samples": 1000}
    lps = isoatlas.extract(volume, 0.0, **options)
    ras = isoatlas.extract(volume, 0.0, **options, space="ras")
    assert np.array_equal(lps.vertices * (-1, -1, 1), ras.vertices)
    assert np.array_equal(lps.faces, ras.faces)
    far = [m.levels[1].report["measured"]["mesh_to_surface"]["farthest"] for m in (lps, ras)]
    assert far[1] == [-far[0][0], -far[0][1], far[0][2]]
    with pytest.raises(isoatlas.BadArgumentError, match="order='xyz'"):
        isoatlas.extract(volume, 0.0, space="ras")


def test_files_state_a_space_only_if_it_is_known(tmp_path):
    for order, space, stated in (
        ("xyz", "lps", "LPS"),
        ("xyz", "ras", "RAS"),
        ("ijk", "lps", ""),
        ("ijk", "voxel", "voxel"),
    ):
        mesh = isoatlas.extract(torus(), 0.0, order=order, space=space, coarse=True)
        mesh.save(tmp_path / "m.ply")
        assert mesh.space == stated
        assert isoatlas.read_mesh(tmp_path / "m.ply").space == stated


def test_direction_may_be_nine_numbers():
    volume, direction = torus(), rotation(True)
    options = {"order": "ijk", "coarse": True}
    flat = isoatlas.extract(volume, 0.0, direction=direction.ravel(), **options)
    rows = isoatlas.extract(volume, 0.0, direction=direction.tolist(), **options)
    assert np.array_equal(flat.vertices, rows.vertices)


VOLUME = isoatlas.Volume(torus(), spacing=SPACING, origin=ORIGIN, direction=rotation(False))


def test_spacing_of_a_volume_states_the_order():
    """The natural code for a mask or a filtered array is right."""
    array = VOLUME.array - 0.25  # any function of the array
    expected = isoatlas.extract(VOLUME.replace(array=array), 0.0)
    geometry = {name: getattr(VOLUME, name) for name in ("spacing", "origin", "direction")}
    assert np.array_equal(isoatlas.extract(array, 0.0, **geometry).vertices, expected.vertices)
    mesh = isoatlas.extract(array, 0.0, spacing=VOLUME.spacing)
    explicit = isoatlas.extract(array, 0.0, spacing=SPACING, order="xyz")
    assert np.array_equal(mesh.vertices, explicit.vertices)
    assert mesh.space == "LPS"
    own = isoatlas.XYZ(x=0.7, y=1.1, z=1.9)
    assert np.array_equal(isoatlas.extract(array, 0.0, spacing=own).vertices, mesh.vertices)
    measured = isoatlas.check(mesh, volume=array, iso=0.0, spacing=own, samples=1000)
    assert measured["distance"]["maximum"] < 0.8


@pytest.mark.parametrize("name", ["spacing", "origin", "direction"])
def test_order_of_a_volume_does_not_contradict(name):
    with pytest.raises(isoatlas.BadArgumentError, match=f"order: the {name} is that of a Volume"):
        isoatlas.extract(VOLUME.array, 0.0, order="ijk", **{name: getattr(VOLUME, name)})


@pytest.mark.parametrize(
    ("name", "value"),
    [("spacing", SPACING), ("origin", ORIGIN), ("direction", rotation(False))],
)
def test_geometry_that_depends_on_the_order_needs_it(name, value):
    with pytest.raises(isoatlas.BadArgumentError, match=f"order: expected it with this {name}"):
        isoatlas.extract(torus(), 0.0, **{name: value})
    with pytest.raises(isoatlas.BadArgumentError, match=f"order: expected it with this {name}"):
        mesh = isoatlas.extract(torus(), 0.0)
        isoatlas.check(mesh, volume=torus(), iso=0.0, **{name: value})
    for order in ("ijk", "xyz"):
        isoatlas.extract(torus(), 0.0, order=order, coarse=True, **{name: value})


def test_geometry_that_is_the_same_in_both_orders_needs_none():
    turn = [[0, 1, 0], [1, 0, 0], [0, 0, 1]]
    assert not np.array_equal(turn, np.array(turn)[::-1, ::-1])
    both = [[0, 0, 1], [0, 1, 0], [1, 0, 0]]
    mesh = isoatlas.extract(
        torus(), 0.0, spacing=(2, 3, 2), origin=(1, 5, 1), direction=both, coarse=True
    )
    assert mesh.space == ""
    with pytest.raises(isoatlas.BadArgumentError, match="order: expected it with this direction"):
        isoatlas.extract(torus(), 0.0, direction=turn)


def test_files_of_an_unknown_order_come_with_a_warning(tmp_path):
    mesh = isoatlas.extract(torus(), 0.0, coarse=True)
    with pytest.warns(isoatlas.FileWarning, match="mirror image, expected order='xyz'") as caught:
        mesh.save(tmp_path / "m.stl")
    assert caught[0].filename == __file__ and (tmp_path / "m.stl").is_file()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.save(tmp_path / "m.html")
        for known in (
            isoatlas.extract(torus(), 0.0, order="ijk", coarse=True),
            isoatlas.extract(torus(), 0.0, order="xyz", coarse=True),
            isoatlas.extract(torus(), 0.0, spacing=isoatlas.XYZ(1, 1, 1), coarse=True),
            isoatlas.extract(VOLUME, 0.0, coarse=True),
        ):
            known.save(tmp_path / "m.stl")
            isoatlas.read_mesh(tmp_path / "m.stl").save(tmp_path / "n.stl")
