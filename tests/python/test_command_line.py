# SPDX-License-Identifier: Apache-2.0
"""Files are the same as those of the command line, byte for byte."""

import copy
import inspect
import json

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES, topology

PROTEIN = SAMPLES / "protein_iron.nhdr"

CASES = {
    "default": ([], {}),
    "coarse": (["--coarse"], {"coarse": True}),
    "voxel": (["--space", "voxel", "--coarse"], {"space": "voxel", "coarse": True}),
    "ras": (["--space", "ras", "--inside", "below"], {"space": "ras", "inside": "below"}),
    "levels": (
        "--max-vertices 900 --refine max-distance:2vx "
        "--refine max-distance:1.2vx,max-edge:30".split(),
        {
            "max_vertices": 900,
            "refine": ["max-distance:2vx", {"max_distance": "1.2vx", "max_edge": 30}],
        },
    ),
    "balanced": (
        "--placement balanced --interpolation tricubic "
        "--max-distance 1.25 --topology faces".split(),
        {
            "placement": "balanced",
            "interpolation": "tricubic",
            "max_distance": 1.25,
            "topology": "faces",
        },
    ),
    "intersections": (
        "--allow-self-intersections --min-component-size 20vx --max-radius 9.5".split(),
        {"allow_self_intersections": True, "min_component_size": "20vx", "max_radius": 9.5},
    ),
}


def files_in(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.mark.parametrize("case", CASES)
def test_same_bytes(case, tool, tmp_path):
    arguments, options = CASES[case]
    ours, theirs = tmp_path / "python", tmp_path / "tool"
    ours.mkdir()
    theirs.mkdir()
    mesh = isoatlas.extract(isoatlas.read(PROTEIN), 100, **options)
    command = ["extract", PROTEIN, "--iso", "100", *arguments, "-q"]
    names = {"levels": ["m.ply", "m.vtm"], "balanced": ["m.stl", "m-{level}.obj"]}
    for name in names.get(case, ["m.ply"]):
        mesh.save(ours / name)
        tool(*command, "-o", theirs / name, status=1 if mesh.unmet else 0)
    mesh.save(ours / "m.glb", glb_per_level=True)
    tool(*command, "-o", theirs / "m.glb", "--glb-per-level", status=None)
    found = files_in(ours)
    assert found == files_in(theirs)
    assert len(found) >= 4


def test_plain_array_is_the_same_as_the_volume(tool, tmp_path):
    samples = np.fromfile(SAMPLES / "protein_iron.raw", np.uint8).reshape(68, 68, 68)
    isoatlas.extract(samples, 100, order="xyz", spacing=(1, 1, 1)).save(tmp_path / "python.off")
    tool("extract", PROTEIN, "--iso", "100", "-q", "-o", tmp_path / "tool.off")
    assert (tmp_path / "python.off").read_bytes() == (tmp_path / "tool.off").read_bytes()


def test_anisotropic_mirrored_geometry(tool, tmp_path):
    rng = np.random.default_rng(2)
    samples = (rng.random((5, 6, 7)) * 100).astype(np.int16)
    samples.tofile(tmp_path / "v.raw")
    header = """NRRD0004
type: int16
dimension: 3
space: left-posterior-superior
sizes: 7 6 5
space directions: (0,0.75,0) (0.5,0,0) (0,0,2.5)
kinds: domain domain domain
endian: little
encoding: raw
space origin: (1.5,-20.25,300)
data file: v.raw
"""
    (tmp_path / "v.nhdr").write_text(header)
    volume = isoatlas.read_volume(tmp_path / "v.nhdr")
    assert volume.spacing == (0.75, 0.5, 2.5) and volume.origin == (1.5, -20.25, 300.0)
    assert np.linalg.det(np.array(volume.direction)) < 0
    tool("extract", tmp_path / "v.nhdr", "--iso", "50.5", "-q", "-o", tmp_path / "tool.ply")
    isoatlas.extract(volume, 50.5).save(tmp_path / "volume.ply")
    isoatlas.extract(
        samples,
        50.5,
        order="xyz",
        spacing=(0.75, 0.5, 2.5),
        origin=(1.5, -20.25, 300),
        direction=[[0, 1, 0], [1, 0, 0], [0, 0, 1]],
    ).save(tmp_path / "array.ply")
    expected = (tmp_path / "tool.ply").read_bytes()
    assert (tmp_path / "volume.ply").read_bytes() == expected
    assert (tmp_path / "array.ply").read_bytes() == expected


def without_times(report):
    for key in ("seconds", "peak_memory_bytes", "command"):
        del report[key]
    for level in report["levels"]:
        del level["seconds"], level["path"]
    for file in report["files"]:
        del file["path"]
    return report


def with_names_of_arguments(report):
    """The JSON of the command line with the names in Python."""
    parameters = report["parameters"]
    for name, key in (("iso", "isovalue"), ("inside", "inside"), ("topology", "topology")):
        parameters[name] = report["surface"][key]
    assert parameters.pop("non_finite") == "refuse"
    parameters["nan"] = None
    text = json.dumps(report)
    for name in inspect.signature(isoatlas.extract).parameters:
        text = text.replace(f'"{name.replace("_", "-")}"', f'"{name}"')
    return json.loads(text)


def test_report_has_the_same_content(tool, tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    mesh = isoatlas.extract(isoatlas.read(PROTEIN), 100, measure_samples=5000, threads=2)
    mesh.save(tmp_path / "a/m.ply", report=tmp_path / "a/m.json")
    options = "--iso 100 --measure-samples 5000 --threads 2 -q".split()
    outputs = ["-o", tmp_path / "b/m.ply", "--report", tmp_path / "b/m.json"]
    tool("extract", PROTEIN, *options, *outputs)
    saved = json.loads((tmp_path / "a/m.json").read_text())
    theirs = json.loads((tmp_path / "b/m.json").read_text())
    assert saved["files"][0]["path"] == str(tmp_path / "a/m.ply")
    assert saved["seconds"].keys() == theirs["seconds"].keys()
    assert list(saved) == list(theirs) == list(mesh.report)  # in the same order
    assert without_times(saved) == without_times(theirs)
    mine = without_times(copy.deepcopy(mesh.report))
    assert mine.pop("files") == []
    del theirs["files"]
    assert mine == with_names_of_arguments(theirs)


def test_orders_of_memory_have_the_topology_of_the_command_line(tool, tmp_path):
    outputs = ["-o", tmp_path / "m.ply", "--report", tmp_path / "m.json"]
    tool("extract", PROTEIN, "--iso", "100", "--coarse", "-q", *outputs)
    theirs = json.loads((tmp_path / "m.json").read_text())["levels"][0]
    for order in "CF":
        array = np.array(isoatlas.read_volume(PROTEIN).array, order=order)
        mesh = isoatlas.extract(array, 100, coarse=True)
        assert topology(mesh.levels[0].report) == topology(theirs)
