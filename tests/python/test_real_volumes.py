# SPDX-License-Identifier: Apache-2.0
"""Volumes of ../shared/data: known topology in both orders of memory, and the command line's bytes.

Skipped if the volumes are missing.
"""

import csv
import json

import numpy as np
import pytest

import isoatlas
from conftest import DATA, topology

FAST = {"coarse": True, "allow_self_intersections": True}
COLUMNS = {
    "components": "components",
    "euler_characteristic": "euler",
    "genus": "genus",
    "boundary_loops": "boundary_loops",
}


def rows():
    path = DATA / "TOPOLOGY.tsv"
    if not path.is_file():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def files():
    """The first row of each volume."""
    return list({row["file"]: row for row in reversed(rows())}.values())


def test_all_volumes_exist(data):
    assert len(files()) >= 15


@pytest.mark.parametrize("row", files(), ids=lambda row: row["file"])
def test_same_topology_and_bytes_as_the_command_line(row, data, tool, tmp_path):
    iso = row["isovalue"]
    options = ["--iso", iso, "--coarse", "--allow-self-intersections", "-q"]
    outputs = ["-o", tmp_path / "tool.ply", "--report", tmp_path / "tool.json"]
    tool("extract", data / row["file"], *options, *outputs)
    theirs = json.loads((tmp_path / "tool.json").read_text())["levels"][0]
    volume = isoatlas.read_volume(data / row["file"])
    mesh = isoatlas.extract(volume, float(iso), **FAST)
    ours = mesh.levels[0].report
    assert topology(ours) == topology(theirs)
    for key, column in COLUMNS.items():
        assert ours[key] == int(row[f"trilinear_{column}"]), key
    mesh.save(tmp_path / "python.ply")
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "tool.ply").read_bytes()


@pytest.mark.parametrize("row", files(), ids=lambda row: row["file"])
def test_fortran_order_has_the_same_topology(row, data):
    array = np.asfortranarray(isoatlas.read_volume(data / row["file"]).array)
    ours = isoatlas.extract(array, float(row["isovalue"]), **FAST).levels[0].report
    for key, column in COLUMNS.items():
        assert ours[key] == int(row[f"trilinear_{column}"]), key


def test_nan_volume(data, tool, tmp_path):
    path = data / "tmap_nan.nii.gz"
    command = ["extract", path, "--iso", "1.5", "--coarse", "-q", "-o", tmp_path / "m.ply"]
    run = tool(*command, status=2)
    with pytest.raises(isoatlas.UnsupportedError) as raised:
        isoatlas.extract(isoatlas.read_volume(path), 1.5)
    # The problem is stated in the same words; the advice names the option or the argument.
    problem = run.stderr.removeprefix("isoatlas: error: ").partition("first at index")[0]
    assert "NaN" in problem and str(raised.value).startswith(problem)
    assert "nan='below' or nan='above'" in str(raised.value)
    tool(*command, "--nan", "below")
    isoatlas.extract(isoatlas.read_volume(path), 1.5, nan="below", coarse=True).save(
        tmp_path / "n.ply"
    )
    assert (tmp_path / "n.ply").read_bytes() == (tmp_path / "m.ply").read_bytes()
