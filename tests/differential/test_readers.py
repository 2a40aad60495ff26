# SPDX-License-Identifier: Apache-2.0
"""Reads every available volume with isoatlas and with an independent program.

Size, world position and samples must be the same.
"""

import os
import pathlib
import warnings

import numpy as np
import pytest

import independent
import isoatlas
import variants

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIELD = ROOT / "tests" / "data" / "field"
DATA = pathlib.Path(os.environ.get("ISOATLAS_TEST_DATA") or ROOT.parent / "shared" / "data")

# Files that need a choice, and files that isoatlas refuses; their own tests check it
# (docs/reference/formats.md).
CHOICES = {
    "t_ij_2ch.tif": [{"channel": 0}, {"channel": 1}],
    "n_4d2.nii": [{"time": 0}, {"time": 1}],
    "r_seg2.seg.nrrd": [{"layer": 0}, {"layer": 1}],
    "v_two_none.vti": [{"array": "a"}, {"array": "b"}],
}
REFUSED = {"dup_newuid", "endtrunc0", "nogeom", "enh_two_vols", "ipp_only_nosp", "one.dcm"}
# The independent reader is wrong about these files; they have their own tests.
OWN_TEST = {"t_ij_trunc.tif", "r_det_longer.nhdr"}
PARTS = ("r_sl", "r_det.raw", "README.md", "v_par_0.vti", "v_par_1.vti")
VOLUMES = (
    ".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".tif", ".tiff", ".vtk", ".vti", ".vtr",
    ".pvti", ".npy", ".mrc", ".mgz",
)


def cases():
    for path in sorted(FIELD.iterdir()) + sorted((FIELD / "dcm").iterdir()):
        if path.name.startswith(PARTS) or path.name in REFUSED | OWN_TEST or path.name == "dcm":
            continue
        for choice in CHOICES.get(path.name, [{}]):
            yield path, choice
    for folder in (ROOT / "samples", DATA, DATA / "labels"):
        for path in sorted(folder.iterdir()) if folder.is_dir() else []:
            if path.name.lower().endswith(VOLUMES):
                yield path, {}


def name_of(case):
    path, choice = case
    return path.name + "".join(f"-{k}{v}" for k, v in choice.items())


def expect_same(path, **choice):
    expected, affine = independent.read(path, **choice)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", isoatlas.FileWarning)
        volume = isoatlas.read_volume(path, **choice)
    found = volume.array.transpose(2, 1, 0)
    assert found.shape == expected.shape
    placed = np.eye(4)
    placed[:3, :3] = np.array(volume.direction) * np.array(volume.spacing)
    placed[:3, 3] = volume.origin
    scale = np.abs(affine[:3, :3]).max()
    np.testing.assert_allclose(placed, affine, rtol=1e-5, atol=1e-5 * scale)
    if np.issubdtype(found.dtype, np.integer):
        assert np.array_equal(found, expected)
    else:  # isoatlas rescales in float32, the other program in float64
        largest = np.nanmax(np.abs(expected[np.isfinite(expected)]))
        np.testing.assert_allclose(
            found, expected.astype(np.float64), rtol=3e-7, atol=1e-6 * largest
        )


@pytest.mark.parametrize("case", list(cases()), ids=name_of)
def test_reads_what_an_independent_program_reads(case):
    path, choice = case
    expect_same(path, **choice)


@pytest.mark.parametrize("writer", variants.WRITERS, ids=lambda writer: writer.__name__)
def test_reads_what_an_independent_program_writes(writer, tmp_path):
    paths = list(writer(tmp_path))
    assert len(paths) >= 4
    for path in paths:
        try:
            expect_same(path)
        except Exception as error:
            raise AssertionError(f"{path.name}: {error}") from error


@pytest.mark.skipif(
    not DATA.is_dir(), reason=f"no {DATA}; set ISOATLAS_TEST_DATA to the folder of volumes"
)
def test_the_real_volumes_are_among_them():
    assert len([1 for path, _ in cases() if path.parent == DATA]) >= 16
