# SPDX-License-Identifier: Apache-2.0
"""The volumes in the package."""

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES
from isoatlas import examples


@pytest.mark.parametrize(
    ("name", "iso", "file"),
    [("load_protein", 100, "protein_iron.nhdr"), ("load_embryo", 90.5, "embryo.nrrd")],
)
def test_volumes_are_the_samples(name, iso, file):
    volume = getattr(examples, name)()
    assert np.array_equal(volume.array, isoatlas.read_volume(SAMPLES / file).array)
    size = " x ".join(map(str, volume.array.shape[::-1]))
    docstring = getattr(examples, name).__doc__
    assert size in docstring and f"the isovalue {iso}" in docstring.replace("\n    ", " ")


def test_docstring_of_the_protein():
    mesh = isoatlas.extract(examples.load_protein(), 100)
    assert len(mesh.components) == 35 and round(len(mesh.faces), -3) == 3000


def test_folder_has_the_licence():
    names = sorted(path.name for path in examples.folder().iterdir())
    assert names == [
        "LICENSE-samples.txt",
        "embryo.nrrd",
        "protein_iron.nhdr",
        "protein_iron.raw",
    ]
    for name in names:
        assert (examples.folder() / name).read_bytes() == (SAMPLES / name).read_bytes()
