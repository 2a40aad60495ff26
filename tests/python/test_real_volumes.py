# SPDX-License-Identifier: Apache-2.0
"""The volumes of ../shared/data: the known topology, that of the command line, in both orders of memory; and the same bytes. Skipped without them."""
import csv
import json

import numpy as np
import pytest

import isoatlas
from conftest import DATA, topology

FAST = {"coarse": True, "allow_self_intersections": True}
COLUMNS = {"components": "components", "euler_characteristic": "euler", "genus": "genus", "boundary_loops": "boundary_loops"}


def rows():
    path = DATA / "TOPOLOGY.tsv"
    if not path.is_file():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def files():
    """Each volume once, at the first of its isovalues."""
    return list({row["file"]: row for row in reversed(rows())}.values())


def test_all_volumes_are_there(data):
    assert len(files()) >= 15


@pytest.mark.parametrize("row", files(), ids=lambda row: row["file"])
def test_same_topology_and_bytes_as_the_command_line(row, data, tool, tmp_path):
    iso = row["isovalue"]
    tool("extract", data / row["file"], "--iso", iso, "--coarse", "--allow-self-intersections", "-q", "-o", tmp_path / "tool.ply", "--report",
         tmp_path / "tool.json")  # fmt: skip
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
    run = tool("extract", path, "--iso", "1.5", "--coarse", "-q", "-o", tmp_path / "m.ply", status=2)
    with pytest.raises(isoatlas.UnsupportedError) as raised:
        isoatlas.extract(isoatlas.read_volume(path), 1.5)
    said = run.stderr.strip().removeprefix("isoatlas: error: ").replace("--nan below or --nan above", "nan='below' or nan='above'")
    assert str(raised.value) == said
    tool("extract", path, "--iso", "1.5", "--nan", "below", "--coarse", "-q", "-o", tmp_path / "m.ply")
    isoatlas.extract(isoatlas.read_volume(path), 1.5, nan="below", coarse=True).save(tmp_path / "n.ply")
    assert (tmp_path / "n.ply").read_bytes() == (tmp_path / "m.ply").read_bytes()
