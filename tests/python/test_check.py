# SPDX-License-Identifier: Apache-2.0
import json
import types

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES, torus

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
SIDES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def test_counts_of_a_tetrahedron():
    report = isoatlas.check(TETRAHEDRON, SIDES)
    assert report["schema"] == "isoatlas-check-1" and report["path"] is None
    assert report["manifold"] and report["oriented"] and report["closed"]
    counts = [report[key] for key in ("vertices", "edges", "triangles", "genus")]
    assert counts == [4, 6, 4, 0]
    assert report["self_intersections"] is None and report["distance"] is None


def test_meshes_have_their_own_faces():
    mesh = isoatlas.extract(torus(), 0.0)
    expected = isoatlas.check(mesh.vertices, mesh.faces)
    assert expected["triangles"] == len(mesh.faces) and expected["genus"] == 1
    assert isoatlas.check(mesh) == isoatlas.check(mesh.levels[-1]) == expected
    coarse = isoatlas.check(mesh.levels[0], self_intersections=True)
    assert coarse["triangles"] == len(mesh.levels[0].faces) < len(mesh.faces)
    like_trimesh = types.SimpleNamespace(vertices=mesh.vertices, faces=mesh.faces)
    assert isoatlas.check(like_trimesh) == expected
    padded = np.column_stack([np.full(len(mesh.faces), 3), mesh.faces]).ravel()
    polydata = types.SimpleNamespace(points=mesh.vertices, faces=padded, is_all_triangles=True)
    assert isoatlas.check(polydata) == expected
    polydata.is_all_triangles = False
    with pytest.raises(isoatlas.UnsupportedError, match="triangulate"):
        isoatlas.check(polydata)
    with pytest.raises(TypeError, match="faces: the mesh has its own"):
        isoatlas.check(mesh, mesh.faces)
    for wrong in (mesh.vertices, None, "mesh.ply"):
        with pytest.raises(TypeError, match="mesh: expected a mesh, or an array of vertices and"):
            isoatlas.check(wrong)


def test_faults_are_found():
    inconsistent = SIDES.copy()
    inconsistent[0] = inconsistent[0][::-1]
    assert not isoatlas.check(TETRAHEDRON, inconsistent)["oriented"]
    assert isoatlas.check(TETRAHEDRON, inconsistent)["genus"] is None
    assert not isoatlas.check(TETRAHEDRON, SIDES[:3])["closed"]
    assert isoatlas.check(TETRAHEDRON, np.vstack([SIDES, [[0, 1, 2]]]))["non_manifold_edges"] == 3


def test_self_intersections():
    vertices = np.vstack([TETRAHEDRON, TETRAHEDRON + 0.1])
    faces = np.vstack([SIDES, SIDES + 4])
    report = isoatlas.check(vertices, faces, self_intersections=True)
    assert report["self_intersections"]["pairs"] > 0
    report = isoatlas.check(TETRAHEDRON, SIDES, self_intersections=True)
    assert report["self_intersections"] == {"pairs": 0, "first": []}


@pytest.mark.parametrize("space", ["lps", "ras", "voxel"])
def test_same_as_the_command_line(space, tool, tmp_path):
    volume = isoatlas.read_volume(SAMPLES / "protein_iron.nhdr")
    mesh = isoatlas.extract(volume, 100, space=space)
    mesh.save(tmp_path / "m.ply")
    ours = isoatlas.check(
        mesh.vertices,
        mesh.faces,
        self_intersections=True,
        volume=volume,
        iso=100,
        space=space,
        samples=4000,
    )
    options = "--self-intersections --iso 100 --samples 4000 --json --volume".split()
    run = tool("check", tmp_path / "m.ply", *options, SAMPLES / "protein_iron.nhdr")
    theirs = json.loads(run.stdout)
    assert list(ours) == list(theirs)
    del ours["path"], theirs["path"]
    assert ours == theirs


def test_distance_in_any_order():
    """Distances do not depend on orders; positions are in the coordinates of the mesh."""
    volume = torus(dtype=np.float64)
    spacing, origin = (0.5, 1.0, 2.0), (7.0, 8.0, 9.0)
    areas = []
    for array in (volume, np.asfortranarray(volume)):
        for order in ("ijk", "xyz"):
            turn = 1 if order == "ijk" else -1
            geometry = {"spacing": spacing[::turn], "origin": origin[::turn], "order": order}
            mesh = isoatlas.extract(array, 0.0, **geometry, max_distance=0.4)
            report = isoatlas.check(
                mesh.vertices, mesh.faces, volume=array, iso=0.0, **geometry, samples=20_000
            )["distance"]
            assert report["maximum"] < 0.8
            assert report["normal_degrees"]["mean"] < 45, "triangles are reversed"
            farthest = np.array(report["mesh_to_surface"]["farthest"])
            assert (farthest >= mesh.vertices.min(0) - 0.1).all()
            assert (farthest <= mesh.vertices.max(0) + 0.1).all()
            areas.append(report["surface_area"])
    assert np.ptp(areas) < 0.05 * areas[0]


def test_any_array_of_numbers_is_accepted():
    expected = isoatlas.check(TETRAHEDRON, SIDES)
    for vertices in (
        TETRAHEDRON.astype(np.float32),
        TETRAHEDRON.astype(int),
        np.asfortranarray(TETRAHEDRON),
        TETRAHEDRON.tolist(),
    ):
        for faces in (
            SIDES.astype(np.uint8),
            SIDES.astype(">i4"),
            np.asfortranarray(SIDES),
            SIDES.tolist(),
        ):
            assert isoatlas.check(vertices, faces) == expected
    assert isoatlas.check(np.empty((0, 3)), np.empty((0, 3)))["triangles"] == 0


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        (TETRAHEDRON, SIDES + 1, "faces: triangle 1 uses vertex 4, but there are only 4"),
        (TETRAHEDRON, SIDES - 1, "faces: triangle 0 uses vertex -1"),
        (TETRAHEDRON, SIDES.astype(float), "faces: expected indices of vertices, got float64"),
        (TETRAHEDRON, SIDES.ravel(), r"faces: expected an array of shape \(F, 3\), got \(12,\)"),
        (TETRAHEDRON[:, :2], SIDES, r"vertices: expected an array of shape \(V, 3\), got \(4, 2\)"),
        (TETRAHEDRON + 0j, SIDES, "vertices: expected numbers, got complex128"),
        (
            np.where(TETRAHEDRON == 1, np.nan, 0),
            SIDES,
            "vertices: the position of vertex 1 is not finite",
        ),
    ],
)
def test_invalid_meshes_are_refused(vertices, faces, message):
    with pytest.raises(isoatlas.BadArgumentError, match=message):
        isoatlas.check(vertices, faces)


def test_a_distance_needs_volume_and_isovalue():
    for options in ({"volume": torus()}, {"iso": 0.0}):
        with pytest.raises(isoatlas.BadArgumentError, match="expected both or none"):
            isoatlas.check(TETRAHEDRON, SIDES, **options)
    with pytest.raises(
        isoatlas.BadArgumentError, match="samples: expected a whole number, 1 or more, got '0'"
    ):
        isoatlas.check(TETRAHEDRON, SIDES, volume=torus(), iso=0.0, samples=0)
    with pytest.raises(isoatlas.BadArgumentError, match="threads"):
        isoatlas.check(TETRAHEDRON, SIDES, threads=-1)
