# SPDX-License-Identifier: Apache-2.0
"""Zarr folders that zarr-python and ome-zarr-py wrote, read by the tool."""

import json
import shutil

import numcodecs
import numpy as np
import pytest
import zarr
from ome_zarr.format import FormatV04, FormatV05
from ome_zarr.writer import write_image, write_labels

from tool import ISO, SAMPLES, digest, expect_samples, info, run

COMPRESSORS = {
    "none": None, "lz4hc": numcodecs.Blosc("lz4hc"), "blosclz": numcodecs.Blosc("blosclz"),
    "bits": numcodecs.Blosc("zstd", shuffle=numcodecs.Blosc.BITSHUFFLE),
    "blosc-zlib": numcodecs.Blosc("zlib"), "zstd": numcodecs.Zstd(), "gzip": numcodecs.GZip(),
    "zlib": numcodecs.Zlib(), "bz2": numcodecs.BZ2(), "lz4": numcodecs.LZ4()
}


@pytest.mark.parametrize("order", "CF")
@pytest.mark.parametrize("name", COMPRESSORS)
def test_compressors_of_version_2(name, order, tmp_path):
    kind = ">i4" if order == "F" else "<u2"
    array = zarr.create_array(tmp_path / "a", shape=SAMPLES.shape, chunks=(16, 17, 18), dtype=kind,
                              zarr_format=2, compressors=COMPRESSORS[name], order=order)
    array[:] = SAMPLES
    expect_samples(tmp_path / "a", SAMPLES.astype("<" + kind[1:]))


VERSION_3 = {
    "plain": {"compressors": None},
    "zstd": {"compressors": zarr.codecs.ZstdCodec(checksum=True)},
    "blosc": {"compressors": zarr.codecs.BloscCodec(cname="lz4")},
    "checksum": {"compressors": [zarr.codecs.GzipCodec(), zarr.codecs.Crc32cCodec()]},
    "compressed checksum": {"compressors": [zarr.codecs.Crc32cCodec(), zarr.codecs.GzipCodec()]},
    "transposed": {"filters": [zarr.codecs.TransposeCodec(order=(2, 0, 1))]},
    "big endian": {"serializer": zarr.codecs.BytesCodec(endian="big")},
    "dots": {"chunk_key_encoding": {"name": "v2", "separator": "."}},
    "sharded": {"shards": (32, 40, 36)},
    "sharded, transposed": {
        "shards": (32, 40, 36), "filters": [zarr.codecs.TransposeCodec(order=(1, 2, 0))]},
}


@pytest.mark.parametrize("name, kind", [
    *((name, "f4") for name in VERSION_3), *(("plain", kind) for kind in "u1 i2 u4 i8 f8".split())])
def test_version_3(name, kind, tmp_path):
    samples = SAMPLES.astype(kind)
    array = zarr.create_array(tmp_path / "a", shape=samples.shape, chunks=(8, 10, 12), dtype=kind,
                              zarr_format=3, **VERSION_3[name])
    array[:] = samples
    expect_samples(tmp_path / "a", samples)
    expect_samples(tmp_path / "a", samples[5:30, 9:48, 7:31], "--roi", "7:30,9:47,5:29")


def test_chunks_that_are_not_stored(tmp_path):
    array = zarr.create_array(tmp_path / "a", shape=SAMPLES.shape, chunks=(8, 10, 12),
                              shards=(16, 20, 24), dtype="f2", zarr_format=3, fill_value=-1.5)
    array[9:, 5:41, :30] = SAMPLES[9:, 5:41, :30]
    expected = np.full(SAMPLES.shape, -1.5, "f4")
    expected[9:, 5:41, :30] = SAMPLES[9:, 5:41, :30].astype("f2")
    expect_samples(tmp_path / "a", expected)
    assert "are not stored and have the fill value" in run("info", tmp_path / "a")


AXES = ["t", "c", "z", "y", "x"]
UNITS = {"t": "second", "z": "micrometer", "y": "micrometer", "x": "micrometer"}
FACTORS = [{"z": 2, "y": 2, "x": 2}, {"z": 4, "y": 4, "x": 4}]


@pytest.fixture(params=[FormatV04(), FormatV05()], ids=["0.4", "0.5"])
def image(request, tmp_path):
    path = tmp_path / "image.ome.zarr"
    group = zarr.open_group(path, mode="w", zarr_format=request.param.zarr_format)
    data = np.stack([np.stack([SAMPLES, SAMPLES // 2]), np.stack([SAMPLES // 3, SAMPLES // 4])])
    omero = {"channels": [{"label": label, "color": "FFFFFF", "active": True, "window": {
        "min": 0, "max": 1, "start": 0, "end": 1}} for label in ("DNA", "actin")]}
    write_image(data, group, fmt=request.param, axes=AXES, axes_units=UNITS, scale_factors=FACTORS,
                scale={"z": 2.0, "y": 0.5, "x": 0.25}, omero=omero,
                storage_options={"chunks": (1, 1, 16, 16, 16)})
    write_labels((SAMPLES > 300).astype("u1"), group, name="cells", fmt=request.param,
                 axes=["z", "y", "x"], scale_factors=FACTORS,
                 scale={"z": 2.0, "y": 0.5, "x": 0.25})
    return path


def test_ome_zarr(image):
    for time in range(2):
        for channel, name in enumerate(("DNA", "actin")):
            for choice in (name, channel):
                expect_samples(image, SAMPLES // (1 + 2 * time + channel), "--channel", choice,
                               "--time", time)
    facts = info(image, "--channel", "DNA", "--time", 0)
    assert facts["spacing"] == [0.25, 0.5, 2.0] and facts["unit"] == "um"
    assert facts["format"].startswith("OME-Zarr 0.")
    assert "choose one with --time" in run("info", image)
    text = run("info", image, "--time", 1)
    assert "choose one with --channel" in text and "DNA" in text and "actin" in text


def test_a_resolution_and_labels(image):
    names = sorted(entry.name for entry in image.iterdir() if entry.is_dir())
    level = zarr.open_group(image, mode="r")[names[-1] if names[-1] != "labels" else names[-2]]
    path = image / level.basename
    expect_samples(path, np.asarray(level[1, 0]), "--channel", "DNA", "--time", 1)
    facts = info(path, "--channel", "DNA", "--time", 1)
    assert facts["spacing"] == [1.0, 2.0, 8.0]
    # The first voxel of a coarser level is centred among the voxels that it stands for.
    assert facts["origin"] == [0.375, 0.75, 3.0]
    expect_samples(image / "labels" / "cells", (SAMPLES > 300).astype("u1"))


def test_blocks_give_the_bytes_of_other_files(image, tmp_path):
    np.save(tmp_path / "a.npy", SAMPLES)
    options = [*ISO, "--block-size", "18", "--spacing", "0.25,0.5,2um", "-q"]
    run("extract", tmp_path / "a.npy", *options, "-o", tmp_path / "npy.ply")
    options += ["--channel", 0, "--time", 0]
    report = tmp_path / "a.json"
    run("extract", image, *options, "-o", tmp_path / "zarr.ply", "--report", report)
    run("blocks", "plan", image, *options[:-5], *options[-4:], "-o", tmp_path / "parts.ply",
        "--parts", tmp_path / "parts")
    run("blocks", "run", tmp_path / "parts")
    run("blocks", "merge", tmp_path / "parts")
    expected = (tmp_path / "npy.ply").read_bytes()
    assert (tmp_path / "zarr.ply").read_bytes() == expected
    assert (tmp_path / "parts.ply").read_bytes() == expected
    assert json.loads(report.read_text())["input"]["sha256"] == digest(SAMPLES)


@pytest.mark.parametrize("damage", ["cut", "changed", "empty"])
@pytest.mark.parametrize("kind", ["chunks", "shards"])
def test_a_damaged_chunk_is_named(kind, damage, tmp_path):
    more = {"shards": (16, 20, 24)} if kind == "shards" else {}
    array = zarr.create_array(tmp_path / "a", shape=SAMPLES.shape, chunks=(8, 10, 12), dtype="u2",
                              zarr_format=3, compressors=zarr.codecs.ZstdCodec(checksum=True),
                              **more)
    array[:] = SAMPLES + 1
    index = (1, 1, 1)
    path = tmp_path / "a" / "c" / "1" / "1" / "1"
    data = bytearray(path.read_bytes())
    if damage == "changed":
        data[20] ^= 0xFF
    path.write_bytes({"cut": data[:-9], "changed": data, "empty": b""}[damage])
    text = run("extract", tmp_path / "a", *ISO, "--block-size", "20", "-o", tmp_path / "b.ply",
               status=2)
    assert text.count("\n") == 1 + text.startswith("isoatlas: warning")
    assert str(path) in text
    assert damage == "empty" or kind == "shards" or f"chunk {index} is damaged" in text
    assert not (tmp_path / "b.ply").exists()
    # Blocks elsewhere do not need this chunk.
    run("info", tmp_path / "a", "--roi", "0:11,0:9,0:7")


def test_messages(image, tmp_path):
    assert "has none of its chunks" in run("info", empty_array(tmp_path / "none"), status=2)
    strings = zarr.create_array(tmp_path / "c", shape=(4, 4, 4), dtype="c8", chunks=(4, 4, 4))
    strings[:] = 1
    assert "complex64" in run("info", tmp_path / "c", status=2)
    flat = zarr.create_array(tmp_path / "flat", shape=(4, 4), dtype="u1", chunks=(4, 4))
    flat[:] = 1
    assert "has 2 axes without names" in run("info", tmp_path / "flat", status=2)
    shutil.copytree(image, tmp_path / "two" / "a")
    shutil.copytree(image, tmp_path / "two" / "b")
    zarr.open_group(tmp_path / "two", mode="a", zarr_format=3)
    text = run("info", tmp_path / "two", status=2)
    assert str(tmp_path / "two" / "a") in text and str(tmp_path / "two" / "b") in text


def empty_array(path):
    zarr.create_array(path, shape=(4, 4, 4), dtype="u1", chunks=(2, 2, 2))
    return path
