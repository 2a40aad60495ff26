# SPDX-License-Identifier: Apache-2.0
import gc
import json

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES, torus


def test_volume_has_the_data_of_the_file():
    volume = isoatlas.read(SAMPLES / "protein_iron.nhdr")
    raw = np.fromfile(SAMPLES / "protein_iron.raw", np.uint8).reshape(68, 68, 68)
    assert isinstance(volume, isoatlas.Volume)
    assert volume.array.dtype == np.uint8 and np.array_equal(volume.array, raw)
    flags = volume.array.flags
    assert flags.c_contiguous and flags.writeable and not flags.owndata
    assert volume.spacing == (1.0, 1.0, 1.0) and volume.path == SAMPLES / "protein_iron.nhdr"
    assert np.array_equal(volume.direction, np.eye(3))


def test_array_outlives_the_volume():
    array = isoatlas.read_volume(SAMPLES / "protein_iron.nhdr").array
    gc.collect()
    # New arrays would overwrite the memory if it had been freed.
    fillers = [np.full(array.size, 99, np.uint8) for _ in range(20)]
    expected = np.fromfile(SAMPLES / "protein_iron.raw", np.uint8)
    assert np.array_equal(array.ravel(), expected) and fillers
    array[:] = 0  # users may change it


def test_headerless_files(tmp_path):
    samples = np.arange(2 * 3 * 4, dtype=">i2").reshape(2, 3, 4)
    samples.tofile(tmp_path / "v.ply")  # the extension does not matter
    volume = isoatlas.read(
        tmp_path / "v.ply",
        raw_size=(4, 3, 2),
        raw_type="int16",
        raw_spacing=(1, 2, 3.5),
        raw_endian="big",
    )
    assert np.array_equal(volume.array, samples) and volume.spacing == (1.0, 2.0, 3.5)
    for options, message in (
        ({"raw_size": (4, 3, 2)}, "expected both"),
        ({"raw_endian": "big"}, "expected raw_size"),
        (
            {"raw_size": (4, 3), "raw_type": "int16"},
            "raw_size: expected three whole numbers like 256,256,94, got '4,3'",
        ),
        (
            {"raw_size": (4, 3, 2), "raw_type": "half"},
            "raw_type: expected one of int8, .* got 'half'",
        ),
        (
            {"raw_size": (4, 3, 2), "raw_type": "int16", "raw_spacing": (0, 1, 1)},
            "raw_spacing: expected three positive numbers",
        ),
    ):
        with pytest.raises(isoatlas.BadArgumentError, match=message):
            isoatlas.read(tmp_path / "v.ply", **options)


@pytest.mark.parametrize("extension", ["ply", "obj", "off", "vtp", "stl", "3mf", "gii"])
def test_meshes_can_be_read_back(extension, tmp_path):
    mesh = isoatlas.extract(torus(), 0.0, order="ijk")
    mesh.save(tmp_path / f"m.{extension}")
    back = isoatlas.read(str(tmp_path / f"m.{extension}"))
    assert isinstance(back, isoatlas.Mesh) and len(back.levels) == 1 and back.levels[0].report == {}
    if extension == "stl":
        assert len(back.faces) == len(mesh.faces) and len(back.vertices) == len(mesh.vertices)
    elif extension == "gii":  # the array's axes have no known meaning: they are not converted
        assert np.array_equal(back.vertices, mesh.vertices.astype("float32"))
        assert np.array_equal(back.faces, mesh.faces)
    else:
        assert np.array_equal(back.vertices, mesh.vertices)
        assert np.array_equal(back.faces, mesh.faces)
    assert repr(back) == f"<isoatlas.Mesh: {len(back.vertices)} vertices, {len(back.faces)} faces>"


@pytest.mark.parametrize("extension", ["glb", "vtm"])
@pytest.mark.parametrize("placement", ["surface", "balanced"])
def test_levels_can_be_read_back(extension, placement, tmp_path):
    mesh = isoatlas.extract(
        torus(),
        0.0,
        order="ijk",
        refine=["max-distance:1vx", "max-distance:0.5vx"],
        placement=placement,
    )
    mesh.save(tmp_path / f"m.{extension}")
    back = isoatlas.read_mesh(tmp_path / f"m.{extension}")
    assert len(back.levels) == 3 and back.placement == placement
    for ours, theirs in zip(mesh.levels, back.levels):
        assert np.array_equal(ours.faces, theirs.faces)
        rounding = 0 if extension == "vtm" else 1e-5
        assert np.allclose(ours.vertices, theirs.vertices, atol=rounding, rtol=0)
        for key in ("level", "genus"):
            assert theirs.report[key] == ours.report[key]
        for name, metric in ours.report["metrics"].items():
            # The maximum in the file includes the rounding of its vertices.
            maximum = theirs.report["metrics"][name]["maximum"]
            assert maximum == pytest.approx(metric["maximum"], abs=rounding)
            assert maximum >= metric["maximum"]
    back.save(tmp_path / f"again.{extension}")
    again = isoatlas.read_mesh(tmp_path / f"again.{extension}")
    assert again.report == back.report
    for ours, theirs in zip(again.levels, back.levels):
        assert ours.vertices.tobytes() == theirs.vertices.tobytes()
        assert ours.faces.tobytes() == theirs.faces.tobytes()
    with pytest.raises(isoatlas.BadArgumentError, match="report: these levels were read"):
        back.save(tmp_path / "m.ply", report=tmp_path / "m.json")


def test_levels_without_a_report_can_be_saved(tmp_path):
    isoatlas.extract(torus(), 0.0, order="ijk").save(tmp_path / "m.ply")
    mesh = isoatlas.read_mesh(tmp_path / "m.ply")
    mesh.save(tmp_path / "n.glb", glb_per_level=True)
    mesh.save(tmp_path / "o-{level}.glb")
    assert len(json.loads((tmp_path / "n.json").read_text())["levels"]) == 1
    for name in ("n-0.glb", "o-0.glb"):
        assert len(isoatlas.read_mesh(tmp_path / name).faces) == len(mesh.faces)


def test_volume_made_by_the_user():
    volume = isoatlas.Volume(torus(), spacing=(1, 2, 3), origin=(4, 5, 6))
    ours = isoatlas.extract(volume, 0.0)
    theirs = isoatlas.extract(torus(), 0.0, spacing=(1, 2, 3), origin=(4, 5, 6), order="xyz")
    assert ours.vertices.tobytes() == theirs.vertices.tobytes()


def test_volumes_with_another_array():
    volume = isoatlas.Volume(torus(), spacing=(1, 2, 3), origin=(4, 5, 6), unit="um", path="v.tif")
    mask = volume.replace(array=volume.array > 0)
    assert mask.spacing == (1, 2, 3) and mask.origin == (4, 5, 6) and mask.unit == "um"
    assert mask.array.dtype == bool and mask.path is None and mask.source is None
    assert volume.array.dtype == np.float32 and volume.path == "v.tif"
    a, b = isoatlas.extract(volume, 0), isoatlas.extract(mask, 0.5)
    assert np.allclose(a.bounds, b.bounds, atol=3)
    other = volume.replace(spacing=(1, 1, 1), direction=np.diag([1, -1, -1]), unit="nm")
    assert other.array is volume.array and other.path == "v.tif"
    assert other.direction == ((1, 0, 0), (0, -1, 0), (0, 0, -1)) and other.unit == "nm"
    assert isinstance(other.spacing, isoatlas.XYZ) and other.spacing.z == 1


def test_arrays_of_another_shape_need_their_origin():
    volume = isoatlas.Volume(torus(), spacing=(1, 2, 3))
    with pytest.raises(isoatlas.BadArgumentError, match="array: expected the shape .26, 22, 14"):
        volume.replace(array=volume.array[2:])
    with pytest.raises(isoatlas.BadArgumentError, match="array: expected the shape"):
        volume.replace(array=volume.array.T)
    part = volume.replace(array=volume.array[1:], origin=(0, 0, 3))
    whole = isoatlas.extract(volume, 0.0)
    assert np.allclose(isoatlas.extract(part, 0.0).bounds, whole.bounds, atol=1)
    half = volume.replace(array=volume.array[::2, ::2, ::2], spacing=(2, 4, 6))
    assert np.allclose(isoatlas.extract(half, 0.0).bounds, whole.bounds, atol=3)
    with pytest.raises(isoatlas.BadArgumentError, match="unit: expected one of nm"):
        volume.replace(unit="furlong")
    with pytest.raises(isoatlas.BadArgumentError, match="spacing: expected 3 numbers, got 2"):
        volume.replace(spacing=(1, 2))
