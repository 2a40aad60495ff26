# SPDX-License-Identifier: Apache-2.0
"""Closed meshes in the programs that print them: admesh and PrusaSlicer's console.

Both repair what they read and count the repairs: there must be none. Sizes are in millimetres for
volumes in any unit.
"""

import os
import pathlib
import re
import shutil
import subprocess

import numpy as np
import pytest

import isoatlas

ROOT = pathlib.Path(__file__).resolve().parents[3]
DATA = pathlib.Path(os.environ.get("ISOATLAS_TEST_DATA") or ROOT.parent / "shared" / "data")
ADMESH, SLICER = shutil.which("admesh"), shutil.which("prusa-slicer")
needs_admesh = pytest.mark.skipif(not ADMESH, reason="admesh is not installed")
needs_slicer = pytest.mark.skipif(not SLICER, reason="prusa-slicer is not installed")
# Millimetres in one unit of the volume. Programs read a file without a unit as millimetres.
UNITS = {"mm": 1, "cm": 10, "um": 0.001, "": 1}
REPAIRS = (
    "Total disconnected facets", "Degenerate facets", "Edges fixed", "Facets removed",
    "Facets added", "Facets reversed", "Backwards edges",
)


def admesh_facts(path):
    """The numbers that admesh prints about an .stl, before its repairs."""
    done = subprocess.run([ADMESH, path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {
        label.strip(): float(value)
        for label, value in re.findall(r"([A-Z][\w ]*?)\s*[:=]\s*(-?\d[\d.]*)", done.stdout)
    }


def check_with_admesh(path, mesh, unit):
    facts = admesh_facts(path)
    assert {label: facts[label] for label in REPAIRS} == dict.fromkeys(REPAIRS, 0)
    assert facts["Number of facets"] == len(mesh.faces)
    assert facts["Number of parts"] == mesh.report["levels"][-1]["components"]
    assert facts["Volume"] == pytest.approx(mesh.volume * UNITS[unit] ** 3, rel=1e-3)
    bounds = [[facts[f"{side} {axis}"] for axis in "XYZ"] for side in ("Min", "Max")]
    assert np.allclose(bounds, mesh.bounds * UNITS[unit], atol=1e-5 * np.abs(mesh.bounds).max())


def slicer_facts(path):
    """What PrusaSlicer's console states about a model, in millimetres."""
    done = subprocess.run([SLICER, "--info", path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return dict(re.findall(r"(?m)^(\w+) = (.*)$", done.stdout))


def check_with_slicer(path, mesh, unit):
    facts = slicer_facts(path)
    assert facts["manifold"] == "yes"
    assert "open_edges" not in facts and "facets_reversed" not in facts
    assert int(facts["number_of_facets"]) == len(mesh.faces)
    assert int(facts["number_of_parts"]) == mesh.report["levels"][-1]["components"]
    assert float(facts["volume"]) == pytest.approx(mesh.volume * UNITS[unit] ** 3, rel=1e-3)
    size = [float(facts[f"size_{axis}"]) for axis in "xyz"]
    assert np.allclose(size, np.diff(mesh.bounds, axis=0)[0] * UNITS[unit], rtol=1e-4)


def protein(unit):
    """A volume whose boundary cuts the surface, of one size in every unit."""
    spacing = 0.5 / UNITS[unit]
    volume = isoatlas.read(
        ROOT / "samples/protein_iron.nhdr", spacing=f"{spacing},{spacing},{spacing}{unit}"
    )
    return volume.replace(array=volume.array[:, :, :34], origin=volume.origin)


def closed(volume, iso, **options):
    mesh = isoatlas.extract(volume, iso, border="closed", **options)
    report = mesh.report["levels"][-1]
    assert report["caps"]["triangles"] > 0 and report["boundary_loops"] == 0
    assert mesh.volume > 0
    return mesh


@needs_admesh
@pytest.mark.parametrize("unit", UNITS)
def test_stl_is_in_millimetres(tmp_path, unit):
    mesh = closed(protein(unit), 100.5)
    mesh.save(tmp_path / "protein.stl")
    check_with_admesh(tmp_path / "protein.stl", mesh, unit)


@needs_slicer
@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("extension", ["3mf", "stl"])
def test_slicer_reads_millimetres(tmp_path, unit, extension):
    mesh = closed(protein(unit), 100.5)
    mesh.save(tmp_path / f"protein.{extension}")
    check_with_slicer(tmp_path / f"protein.{extension}", mesh, unit)


@needs_slicer
def test_slicer_prints_it(tmp_path):
    """Half a ball of radius 12 mm stands on its cap: layers of 0.3 mm, nothing to repair."""
    z, y, x = np.indices((14, 30, 30), dtype=np.float32)
    field = 12 - np.sqrt((x - 14.4) ** 2 + (y - 14.6) ** 2 + z**2)
    closed(isoatlas.Volume(field, unit="mm"), 0.0).save(tmp_path / "half.3mf")
    done = subprocess.run(
        [SLICER, "--export-gcode", "--center", "100,100", "--layer-height", "0.3",
         "--output", tmp_path / "half.gcode", tmp_path / "half.3mf"],
        capture_output=True, text=True,
    )
    assert done.returncode == 0, done.stderr
    layers = (tmp_path / "half.gcode").read_text().count(";LAYER_CHANGE")
    assert layers == pytest.approx(12 / 0.3, abs=3)
    assert "repair" not in (done.stdout + done.stderr).lower()


def with_a_reversed_triangle(path):
    head, body = path.read_bytes()[:84], path.read_bytes()[84:]
    records = np.frombuffer(body, np.uint8).reshape(-1, 50).copy()
    records[7, 12:36] = np.roll(records[7, 12:36], 12)  # exchanges the first two corners
    path.write_bytes(head + records.tobytes())


@pytest.fixture
def faulty(tmp_path):
    """An open mesh, and a closed one with one triangle that faces inwards."""
    paths = tmp_path / "open.stl", tmp_path / "reversed.stl"
    isoatlas.extract(protein("mm"), 100.5).save(paths[0])
    closed(protein("mm"), 100.5).save(paths[1])
    with_a_reversed_triangle(paths[1])
    return paths


@needs_admesh
def test_admesh_finds_faults(faulty):
    assert admesh_facts(faulty[0])["Total disconnected facets"] > 0
    assert admesh_facts(faulty[1])["Facets reversed"] == 1


@needs_slicer
def test_slicer_finds_faults(faulty):
    facts = slicer_facts(faulty[0])
    assert facts["manifold"] == "no" and int(facts["open_edges"]) > 100
    assert slicer_facts(faulty[1])["facets_reversed"] == "1"


@pytest.mark.parametrize(
    ("file", "iso"), [("ct_chest.mha", 120.5), ("ct_engine.nrrd", 128), ("embryo.nrrd", 90.5)]
)
def test_real_volumes(tmp_path, file, iso):
    path = ROOT / "samples" / file
    path = path if path.is_file() else DATA / file
    if not path.is_file():
        pytest.skip(f"no {path}; set ISOATLAS_TEST_DATA to the folder of volumes")
    if not ADMESH and not SLICER:
        pytest.skip("neither admesh nor prusa-slicer is installed")
    volume = isoatlas.read(path)
    mesh = closed(volume, iso, max_distance="1vx")
    for extension in ("stl", "3mf"):
        mesh.save(tmp_path / f"mesh.{extension}")
    unit = volume.unit or ""
    if ADMESH:
        check_with_admesh(tmp_path / "mesh.stl", mesh, unit)
    if SLICER:
        check_with_slicer(tmp_path / "mesh.3mf", mesh, unit)
