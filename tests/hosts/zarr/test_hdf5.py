# SPDX-License-Identifier: Apache-2.0
"""HDF5 files that h5py wrote, read by the tool."""

import h5py
import numpy as np
import pytest

from tool import ISO, SAMPLES, expect_samples, info, run


@pytest.mark.parametrize("kind", "<u1 <i1 <u2 >i2 <u4 >i4 <u8 <i8 <f4 >f8 <f2 bool".split())
def test_types(kind, tmp_path):
    samples = (SAMPLES // 16).astype(kind)
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a"] = samples
    wanted = {"<f2": "<f4", "bool": "u1"}.get(kind, kind.replace(">", "<"))
    expect_samples(tmp_path / "a.h5", samples.astype(wanted))


@pytest.mark.parametrize("options", [
    {"chunks": (9, 10, 11)}, {"compression": "gzip"}, {"compression": "gzip", "shuffle": True},
    {"compression": "gzip", "fletcher32": True}, {"scaleoffset": 0}
])
def test_layouts(options, tmp_path):
    with h5py.File(tmp_path / "a", "w") as file:  # found by its content
        file.create_dataset("a", data=SAMPLES, **options)
    expect_samples(tmp_path / "a", SAMPLES)
    expect_samples(tmp_path / "a", SAMPLES[5:30, 9:48, 7:31], "--roi", "7:30,9:47,5:29")


@pytest.fixture
def several(tmp_path):
    path = tmp_path / "several.h5"
    with h5py.File(path, "w") as file:
        data = file.create_dataset("images/raw", data=SAMPLES, chunks=(16, 16, 16))
        data.attrs["element_size_um"] = [2.0, 0.5, 0.25]
        file["images/labels"] = (SAMPLES > 300).astype("u1")[None, ..., None]
        file["table"] = np.zeros((9, 9))
        file["names"] = np.array([b"a", b"b"])
        file["loop"] = h5py.SoftLink("/")
        file["nowhere"] = h5py.SoftLink("/nothing")
        file["elsewhere"] = h5py.ExternalLink("/etc/passwd", "/a")
    return path


def test_a_dataset_is_chosen(several):
    choices = info(several)["choices"]
    assert choices == [{"name": "array", "entries": ["/images/labels", "/images/raw"],
                        "selected": None}]
    expect_samples(several, SAMPLES, "--array", "/images/raw")
    facts = info(several, "--array", 1)
    assert facts["spacing"] == [0.25, 0.5, 2.0] and facts["unit"] == "um"
    expect_samples(several, (SAMPLES > 300).astype("u1"), "--array", "/images/labels")
    assert "/images/raw" in run("extract", several, *ISO, "-o", "a.ply", status=2)


def test_blocks_give_the_bytes_of_the_whole_file(several, tmp_path):
    options = [*ISO, "--array", "/images/raw", "--block-size", "18", "-q"]
    run("extract", several, *options, "-o", tmp_path / "a.ply")
    np.save(tmp_path / "a.npy", SAMPLES)
    run("extract", tmp_path / "a.npy", *ISO, "--spacing", "0.25,0.5,2um", "--block-size", "18",
        "-q", "-o", tmp_path / "b.ply")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()


def test_a_damaged_chunk_is_named(tmp_path):
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        data = file.create_dataset("a", data=SAMPLES, chunks=(9, 10, 11), compression="gzip",
                                   fletcher32=True)
        place = data.id.get_chunk_info_by_coord((18, 20, 22))
    with open(path, "r+b") as file:
        file.seek(place.byte_offset + 20)
        file.write(b"damaged")
    assert "chunk (2, 2, 2): " in run("info", path, status=2)
    run("info", path, "--roi", "0:21,0:9,0:7")
    path.write_bytes(path.read_bytes()[:2000])
    text = run("info", path, status=2)
    assert "cannot be opened: " in text and text.count("\n") == 1


def test_a_filter_that_is_not_installed(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.create_dataset("a", data=SAMPLES, compression="lzf")
    assert "required filter 'lzf' is not registered" in run("info", tmp_path / "a.h5", status=2)


def test_files_without_a_volume(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["a"] = np.zeros((3, 3))
    assert "has no dataset of numbers with three axes" in run("info", tmp_path / "a.h5", status=2)
    with h5py.File(tmp_path / "b.h5", "w") as file:
        file["a"] = np.zeros((2, 3, 4, 5))
    assert "has 4 axes with several entries" in run("info", tmp_path / "b.h5", status=2)
