# SPDX-License-Identifier: Apache-2.0
"""isoatlas as a command-line module of 3D Slicer, driven as Slicer does it.

The script IsoAtlas is run in a folder of temporary files, with volumes as Slicer writes them and
the command line that Slicer makes from the description. ISOATLAS_SLICER_MODULE is its path.
"""

import gzip
import logging
import os
import pathlib
import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

import isoatlas
from module_description import command_line, problems

ctk_cli = pytest.importorskip("ctk_cli", reason="ctk-cli is not installed")
ROOT = pathlib.Path(__file__).resolve().parents[3]
DATA = pathlib.Path(os.environ.get("ISOATLAS_TEST_DATA") or ROOT.parent / "shared" / "data")
MODULE = pathlib.Path(os.environ["ISOATLAS_SLICER_MODULE"])
TOOL = os.environ["ISOATLAS_TOOL"]
TYPES = {"int16": "short", "uint8": "unsigned char", "float32": "float", "int32": "int"}
# Names as Slicer makes them: the digits of process and node are letters.
VOLUME, MODEL = "BCDE_vtkMRMLScalarVolumeNodeB.nrrd", "BCDE_vtkMRMLModelNodeE.vtp"


def write_nrrd(path, array, spacing, origin, direction):
    """Write a volume as Slicer does: LPS, compressed. The array is indexed [z, y, x]."""
    steps = np.asarray(direction, float) * np.asarray(spacing, float)
    vectors = " ".join("(" + ",".join(map(repr, column.tolist())) + ")" for column in steps.T)
    header = (
        f"NRRD0004\ntype: {TYPES[str(array.dtype)]}\ndimension: 3\n"
        "space: left-posterior-superior\n"
        f"sizes: {' '.join(map(str, array.shape[::-1]))}\n"
        f"space directions: {vectors}\nkinds: domain domain domain\nendian: little\n"
        f"encoding: gzip\nspace origin: ({','.join(map(repr, map(float, origin)))})\n\n"
    )
    path.write_bytes(header.encode() + gzip.compress(array.tobytes(), 1))


def write_volume(path, volume, array=None):
    array = volume.array if array is None else array
    write_nrrd(path, np.ascontiguousarray(array), volume.spacing, volume.origin, volume.direction)


def ball(radius=6.0, dtype=np.float32):
    z, y, x = np.indices((18, 20, 22), dtype=float)
    return (radius - np.sqrt((x - 10) ** 2 + (y - 9) ** 2 + (z - 8) ** 2)).astype(dtype)


@pytest.fixture(scope="module")
def module():
    return ctk_cli.CLIModule(str(MODULE))


class Run:
    """One run of the module in a folder."""

    def __init__(self, module, folder, **values):
        self.model, self.returned = folder / MODEL, folder / "BCDE_aBcD.params"
        files = {"inputVolume": folder / VOLUME, "outputModel": self.model}
        words = command_line(module, files, values, self.returned)
        # Slicer's environment: its libraries come first. This one could not be loaded.
        libraries = folder / "lib"
        libraries.mkdir(exist_ok=True)
        (libraries / "libtbb.so.12").write_bytes(b"not a library")
        self.done = subprocess.run(
            [MODULE, *words],
            capture_output=True,
            text=True,
            cwd=folder,
            env={**os.environ, "LD_LIBRARY_PATH": str(libraries), "PYTHONHOME": "/nowhere"},
        )
        self.status, self.output, self.errors = (
            self.done.returncode,
            self.done.stdout,
            self.done.stderr,
        )

    def results(self):
        """The returned values, as Slicer parses them: name = value."""
        lines = self.returned.read_text().splitlines()
        return dict(re.fullmatch(r"(\w+) = (.*)", line).groups() for line in lines)


def read_model(path):
    """Vertices and faces, and the space that the file states, as Slicer's reader takes it."""
    io = pytest.importorskip("vtkmodules.vtkIOXML", reason="VTK is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy

    reader = io.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    model = reader.GetOutput()
    space = model.GetFieldData().GetAbstractArray("SPACE").GetValue(0)
    faces = vtk_to_numpy(model.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return vtk_to_numpy(model.GetPoints().GetData()), faces, space


def enclosed(vertices, faces):
    a, b, c = (vertices[faces[:, k]].astype(float) for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


# -------------------------------------------------------------------------------- description


def description():
    done = subprocess.run([MODULE, "--xml"], capture_output=True, text=True, cwd=MODULE.parent)
    assert done.returncode == 0 and done.stderr == ""
    return done.stdout


def test_description_follows_the_schema():
    assert problems(description()) == []


def test_the_tool_prints_the_description_too():
    for words in (["--xml"], ["slicer-module", "--xml"]):
        done = subprocess.run([TOOL, *words], capture_output=True, text=True)
        assert done.returncode == 0 and done.stdout == description()


@pytest.mark.parametrize(
    ("pattern", "replacement", "found"),
    [
        ("<longflag>coarse", "<longflag>iso-value", "is no flag"),
        ("<name>label</name>", "<name>isovalue</name>", "used twice"),
        ("<default>refuse", "<default>never", "default 'never'"),
        ("<index>1</index>", "<index>3</index>", "indices"),
        ("      <longflag>inside</longflag>\n", "", "has []"),
        ("<integer>(.*?label)", r"<number>\1", None),
        ("<title>Isoatlas", "<title>", "no title"),
        ("<default>0.5<", "<default>half<", "default 'half'"),
        (r"(<parameters>)", r"\1<boolean/>", "group"),
    ],
)
def test_the_check_of_the_schema_finds_mistakes(pattern, replacement, found):
    text, count = re.subn(pattern, replacement, description(), count=1, flags=re.S)
    assert count == 1
    try:
        assert any((found or "") in problem for problem in problems(text))
    except ElementTree.ParseError:
        assert found is None


def test_ctk_cli_reads_all_parameters(caplog):
    with caplog.at_level(logging.WARNING):
        module = ctk_cli.CLIModule(str(MODULE))
    assert module.title == "Isoatlas" and module.version == isoatlas.__version__
    arguments, options, outputs = module.classifyParameters()
    assert [parameter.typ for parameter in arguments] == ["image", "geometry"]
    assert arguments[0].subtype == "scalar"  # Slicer offers volumes and label maps
    assert arguments[1].defaultExtension() == ".vtp"
    defaults = {parameter.name: parameter.default for parameter in options}
    assert defaults["isovalue"] == 0.5 and defaults["maxDistance"] == "auto"
    assert [group.advanced for group in module] == [False, False, False, False, True, False]
    # CTK wants a flag or an index for returned values; Slicer wants neither.
    names = [parameter.name for parameter in outputs]
    assert {"triangles", "genus"} <= set(names)
    assert [record.getMessage().split()[1] for record in caplog.records] == names


def test_names_on_the_page(module):
    """The script for Slicer's console, which needs Slicer, and the table of parameters."""
    page = (ROOT / "docs/hosts/slicer.md").read_text()
    names = {parameter.name for parameter in module.parameters()}
    used = re.findall(r'"(\w+)":', page)
    assert len(used) == 4 and set(used) <= names
    labels = {parameter.label for parameter in module.parameters()}
    table = re.findall(r"(?m)^\| ([A-Z][\w ]+) \|", page)
    assert len(table) >= 5 and set(table) <= labels
    assert module.category == "Surface Models" and MODULE.name.lower() == "isoatlas"


def test_the_parser_of_ctk_cli_accepts_the_command_line(module, tmp_path):
    (tmp_path / "IsoAtlas.xml").write_text(description())
    parser = ctk_cli.CLIArgumentParser(str(tmp_path / "IsoAtlas.xml"))
    files = {"inputVolume": "in.nrrd", "outputModel": "out.vtp"}
    words = command_line(module, files, {"isovalue": 3.5}, "values.params")
    # Its booleans take a value and it does not know the flag of returned values.
    parsed = parser.parse_args([word for word in words[2:]])
    assert parsed.isovalue == 3.5 and parsed.inputVolume == "in.nrrd"


# ---------------------------------------------------------------------------------------- runs


def test_oblique_volume(module, tmp_path):
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    spacing, origin = (0.5, 0.7, 1.2), (-10.0, 20.0, 30.0)
    write_nrrd(tmp_path / VOLUME, ball(), spacing, origin, turn)
    run = Run(module, tmp_path, isovalue=0.0)
    assert run.status == 0 and run.errors == ""
    vertices, faces, space = read_model(run.model)
    assert space == "LPS"
    middle = np.array(origin) + turn @ (np.array(spacing) * (10, 9, 8))
    assert np.allclose(vertices.mean(axis=0), middle, atol=0.3)
    volume = 4 / 3 * np.pi * 6**3 * np.prod(spacing)
    assert enclosed(vertices, faces) == pytest.approx(volume, rel=0.1)  # positive: outwards
    results = run.results()
    assert results["triangles"] == str(len(faces)) and results["vertices"] == str(len(vertices))
    assert (results["components"], results["genus"], results["boundaryLoops"]) == ("1", "0", "0")
    assert results["violated"] == "none"


def test_same_mesh_as_the_command_line(module, tmp_path):
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 2), (0, 0, 0), np.eye(3))
    run = Run(
        module, tmp_path, isovalue=0.25, maxDistance="0.3mm", maxVertices=500, normalAngle=25.0,
        keepComponents=1, placement="balanced", topology="faces",
    )
    assert run.status == 0, run.errors
    subprocess.run(
        [TOOL, "extract", VOLUME, "--iso", "0.25", "--max-vertices", "500", "--max-distance",
         "0.3mm", "--normal-angle", "25", "--keep-components", "1", "--placement", "balanced",
         "--topology", "faces", "-q", "-o", "theirs.vtp"],
        cwd=tmp_path,
    )
    assert run.model.read_bytes() == (tmp_path / "theirs.vtp").read_bytes()


def test_default_bound_is_that_of_the_command_line(module, tmp_path):
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 6), (0, 0, 0), np.eye(3))
    run = Run(module, tmp_path, isovalue=0.25)
    subprocess.run(
        [TOOL, "extract", VOLUME, "--iso", "0.25", "-q", "-o", "theirs.vtp"], cwd=tmp_path
    )
    assert run.model.read_bytes() == (tmp_path / "theirs.vtp").read_bytes()


def test_levels(module, tmp_path):
    """The model is the finest level; the folder has all of them, each coarser than the next."""
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 2), (0, 0, 0), np.eye(3))
    folder = tmp_path / "levels of detail"
    folder.mkdir()
    run = Run(module, tmp_path, isovalue=0.25, levels=3, maxDistance="0.1vx", levelFolder=folder)
    assert run.status == 0, run.errors
    subprocess.run(
        [TOOL, "extract", VOLUME, "--iso", "0.25", "--levels", "3", "--max-distance", "0.1vx",
         "-q", "-o", "theirs-{level}.vtp"],
        cwd=tmp_path,
    )
    written = sorted(folder.iterdir())
    assert [path.name for path in written] == ["level-0.vtp", "level-1.vtp", "level-2.vtp"]
    for level, path in enumerate(written):
        assert path.read_bytes() == (tmp_path / f"theirs-{level}.vtp").read_bytes()
    assert run.model.read_bytes() == written[2].read_bytes()
    sizes = [len(read_model(path)[1]) for path in written]
    assert sizes == sorted(sizes) and sizes[0] < sizes[2]
    assert run.results()["triangles"] == str(sizes[2])


def test_a_folder_without_a_number_of_levels(module, tmp_path):
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 1), (0, 0, 0), np.eye(3))
    run = Run(module, tmp_path, isovalue=0.25, levelFolder=tmp_path)
    assert run.status == 0, run.errors
    assert (tmp_path / "level-0.vtp").is_file() and not (tmp_path / "level-2.vtp").exists()
    assert (tmp_path / "level-1.vtp").read_bytes() == run.model.read_bytes()


def test_caps(module, tmp_path):
    write_nrrd(tmp_path / VOLUME, ball()[:9], (1, 1, 2), (0, 0, 0), np.eye(3))
    run = Run(module, tmp_path, isovalue=0.0, border="closed", levels=2)
    assert run.status == 0, run.errors
    assert run.results()["boundaryLoops"] == "0"
    vertices, faces, _ = read_model(run.model)
    assert vertices[:, 2].max() == 16
    assert enclosed(vertices, faces) == pytest.approx(2 / 3 * np.pi * 6**3 * 2, rel=0.15)


def test_label_map(module, tmp_path):
    labels = np.zeros((18, 20, 22), np.int16)
    labels[ball() > 0] = 3
    labels[ball(3.0) > 0] = 7  # inside label 3
    write_nrrd(tmp_path / VOLUME, labels, (1, 1, 1), (0, 0, 0), np.eye(3))
    shell = Run(module, tmp_path, label=3, maxDistance="0.1mm")
    assert shell.status == 0 and shell.results()["components"] == "2"
    vertices, faces, _ = read_model(shell.model)
    assert enclosed(vertices, faces) == pytest.approx(np.count_nonzero(labels == 3), rel=0.15)
    kernel = Run(module, tmp_path, label=7)
    assert kernel.results()["components"] == "1"
    missing = Run(module, tmp_path, label=5)
    assert missing.status == 2
    assert "no sample has the label 5; the labels are 0, 3, 7" in missing.errors


def test_a_label_needs_whole_numbers(module, tmp_path):
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 1), (0, 0, 0), np.eye(3))
    run = Run(module, tmp_path, label=1)
    assert run.status == 2 and "expected whole numbers" in run.errors


def test_progress(module, tmp_path):
    volume = isoatlas.read(ROOT / "samples/protein_iron.nhdr")
    write_volume(tmp_path / VOLUME, volume)
    run = Run(module, tmp_path, isovalue=100.5)
    assert run.status == 0 and run.results()["components"] == "31"
    assert run.output.startswith("<filter-start>\n<filter-name>isoatlas</filter-name>\n")
    found = [float(x) for x in re.findall(r"<filter-progress>(.*?)</filter-progress>", run.output)]
    assert len(found) > 5 and found == sorted(found) and found[-1] == 1
    stages = re.findall(r"<filter-comment>(.*?)</filter-comment>", run.output)
    assert {"read", "cover", "refine", "write"} <= set(stages)
    rest = run.output
    for name in ("progress", "name", "comment", "time", "start", "end"):  # Slicer's order
        rest = re.sub(rf"<filter-{name}>[^<]*</filter-{name}>\s*", "", rest)
    assert "<" not in rest.replace("< ", "") and "certificate" in rest
    assert run.output.index("<filter-end>") < run.output.index("certificate")


def test_violated_bounds_and_warnings_are_no_errors(module, tmp_path):
    """Slicer shows standard error as an error and discards the model of a failed module."""
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 1), (0, 0, 0), np.eye(3))
    run = Run(module, tmp_path, isovalue=0.0, maxVertices=20, maxDistance="0.01vx")
    assert run.status == 0 and run.errors == "" and run.model.is_file()
    assert "max-distance" in run.results()["violated"]
    assert "level 1: max-distance 0.01" in run.output


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"isovalue": 1000.0}, "isovalue"),
        ({"maxDistance": "near"}, "--maxDistance: expected a length"),
        ({"inside": "left"}, "--inside: expected one of above, below, got 'left'"),
        ({"supersample": 0}, "--supersample: "),
        ({"levels": 17}, "--levels: expected a whole number from 1 to 16"),
        ({"levels": 2, "coarse": True}, "--levels makes refined levels"),
        ({"levelFolder": "missing"}, "missing"),
        ({"label": "x"}, "--label: expected a whole number, got 'x'"),
        ({"minComponentSize": "big"}, "--minComponentSize: expected a size"),
    ],
)
def test_errors_are_one_line(module, tmp_path, values, message):
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 1), (0, 0, 0), np.eye(3))
    run = Run(module, tmp_path, **values)
    assert run.status == 2
    assert run.errors.count("\n") == 1 and run.errors.startswith("isoatlas: error: ")
    assert message in run.errors
    assert not run.model.exists() and not run.returned.exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == [VOLUME, "lib"]


def test_missing_and_truncated_volumes(module, tmp_path):
    run = Run(module, tmp_path)
    assert run.status == 2 and VOLUME in run.errors and run.errors.count("\n") == 1
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 1), (0, 0, 0), np.eye(3))
    (tmp_path / VOLUME).write_bytes((tmp_path / VOLUME).read_bytes()[:1000])
    run = Run(module, tmp_path)
    assert run.status == 2 and VOLUME in run.errors and not run.model.exists()


def run_words(*words, folder=None):
    return subprocess.run([MODULE, *map(str, words)], capture_output=True, text=True, cwd=folder)


def test_standard_flags(tmp_path):
    write_nrrd(tmp_path / VOLUME, ball(), (1, 1, 1), (0, 0, 0), np.eye(3))
    done = run_words(
        "--processinformationaddress", "0x55d0c8a3b2f0", "--isovalue=0.5", "--echo", "--", VOLUME,
        MODEL, folder=tmp_path,
    )
    assert done.returncode == 0 and (tmp_path / MODEL).is_file()
    assert "isovalue: 0.5" in done.stdout
    assert run_words("--version").stdout == f"isoatlas {isoatlas.__version__}\n"
    for flag in ("--help", "-h"):
        assert "--maxDistance <string>" in run_words(flag).stdout
    negative = run_words("--isovalue", "-2.5", VOLUME, "negative.ply", folder=tmp_path)
    assert negative.returncode == 0
    assert b"SPACE=LPS" in (tmp_path / "negative.ply").read_bytes()[:300]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "expected two files, the volume and the model, got 0"),
        (["a.nrrd"], "got 1"),
        (["a.nrrd", "b.vtp", "c.vtp"], "got 3"),
        (["--isovalu", "3", "a.nrrd", "b.vtp"], "unknown flag --isovalu; did you mean --isovalue?"),
        (["-iso", "3", "a.nrrd", "b.vtp"], "unknown flag --iso"),
        (["a.nrrd", "b.vtp", "--isovalue"], "--isovalue has no value"),
        (["--coarse=1", "a.nrrd", "b.vtp"], "--coarse takes no value"),
        (["--isovalue", "1", "--isovalue", "2", "a.nrrd", "b.vtp"], "--isovalue is given twice"),
        (["-", "b.vtp"], "a module has no standard streams"),
        (["---", "b.vtp"], "unknown flag"),
        (["a.nrrd", "a.nrrd"], "a.nrrd"),
    ],
)
def test_wrong_command_lines(tmp_path, words, message):
    done = run_words(*words, folder=tmp_path)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert message in done.stderr


def test_a_copy_of_the_script_finds_the_tool_on_the_path(tmp_path):
    copy = tmp_path / "Module"
    shutil.copy(MODULE, copy)
    folder = tmp_path / "bin"
    folder.mkdir()
    (folder / "isoatlas").symlink_to(TOOL)
    done = subprocess.run(
        [copy, "--version"],
        capture_output=True,
        text=True,
        env={**os.environ, "PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"},
    )
    assert done.returncode == 0 and done.stdout.startswith("isoatlas ")


# ------------------------------------------------------------------------------------ real data


def real(name):
    if not (DATA / name).is_file():
        pytest.skip(f"no {DATA / name}; set ISOATLAS_TEST_DATA to the folder of volumes")
    return isoatlas.read(DATA / name)


def test_head_as_slicer_passes_it(module, tmp_path):
    """A CT whose axes are turned, written in LPS: the mesh is where that of the file is."""
    volume = real("ct_head_rotated.nrrd")
    write_volume(tmp_path / VOLUME, volume, volume.array.astype(np.int16))
    run = Run(module, tmp_path, isovalue=1150.5, keepComponents=1, maxDistance="1vx")
    assert run.status == 0 and run.errors == ""
    vertices, faces, space = read_model(run.model)
    theirs = isoatlas.extract(volume, 1150.5, keep_components=1, max_distance="1vx")
    assert space == "LPS" and np.allclose(vertices, theirs.vertices, atol=1e-6)
    assert np.array_equal(faces, theirs.faces)


def test_segments_as_slicer_passes_them(module, tmp_path):
    volume = real("labels/aseg.mgz")
    write_volume(tmp_path / VOLUME, volume, volume.array.astype(np.int32))
    ventricle = 4
    run = Run(module, tmp_path, label=ventricle, maxDistance="1vx", keepComponents=1)
    assert run.status == 0, run.errors
    vertices, faces, _ = read_model(run.model)
    count = np.count_nonzero(volume.array == ventricle)
    assert enclosed(vertices, faces) == pytest.approx(count * np.prod(volume.spacing), rel=0.15)
