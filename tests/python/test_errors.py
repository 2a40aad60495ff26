# SPDX-License-Identifier: Apache-2.0
"""Classes, codes and texts of errors; the texts are the same as on the command line."""

import os
import shutil

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES, torus

PROTEIN = SAMPLES / "protein_iron.nhdr"


def error_of(work):
    with pytest.raises(isoatlas.Error) as raised:
        work()
    return raised.value


def line_of(tool, *arguments):
    """The error line of the command line, without its prefix and the reference to its help."""
    run = tool("extract", *arguments, status=2)
    return (
        run.stderr.strip()
        .removeprefix("isoatlas: error: ")
        .removesuffix(" (see isoatlas extract --help)")
    )


@pytest.mark.parametrize(
    ("base", "cls", "code"),
    [
        (ValueError, isoatlas.BadArgumentError, "bad_argument"),
        (ValueError, isoatlas.UnsupportedError, "unsupported"),
        (ValueError, isoatlas.EmptySurfaceError, "empty_surface"),
        (OSError, isoatlas.BadFileError, "bad_file"),
        (MemoryError, isoatlas.OutOfMemoryError, "out_of_memory"),
        (RuntimeError, isoatlas.InternalError, "internal"),
    ],
)
def test_classes_derive_from_builtin_exceptions(base, cls, code):
    error = cls("text")
    assert isinstance(error, isoatlas.Error) and isinstance(error, base)
    assert error.code == code and str(error) == "text"


OPTIONS = [
    ("inside", "up"), ("topology", "x"), ("interpolation", "linear"), ("nan", "refuse"),
    ("space", "LPI"), ("covering", "radius"), ("placement", "up"), ("supersample", 0),
    ("supersample", 1.5), ("adaptive_supersample", 9), ("adaptive_supersample", -1),
    ("min_component_size", "3cm"), ("keep_components", 0), ("keep_near", "1,x,3"),
    ("drop_near", "1,2,nan"), ("max_radius", 0),
    ("max_radius", "1e999"), ("event_persistence", "-1vx"), ("measure_samples", 0),
    ("threads", -1), ("max_distance", 0), ("max_distance", "3 px"), ("mean_distance", float("nan")),
    ("area_curvature", 1), ("area_curvature_smooth", 0.5), ("geodesic_ratio", float("inf")),
    ("normal_angle", -5), ("max_vertices", 3), ("max_vertices", 10.5), ("min_vertices", -4),
    ("min_edge", 0), ("max_edge", "x"), ("min_aspect", 1), ("min_aspect", 0),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), OPTIONS)
def test_bad_options_give_the_same_message(name, value, tool, tmp_path):
    error = error_of(lambda: isoatlas.extract(torus(), 0.0, **{name: value}))
    assert isinstance(error, isoatlas.BadArgumentError)
    option = "--" + name.replace("_", "-")
    line = line_of(tool, PROTEIN, "--iso", "100", f"{option}={value}", "-o", tmp_path / "m.ply")
    assert str(error) == line.replace(option, name, 1), line


def test_too_much_supersampling_gives_the_same_message(tool, tmp_path):
    error = error_of(lambda: isoatlas.extract(isoatlas.read(PROTEIN), 100, supersample=1000))
    assert isinstance(error, isoatlas.BadArgumentError) and "times at most" in str(error)
    options = ["--iso", "100", "--supersample", "1000", "-o", tmp_path / "m.ply"]
    assert str(error) == line_of(tool, PROTEIN, *options)


def test_values_ignore_case_and_blanks():
    volume = torus()
    options = {
        "space": " LPS",
        "inside": "Above",
        "covering": "sizing_field",
        "max_distance": "0.5 VX",
        "coarse": False,
    }
    assert isoatlas.extract(volume, 0.0, **options).levels


@pytest.mark.parametrize(
    "spec",
    [
        "max-distance",
        "",
        "max-distance:",
        "distance:1",
        "max-distance:0",
        "max-distance:1,max-distance:2",
    ],
)
def test_bad_refine_gives_the_same_message(spec, tool, tmp_path):
    error = error_of(lambda: isoatlas.extract(torus(), 0.0, refine=spec))
    if not spec:  # the command line refuses an empty value earlier
        assert str(error).startswith("refine: ")
        return
    options = ["--iso", "100", "--refine", spec, "-o", tmp_path / "m.ply"]
    line = line_of(tool, PROTEIN, *options)
    assert str(error) == line.replace("--refine", "refine", 1)


def test_refine_in_other_forms():
    def text_of(**options):
        return str(error_of(lambda: isoatlas.extract(torus(), 0.0, **options)))

    assert "there is no constraint 'distance'" in text_of(refine={"distance": 1})
    assert "at least one bound" in text_of(refine={})
    assert "without refine" in text_of(refine="max-distance:1", coarse=True)
    for refine in (3, [3], [["max-distance", 1]]):
        with pytest.raises(TypeError):
            isoatlas.extract(torus(), 0.0, refine=refine)
    with pytest.raises(TypeError, match="max_distance: expected a number or a text"):
        isoatlas.extract(torus(), 0.0, max_distance=[1])


def test_isovalues(tool, tmp_path):
    for iso in ("nan", "inf"):
        error = error_of(lambda: isoatlas.extract(torus(), float(iso)))
        assert "--" + str(error) == line_of(tool, PROTEIN, "--iso", iso, "-o", tmp_path / "m.ply")
    with pytest.raises(TypeError):
        isoatlas.extract(torus(), [1])
    error = error_of(lambda: isoatlas.extract(isoatlas.read(PROTEIN), 300))
    assert isinstance(error, isoatlas.EmptySurfaceError)
    line = line_of(tool, PROTEIN, "--iso", "300", "-o", tmp_path / "m.ply")
    assert line == f"{error}; `isoatlas info {PROTEIN}` suggests isovalues"
    assert not str(error_of(lambda: isoatlas.extract(torus(), 300))).startswith(":")


@pytest.mark.parametrize("name", ["missing.nrrd", "empty.nrrd", "text.nrrd", "volume.xyz"])
def test_bad_files_give_the_same_message(name, tool, tmp_path):
    path = tmp_path / name
    if name != "missing.nrrd":
        path.write_text(
            {"empty.nrrd": "", "text.nrrd": "NRRD0004\nnonsense", "volume.xyz": "x"}[name]
        )
    error = error_of(lambda: isoatlas.read(path))
    line = line_of(tool, path, "--iso", "1", "-o", tmp_path / "m.ply")
    # The command line may append what to type instead.
    assert line == str(error) or line.startswith(str(error) + "; ")
    assert isinstance(error, ValueError if name == "volume.xyz" else OSError)


def test_bad_outputs_give_the_same_message(tool, tmp_path):
    mesh = isoatlas.extract(isoatlas.read(PROTEIN), 100, coarse=True)
    for path in (
        tmp_path / "no" / "m.ply",
        tmp_path / "m.xyz",
        tmp_path / "m",
        tmp_path / "m-{k}.ply",
        tmp_path / "{level}.vtm",
        tmp_path,
    ):
        line = line_of(tool, PROTEIN, "--iso", "100", "--coarse", "-o", path)
        assert str(error_of(lambda: mesh.save(path))) == line
    assert list(tmp_path.iterdir()) == []
    copy = tmp_path / "v.ply"  # a volume with the name of a mesh
    shutil.copy(SAMPLES / "protein_iron.raw", copy)
    volume = isoatlas.read_volume(copy, raw_size=(68, 68, 68), raw_type="uint8")
    error = error_of(lambda: isoatlas.extract(volume, 100, coarse=True).save(copy))
    assert str(error) == f"{copy}: the mesh would replace the volume"
    error = error_of(lambda: mesh.save(tmp_path / "m.ply", report=tmp_path / "m.ply"))
    assert "the report would replace the mesh" in str(error)


def test_failed_outputs_leave_existing_files_unchanged(tmp_path):
    (tmp_path / "m.ply").write_text("old")
    mesh = isoatlas.extract(torus(), 0.0, order="ijk", coarse=True)
    error_of(lambda: mesh.save(tmp_path / "m.ply", report=tmp_path / "no" / "m.json"))
    assert (tmp_path / "m.ply").read_text() == "old"
    mesh.save(tmp_path / "m.ply")
    assert (tmp_path / "m.ply").read_bytes().startswith(b"ply")
    assert os.listdir(tmp_path) == ["m.ply"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"spacing": (1, 1)}, "spacing: expected 3 numbers, got 2"),
        ({"spacing": (1, 0, 1)}, "spacing"),
        ({"spacing": (1, -1, 1)}, "spacing"),
        ({"spacing": (1, float("nan"), 1)}, "spacing"),
        ({"origin": (0, float("inf"), 0)}, "origin"),
        ({"direction": np.eye(2)}, r"direction: expected an array of shape \(3, 3\), got \(2, 2\)"),
        ({"direction": np.zeros((3, 3))}, "direction"),
        ({"order": "zyx"}, "order: expected one of ijk, xyz, got 'zyx'"),
    ],
)
def test_geometry_is_refused(options, message):
    with pytest.raises(isoatlas.BadArgumentError, match=message):
        isoatlas.extract(torus(), 0.0, **options)


def test_sheared_direction_is_unsupported():
    sheared = np.array([[1, 0.6, 0], [0, 0.8, 0], [0, 0, 1]])
    error = error_of(lambda: isoatlas.extract(torus(), 0.0, direction=sheared, order="ijk"))
    assert isinstance(error, isoatlas.UnsupportedError)
    mesh = isoatlas.extract(torus(), 0.0, direction=sheared, order="ijk", coarse=True)
    assert len(mesh.faces) > 0


def test_points():
    for points in ((1, 2), [[1, 2]], 3, [[(1, 2, 3)]], {"x": 1}, (1, 2, "x")):
        with pytest.raises(isoatlas.BadArgumentError, match="keep_near: expected a point"):
            isoatlas.extract(torus(), 0.0, keep_near=points)
    with pytest.raises(isoatlas.BadArgumentError, match="drop_near: .* got '1,2,nan'"):
        isoatlas.extract(torus(), 0.0, drop_near=(1, 2, float("nan")))


def test_wrong_types_are_type_errors():
    for options in (
        {"spacing": 1.0},
        {"progress": 3},
        {"threads": "a" and [1]},
        {"supersample": True},
    ):
        with pytest.raises(TypeError):
            isoatlas.extract(torus(), 0.0, **options)
    with pytest.raises(TypeError, match=r"isoatlas.read\(path\)"):
        isoatlas.extract(str(PROTEIN), 100)
    with pytest.raises(TypeError):
        isoatlas.extract(torus(), 0.0, max_dist=1)


def test_a_volume_has_its_own_geometry():
    volume = isoatlas.read(PROTEIN)
    for options in (
        {"spacing": (2, 2, 2)},
        {"origin": (0, 0, 1)},
        {"direction": np.eye(3)},
        {"order": "ijk"},
    ):
        error = error_of(lambda: isoatlas.extract(volume, 100, **options))
        assert str(error).startswith(next(iter(options)) + ": ")


def test_paths_that_are_not_utf_8(tmp_path):
    folder = os.fsencode(tmp_path) + b"/\xff"
    os.mkdir(folder)
    mesh = isoatlas.extract(torus(), 0.0, order="ijk", coarse=True)
    path = os.fsdecode(folder + b"/m.ply")
    mesh.save(path)
    assert isoatlas.read_mesh(path).faces.tobytes() == mesh.faces.tobytes()
    assert path + "x" in str(error_of(lambda: isoatlas.read_mesh(path + "x.ply")))
