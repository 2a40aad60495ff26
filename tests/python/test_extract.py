# SPDX-License-Identifier: Apache-2.0
import gc
import inspect
import os
import random
import warnings
import weakref
import zipfile

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES, enclosed_volume, torus

# Parameters in the order of the signature, which is the order of priority of constraints.
ORDER = [*inspect.signature(isoatlas.extract).parameters]


def test_result_has_arrays_levels_and_report():
    mesh = isoatlas.extract(torus(), 0.0, refine=["max-distance:1vx", "max-distance:0.25vx"])
    assert mesh.vertices.dtype == np.float64 and mesh.vertices.shape[1] == 3
    assert mesh.faces.dtype == np.int64 and mesh.faces.shape[1] == 3
    assert [level.number for level in mesh.levels] == [0, 1, 2]
    assert mesh.faces is mesh.levels[-1].faces
    sizes = [len(level.vertices) for level in mesh.levels]
    assert sizes == sorted(sizes) and sizes[0] < sizes[-1]
    for coarse, fine in zip(mesh.levels, mesh.levels[1:]):  # nested, at the same indices
        assert np.array_equal(coarse.vertices, fine.vertices[: len(coarse.vertices)])
    assert mesh.report["schema"] == "isoatlas-report-3"
    assert mesh.report["input"]["path"] is None and mesh.report["files"] == []
    assert [level.report["genus"] for level in mesh.levels] == [1, 1, 1]
    assert [level.report["vertices"] for level in mesh.levels] == sizes
    assert mesh.levels[-1].report["metrics"]["max_distance"]["maximum"] <= 0.25
    assert mesh.unmet == []


def test_default_is_one_level_within_half_a_voxel():
    mesh = isoatlas.extract(torus(), 0.0, spacing=(2, 2, 2))
    assert mesh.report["parameters"]["refine"] == [[{"quantity": "max_distance", "bound": 1.0}]]
    assert len(mesh.levels) == 2


def test_refine_takes_texts_dicts_and_lists():
    one = {"max_distance": "0.5vx", "normal-angle": 30}
    expected = [
        {"quantity": "max_distance", "bound": 0.5},
        {"quantity": "normal_angle", "bound": 30.0},
    ]
    text = "max-distance:0.5vx,normal-angle:30deg"
    python = "max_distance:0.5vx,normal_angle:30"
    for refine in (text, python, one, [one], (one,), ["max-distance:0.5vx,normal-angle:30"]):
        mesh = isoatlas.extract(torus(), 0.0, refine=refine)
        assert mesh.report["parameters"]["refine"] == [expected]
    both = isoatlas.extract(
        torus(),
        0.0,
        refine=["max-distance:2", {"max_distance": np.float32(0.5)}],
        max_vertices=np.int64(200),
    )
    bounds = both.report["parameters"]["refine"]
    assert [[(c["quantity"], c["bound"]) for c in level] for level in bounds] == [
        [("max_vertices", 200.0), ("max_distance", 2.0)],
        [("max_vertices", 200.0), ("max_distance", 0.5)],
    ]


def test_levels_are_planned_down_to_the_bound():
    mesh = isoatlas.extract(torus(), 0.0, levels=3, max_distance="0.1vx")
    bounds = [level.report["constraints"][0]["bound"] for level in mesh.levels]
    assert bounds[2] == 0.1 and bounds[0] / bounds[1] == pytest.approx(bounds[1] / bounds[2])
    assert [goal[0]["bound"] for goal in mesh.report["parameters"]["refine"]] == bounds
    assert mesh.report["parameters"]["levels"] == 3
    sizes = [len(level.faces) for level in mesh.levels]
    assert len(sizes) == 3 and sizes == sorted(sizes)
    with pytest.raises(ValueError, match="levels .* without refine and coarse"):
        isoatlas.extract(torus(), 0.0, levels=3, refine="max-distance:1")
    with pytest.raises(ValueError, match="levels .* without refine and coarse"):
        isoatlas.extract(torus(), 0.0, levels=3, coarse=True)
    with pytest.raises(ValueError, match="levels: expected a whole number from 1 to 16"):
        isoatlas.extract(torus(), 0.0, levels=0)
    with pytest.raises(ValueError, match="levels: the finest level has no bound on max-distance"):
        isoatlas.extract(torus(), 0.0, levels=2, normal_angle=20)


def test_each_option_reaches_the_library():
    mesh = isoatlas.extract(
        torus(), -0.25, inside="below", nan="above", topology="faces", interpolation="tricubic",
        supersample=2, adaptive_supersample=1, min_component_size="2vx", keep_components=1,
        keep_near=[(1, 2, 3), (4, 5, 6.5)],
        max_radius="4vx", covering="halving", event_persistence=0.5, placement="balanced",
        space="voxel", measure_samples=1000, threads=1, allow_self_intersections=True,
        spacing=(0.5, 1, 2), order="ijk", max_distance=0.5, mean_distance=0.4, area_curvature=1.5,
        area_curvature_smooth=1.6, geodesic_ratio=1.7, normal_angle="80deg", max_vertices=5000,
        min_vertices=5, min_edge=0.01, max_edge=50, min_aspect=0.01)  # fmt: skip
    parameters = mesh.report["parameters"]
    expected = {
        "iso": -0.25, "inside": "below", "nan": "above", "topology": "faces",
        "interpolation": "tricubic", "supersample": 2,
        "adaptive_supersample": 1, "space": "voxel", "max_radius": 2.0, "covering": "halving",
        "event_persistence": 0.5, "min_component_size": 2.0, "keep_components": 1,
        "keep_near": [[1, 2, 3], [4, 5, 6.5]], "drop_near": [],
        "placement": "balanced", "allow_self_intersections": True, "measure_samples": 1000,
        "threads": 1, "coarse": [],
    }  # fmt: skip
    assert {key: parameters[key] for key in expected} == expected
    assert mesh.report["surface"]["isovalue"] == -0.25
    assert mesh.report["surface"]["inside"] == "below"
    assert mesh.report["surface"]["topology"] == "faces"
    assert [(c["quantity"], c["bound"]) for c in parameters["refine"][0]] == [
        ("max_distance", 0.5), ("mean_distance", 0.4), ("area_curvature", 1.5),
        ("area_curvature_smooth", 1.6), ("geodesic_ratio", 1.7), ("normal_angle", 80.0),
        ("max_vertices", 5000.0), ("min_vertices", 5.0), ("min_edge", 0.01), ("max_edge", 50.0),
        ("min_aspect", 0.01),
    ]  # fmt: skip
    assert mesh.placement == "balanced" and mesh.levels[1].report["measured"] is not None
    mesh = isoatlas.extract(torus(), 0.0, coarse=True, measure=True)
    assert mesh.report["parameters"]["measure_samples"] == 200_000


def test_coarse_returns_only_level_0():
    mesh = isoatlas.extract(torus(), 0.0, coarse=True, max_vertices=10_000)
    assert len(mesh.levels) == 1
    assert mesh.report["parameters"]["coarse"] == [{"quantity": "max_vertices", "bound": 10_000.0}]


def test_violated_bounds_are_listed():
    mesh = isoatlas.extract(torus(), 0.0, max_vertices=5)
    assert len(mesh.unmet) == 1
    assert mesh.unmet[0].startswith("level 1: max_vertices 5: reached ")
    assert len(mesh.vertices) > 5


@pytest.mark.parametrize(
    "bounds",
    [
        {"max_vertices": 50},
        {"max_vertices": 600, "max_distance": 0.4, "normal_angle": 12.5},
        {"max_edge": 3, "min_aspect": 0.9, "max_vertices": 700},
    ],
)
def test_lines_of_violated_bounds_are_those_of_the_command_line(bounds, tool, tmp_path):
    options = [
        f"--{name.replace('_', '-')}={bound}"
        for name, bound in sorted(bounds.items(), key=lambda item: ORDER.index(item[0]))
    ]
    protein = SAMPLES / "protein_iron.nhdr"
    output = tmp_path / "m.ply"
    run = tool("extract", protein, "--iso", "100", *options, "-q", "-o", output, status=1)
    mesh = isoatlas.extract(isoatlas.read_volume(protein), 100, **bounds)
    expected = run.stderr
    for name in ORDER:
        expected = expected.replace(name.replace("_", "-"), name)
    assert [f"isoatlas: {line}" for line in mesh.unmet] == expected.splitlines() and mesh.unmet


def test_inside_below_equals_above_of_the_negated_volume():
    volume = torus()
    above = isoatlas.extract(volume, 0.0)
    below = isoatlas.extract(-volume, 0.0, inside="below")
    assert np.array_equal(above.vertices, below.vertices)
    assert np.array_equal(above.faces, below.faces)
    assert enclosed_volume(above.vertices, above.faces) > 0


def test_same_bytes_for_any_number_of_threads():
    noise = np.random.default_rng(3).random((12, 13, 14)).astype(np.float32)
    one, two = (isoatlas.extract(noise, 0.5, threads=n, max_distance="1vx") for n in (1, 2))
    assert one.vertices.tobytes() == two.vertices.tobytes()
    for a, b in zip(one.levels, two.levels):
        assert a.faces.tobytes() == b.faces.tobytes()


def test_arrays_are_read_only_and_outlive_the_mesh():
    mesh = isoatlas.extract(torus(), 0.0)
    vertices, faces, coarse = mesh.vertices, mesh.faces, mesh.levels[0].faces
    with pytest.raises(ValueError, match="read-only"):
        vertices[0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        faces[0, 0] = 1
    assert not vertices.flags.owndata
    copies = vertices.copy(), faces.copy(), coarse.copy()
    gone = weakref.ref(mesh)
    del mesh
    gc.collect()
    assert gone() is None
    # New arrays would overwrite the memory if it had been freed.
    fillers = [np.full(vertices.shape, 7.0) for _ in range(50)]
    assert all(np.array_equal(a, b) for a, b in zip((vertices, faces, coarse), copies)) and fillers


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_is_released():
    distance = np.linalg.norm(np.indices((64, 64, 64)).T - (31.2, 30.3, 32.4), axis=-1)
    ball = (20 - distance).astype(np.float32)
    rounds = 15

    def work():
        for _ in range(rounds):
            isoatlas.extract(ball[::-1], 0.0, coarse=True)  # the array is copied
            with pytest.raises(isoatlas.EmptySurfaceError):
                isoatlas.extract(ball[::-1], 1000.0)

    work()
    before = resident_bytes()
    work()
    # One leaked copy per round would be four times as much.
    assert resident_bytes() - before < rounds * ball.nbytes / 4


def test_dropped_components_are_listed():
    volume = np.maximum(
        torus((40, 22, 14)),
        (1.4 - np.linalg.norm(np.indices((40, 22, 14)).T - (34.2, 9.8, 7.1), axis=-1)).T,
    )
    assert isoatlas.extract(volume, 0.0).levels[0].report["components"] == 2
    mesh = isoatlas.extract(volume, 0.0, keep_components=1)
    assert mesh.levels[0].report["components"] == 1
    (dropped,) = mesh.report["dropped"]  # positions are in the order of the array's axes
    assert np.linalg.norm(np.array(dropped["position"]) - (34.2, 9.8, 7.1)) < 2


def test_positions_in_the_report_are_in_coordinates_of_the_mesh():
    mesh = isoatlas.extract(
        torus(),
        0.0,
        spacing=(1, 2, 3),
        origin=(100, 200, 300),
        order="ijk",
        measure_samples=2000,
    )
    low, high = mesh.vertices.min(0) - 3, mesh.vertices.max(0) + 3
    measured = mesh.levels[1].report["measured"]
    for side in ("mesh_to_surface", "surface_to_mesh"):
        farthest = np.array(measured[side]["farthest"])
        assert (farthest > low).all() and (farthest < high).all()
    for bad in mesh.levels[0].report["bad_triangles"]["worst"]:
        assert (np.array(bad["position"]) > low).all() and (np.array(bad["position"]) < high).all()
    for level in mesh.levels:
        extent = level.report["extent"]
        for bounds in (extent, extent["largest"][0]):
            assert bounds["low"] == level.vertices.min(0).tolist()
            assert bounds["high"] == level.vertices.max(0).tolist()
        assert extent["volume"] == pytest.approx(enclosed_volume(level.vertices, level.faces))
    assert mesh.report["input"]["size"] == [26, 22, 14]
    assert mesh.report["input"]["spacing"] == [1.0, 2.0, 3.0]


def test_reprs():
    mesh = isoatlas.extract(torus(), 0.0)
    assert repr(mesh) == (
        f"<isoatlas.Mesh: {len(mesh.vertices):,} vertices, {len(mesh.faces):,} faces, 2 levels; "
        "1 component, genus 1, 0 boundary loops>"
    )
    level = mesh.levels[0]
    assert repr(level) == (
        f"<isoatlas.Level 0: {len(level.vertices)} vertices, {len(level.faces)} faces>"
    )
    assert repr(isoatlas.read(SAMPLES / "protein_iron.nhdr")).startswith(
        "<isoatlas.Volume: 68 x 68 x 68 uint8, spacing 1 x 1 x 1, '"
    )


def test_the_volumes_unit_reaches_lengths_and_files(tmp_path):
    samples, spacing = torus(), 0.25
    volume = isoatlas.Volume(samples, spacing=(spacing,) * 3, unit="um")
    in_units = isoatlas.extract(volume, 0.0, max_distance="200nm")
    in_micrometres = isoatlas.extract(volume, 0.0, max_distance=0.2)
    assert in_units.vertices.tobytes() == in_micrometres.vertices.tobytes()
    assert in_units.report["input"]["unit"] == "um"
    in_units.save(tmp_path / "a.3mf")
    with zipfile.ZipFile(tmp_path / "a.3mf") as archive:
        assert b'unit="micron"' in archive.read("3D/3dmodel.model")
    in_units.save(tmp_path / "a.gii")  # always in millimetres
    sizes = np.ptp(isoatlas.read(tmp_path / "a.gii").vertices, axis=0)
    assert np.allclose(sizes, 1e-3 * np.ptp(in_units.vertices, axis=0))


def test_self_intersections_caused_by_rounding_are_reported(tmp_path):
    """So far from the origin, float32 rounds by a fortieth of a voxel."""
    noise = random.Random(16)
    samples = np.array([noise.random() for _ in range(343)], np.float32)
    array = samples.reshape(7, 7, 7).transpose(2, 1, 0)
    mesh = isoatlas.extract(array, 0.5, origin=(4e5, 4e5, 4e5), order="xyz", coarse=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh.save(tmp_path / "far.ply")
    message = r"far\.stl: level 0: 3 self-intersections caused by rounding"
    with pytest.warns(isoatlas.FileWarning, match=message):
        mesh.save(tmp_path / "far.stl")
