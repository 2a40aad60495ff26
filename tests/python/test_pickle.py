# SPDX-License-Identifier: Apache-2.0
"""Meshes and volumes are pickled and copied completely."""

import concurrent.futures
import copy
import json
import multiprocessing
import pickle

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES, torus


def meshes():
    protein = isoatlas.read_volume(SAMPLES / "protein_iron.nhdr")
    array = torus()
    nearly_all = {
        "min_component_size": 40,
        "max_distance": 0.1,  # not satisfied: a reason
        "max_edge": "3vx",
        "min_aspect": 0.4,
        "supersample": 1,
        "adaptive_supersample": 1,
        "max_radius": "9vx",
        "event_persistence": 1,
        "measure_samples": 1000,
    }
    return {
        "default": isoatlas.extract(array, 0.0),
        "options": isoatlas.extract(protein, 100, **nearly_all),
        "balanced": isoatlas.extract(array, 0.0, placement="balanced", order="ijk"),
        "coarse": isoatlas.extract(array, 0.0, coarse=True, max_vertices=10, order="xyz"),
        "far": isoatlas.extract(array, 0.0, origin=(4e5, 4e5, 4e5), order="ijk"),
    }


MESHES = meshes()


def assert_same(one, other, folder):
    """All properties of the meshes are the same."""
    assert other is not one and other.report == one.report and other.unmet == one.unmet
    assert (other.space, other.placement) == (one.space, one.placement)
    assert len(other.levels) == len(one.levels)
    for a, b in zip(one.levels, other.levels):
        assert a.vertices.tobytes() == b.vertices.tobytes()
        assert np.array_equal(a.faces, b.faces) and b.faces.dtype == np.int64
        assert (a.distance is None) == (b.distance is None)
        assert a.distance is None or np.array_equal(a.distance, b.distance)
        assert not b.vertices.flags.writeable and not b.faces.flags.writeable
    (folder / "a").mkdir(), (folder / "b").mkdir()
    for name in ("m.glb", "m.stl", "m.vtm", "m.ply", "m.html"):
        for place, mesh in (("a", one), ("b", other)):
            report = None if "schema" not in one.report else folder / place / (name + ".json")
            mesh.save(folder / place / name, report=report)
        assert (folder / "a" / name).read_bytes() == (folder / "b" / name).read_bytes()
        if report is not None:
            texts = [(folder / place / (name + ".json")).read_text() for place in "ab"]
            a, b = (json.loads(text.replace("/b/", "/a/")) for text in texts)
            for it in (a, b):
                del it["seconds"]["write"], it["peak_memory_bytes"]
            assert a == b


@pytest.mark.filterwarnings("ignore:.*mirror image")
@pytest.mark.parametrize("name", MESHES)
def test_pickled_meshes_are_the_same(name, tmp_path):
    mesh = MESHES[name]
    data = pickle.dumps(mesh)
    assert_same(mesh, pickle.loads(data), tmp_path)
    assert pickle.dumps(pickle.loads(data)) == data == pickle.dumps(mesh)


def test_the_examples_use_all_kinds_of_facts():
    """What is empty everywhere would not be tested above."""
    report = MESHES["options"].report
    level = report["levels"][-1]
    assert MESHES["options"].unmet and report["kept"] and report["dropped"]
    assert level["measured"] and level["bad_triangles"]["count"] and level["at_limit"]["count"]
    assert report["input"]["sha256"] and report["input"]["path"] and report["subdivision"]


@pytest.mark.filterwarnings("ignore:.*mirror image")
def test_copies(tmp_path):
    mesh = MESHES["default"]
    assert_same(mesh, copy.deepcopy(mesh), tmp_path)
    shallow = copy.copy(mesh)
    assert np.shares_memory(shallow.vertices, mesh.vertices)
    deep = copy.deepcopy(mesh)
    assert not np.shares_memory(deep.vertices, mesh.vertices)
    deep.report["levels"].clear()
    assert len(mesh.report["levels"]) == 2


def test_levels_and_components():
    mesh = MESHES["default"]
    level = pickle.loads(pickle.dumps(mesh.levels[0]))
    assert level.number == 0 and np.array_equal(level.vertices, mesh.levels[0].vertices)
    component = pickle.loads(pickle.dumps(mesh.components[0]))
    assert component.genus == 1 and np.array_equal(component.bounds, mesh.bounds)


@pytest.mark.filterwarnings("ignore:.*mirror image")
def test_meshes_of_files(tmp_path):
    (tmp_path / "saved").mkdir()
    for name in ("m.glb", "m.ply"):
        MESHES["default"].save(tmp_path / "saved" / name)
        mesh = isoatlas.read_mesh(tmp_path / "saved" / name)
        (tmp_path / name).mkdir()
        assert_same(mesh, pickle.loads(pickle.dumps(mesh)), tmp_path / name)


def test_volumes():
    volume = isoatlas.read_volume(SAMPLES / "protein_iron.nhdr")
    for other in (pickle.loads(pickle.dumps(volume)), copy.deepcopy(volume)):
        assert np.array_equal(other.array, volume.array)
        assert type(other.spacing) is isoatlas.XYZ and other.spacing == volume.spacing
        assert other.source.format == "NRRD" and other.source.decisions == volume.source.decisions
        a, b = (isoatlas.extract(it, 100, coarse=True) for it in (volume, other))
        assert a.vertices.tobytes() == b.vertices.tobytes()
        for report in (a.report, b.report):
            for key in ("seconds", "peak_memory_bytes"):
                del report[key]
            del report["levels"][0]["seconds"]
        assert a.report == b.report


def mesh_of(radius):
    """In another process."""
    z, y, x = np.indices((16, 16, 16)) - 7.6
    return isoatlas.extract(radius - np.sqrt(x**2 + y**2 + z**2), 0.0, order="xyz", threads=1)


def test_results_of_other_processes():
    """As joblib does it: arguments and results are pickled."""
    context = multiprocessing.get_context("spawn")
    radii = [3.1, 4.2, 5.3]
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        results = list(pool.map(mesh_of, radii))
    for radius, mesh in zip(radii, results):
        assert mesh.vertices.tobytes() == mesh_of(radius).vertices.tobytes()


def test_forked_processes_extract():
    """A process that was forked after an extraction has no threads of oneTBB."""
    assert mesh_of(5.3).closed
    context = multiprocessing.get_context("fork")
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=context) as pool:
        mesh = pool.submit(mesh_of, 4.2).result(timeout=120)
    assert mesh.vertices.tobytes() == mesh_of(4.2).vertices.tobytes()


@pytest.mark.parametrize("damage", ["shorter", "longer", "version", "corner"])
def test_damaged_data_are_refused(damage):
    core = MESHES["default"]._core
    data = core.__getstate__()
    version = isoatlas.__version__.encode()
    if damage == "corner":  # of the first triangle, which is in memory behind the positions
        triangle = core.faces(0)[0].tobytes()
        data = data.replace(triangle, b"\xff" * len(triangle), 1)
    data = {
        "shorter": data[:-1],
        "longer": data + b"\0",
        "version": data.replace(version, b"9.9.9", 1),
        "corner": data,
    }[damage]
    new = type(core).__new__(type(core))
    text = "another version" if damage == "version" else "incomplete or damaged"
    with pytest.raises(isoatlas.BadArgumentError, match=text):
        new.__setstate__(data)
