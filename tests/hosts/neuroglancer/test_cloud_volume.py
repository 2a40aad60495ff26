# SPDX-License-Identifier: Apache-2.0
"""Meshes for Neuroglancer, read by cloud-volume, a library by others."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest
from cloudvolume import CloudVolume

TOOL = os.environ["ISOATLAS_TOOL"]
SAMPLES = pathlib.Path(__file__).parents[3] / "samples"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A volume of cloud-volume with the mesh of the tool, and the report about it."""
    folder = tmp_path_factory.mktemp("volume")
    subprocess.run(
        [TOOL, "extract", SAMPLES / "protein_iron.nhdr", "--iso", "100", "--refine",
         "max-distance:2vx", "--refine", "max-distance:0.5vx", "-o", folder / "mesh.vtm",
         "--neuroglancer", folder / "mesh", "--report", folder / "report.json", "-q"],
        check=True,
    )
    info = CloudVolume.create_new_info(
        num_channels=1, layer_type="segmentation", data_type="uint8", encoding="raw",
        resolution=[1, 1, 1], voxel_offset=[0, 0, 0], chunk_size=[64, 64, 64],
        volume_size=[64, 64, 64], mesh="mesh",
    )
    CloudVolume(folder.as_uri(), info=info).commit_info()
    return folder


def euler_characteristic(mesh):
    points, number = np.unique(np.round(mesh.vertices, 5), axis=0, return_inverse=True)
    faces = number.reshape(-1)[mesh.faces]
    assert (np.sort(faces, axis=1)[:, :-1] != np.sort(faces, axis=1)[:, 1:]).all()
    edges = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    assert set(count) <= {1, 2}  # a manifold, across fragments too
    return len(points) - len(edges) + len(faces)


def test_levels_have_their_topology(folder):
    levels = json.loads((folder / "report.json").read_text())["levels"]
    volume = CloudVolume(folder.as_uri())
    for lod, level in enumerate(reversed(levels)):
        mesh = volume.mesh.get(1, lod=lod)[1]
        assert euler_characteristic(mesh) == level["euler_characteristic"]
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        expected = level["extent"]["low"], level["extent"]["high"]
        assert np.allclose([low, high], expected, atol=0.02)


def test_a_second_run_replaces_the_mesh(folder):
    before = (folder / "mesh" / "1.index").read_bytes()
    done = subprocess.run(
        [TOOL, "extract", SAMPLES / "protein_iron.nhdr", "--iso", "128", "--coarse", "-q", "-o",
         folder / "other.ply", "--neuroglancer", folder / "mesh"],
        capture_output=True, text=True,
    )
    assert done.returncode == 0, done.stderr
    assert (folder / "mesh" / "1.index").read_bytes() != before
    assert CloudVolume(folder.as_uri()).mesh.get(1, lod=0)[1].faces.size > 0


def test_the_folder_of_a_volume_is_not_overwritten(folder):
    info = (folder / "info").read_bytes()
    done = subprocess.run(
        [TOOL, "extract", SAMPLES / "protein_iron.nhdr", "--iso", "100", "--coarse", "-q", "-o",
         folder / "other.ply", "--neuroglancer", folder],
        capture_output=True, text=True,
    )
    assert done.returncode == 2
    assert "describes something else" in done.stderr and done.stderr.count("\n") == 1
    assert (folder / "info").read_bytes() == info and not (folder / "1").exists()
