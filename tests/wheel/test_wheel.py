# SPDX-License-Identifier: Apache-2.0
"""Builds the wheel for this interpreter, installs it into a new environment and uses it there.

The environment has the current versions of the packages in requirements.txt, from PyPI.
"""

import json
import os
import pathlib
import re
import shutil
import stat
import subprocess
import sys
import tarfile
import zipfile

import pytest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WORK = ROOT / "build" / "wheel-work"
TAG = "cp%d%d" % sys.version_info[:2]
PROTEIN = ROOT / "samples" / "protein_iron.nhdr"
LARGEST = 60e6  # bytes
# Libraries of the system. The manylinux policies list all but the last four, which belong to its
# graphics driver; only what draws pictures may need these and X11.
SYSTEM = {"ld-linux-x86-64.so.2", "libc.so.6", "libgcc_s.so.1", "libm.so.6", "libstdc++.so.6",
          "libz.so.1"}
GRAPHICS = {"libX11.so.6", "libGL.so.1", "libGLX.so.0", "libOpenGL.so.0"}


def environment(**more):
    """Without the variables with which the other tests find the module of the build folder."""
    return {key: value for key, value in os.environ.items()
            if key not in ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE")} | more


def run(*command, status=0, **options):
    options.setdefault("env", environment())
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **options)
    assert done.returncode == status, done.stdout[-6000:] + done.stderr[-6000:]
    return done


@pytest.fixture(scope="session", autouse=True)
def network(tmp_path_factory):
    download = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--retries", "1",
                "--dest", tmp_path_factory.mktemp("download"), "wheel"]
    if subprocess.run(download, capture_output=True).returncode != 0:
        pytest.skip("PyPI cannot be reached")


@pytest.fixture(scope="session")
def wheel(network):
    # With the compiler's flags of the main build, ccache finds its results.
    build = environment(CMAKE_ARGS="-DISOATLAS_WARNINGS_AS_ERRORS=ON")
    run(ROOT / "scripts/build_wheel.sh", sys.executable, cwd=ROOT, env=build)
    return max((ROOT / "build/wheels").glob(f"isoatlas-*-{TAG}-*.whl"),
               key=lambda path: path.stat().st_mtime)


@pytest.fixture(scope="session")
def contents(wheel, tmp_path_factory):
    folder = tmp_path_factory.mktemp("contents")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


@pytest.fixture(scope="session")
def venv(wheel):
    """The folder with the programs of an environment with the wheel and the current packages."""
    folder = WORK / f"test-{TAG}"
    wanted = (HERE / "requirements.txt").read_text()
    installed = folder / "installed.txt"
    if not installed.is_file() or installed.read_text() != wanted:
        run(sys.executable, "-m", "venv", "--clear", folder)
        # Python compiles the few modules that the tests use when it imports them.
        install = [folder / "bin/pip", "install", "-q", "--no-compile"]
        run(*install, "-r", HERE / "requirements.txt")
        installed.write_text(wanted)
    run(folder / "bin/pip", "install", "-q", "--no-deps", "--force-reinstall", wheel)
    return folder / "bin"


# ----------------------------------------------------------------------------------- the file


def test_name_and_size(wheel):
    assert re.fullmatch(rf"isoatlas-[\d.]+-{TAG}-{TAG}-manylinux_2_(3[0-6])_x86_64\.whl",
                        wheel.name)
    assert wheel.stat().st_size <= LARGEST


def test_files(wheel, contents):
    with zipfile.ZipFile(wheel) as archive:
        modes = {it.filename: it.external_attr >> 16 for it in archive.infolist()}
    for name in ("isoatlas/_tool/bin/isoatlas", "isoatlas/_tool/slicer/IsoAtlas"):
        assert modes[name] & stat.S_IXUSR, name
    for name in ("_isoatlas_tool.py", "isoatlas/__main__.py", "isoatlas/py.typed",
                 "isoatlas/_core.pyi", "isoatlas/paraview_plugin.py",
                 "isoatlas/napari/napari.yaml", "isoatlas/samples/embryo.nrrd",
                 "isoatlas/samples/protein_iron.raw", "isoatlas/samples/LICENSE-samples.txt",
                 "isoatlas/_tool/lib/isoatlas/isoatlas_picture.so"):
        assert name in modes, name
    tops = {name.split("/")[0] for name in modes}
    (info,) = (top for top in tops if top.endswith(".dist-info"))
    assert tops == {"isoatlas", "isoatlas.libs", "_isoatlas_tool.py", info}
    metadata = (contents / info / "METADATA").read_text()
    needs = re.findall(r"(?m)^Requires-Dist: ((?:(?!extra ==).)*)$", metadata)
    assert needs == ["numpy>=1.20"]


def elf_files(folder):
    return [path for path in folder.rglob("*")
            if path.is_file() and path.read_bytes()[:4] == b"\x7fELF"]


def dynamic_section(path):
    printed = run("readelf", "-d", path).stdout
    return (set(re.findall(r"\(NEEDED\).*\[(.*)\]", printed)),
            re.findall(r"\((?:RPATH|RUNPATH)\).*\[(.*)\]", printed))


def test_needs_only_libraries_of_every_linux(contents):
    own = {path.name for path in (contents / "isoatlas.libs").iterdir()}
    draws = set()
    for path in elf_files(contents):
        needed, run_paths = dynamic_section(path)
        beyond = needed - own - SYSTEM
        assert beyond <= GRAPHICS, (path.name, beyond)
        draws |= {path.name} if beyond else set()
        assert all(it.startswith("$ORIGIN") for it in run_paths), (path.name, run_paths)
    for name in draws:
        assert re.match(r"isoatlas_picture\.so|libvtkRendering|libGLEW", name), name


def test_licences_of_all_libraries(contents):
    (folder,) = contents.glob("isoatlas-*.dist-info/licenses")
    table = (folder / "LIBRARIES.txt").read_text()
    for path in (contents / "isoatlas.libs").iterdir():
        name = re.sub(r"-[0-9a-f]{8}(?=\.)", "", path.name, count=1)
        if not name.startswith("libjbig"):
            assert name in table
        else:
            assert b"JBIG is not supported in this build of isoatlas" in path.read_bytes()
    packages = re.findall(r"(?m)^lib\S+ +(\S+) ", table)
    assert len(packages) > 20
    for package in packages:
        assert (folder / "libraries" / f"{package}.txt").stat().st_size > 500
    assert " GPL" not in table


def test_source_distribution_has_all_sources(wheel):
    source = max((ROOT / "build/wheels").glob("isoatlas-*.tar.gz"),
                 key=lambda path: path.stat().st_mtime)
    with tarfile.open(source) as archive:
        names = {name.split("/", 1)[1] for name in archive.getnames() if "/" in name}
    options = "-z --cached --others --exclude-standard".split()
    folders = "apps cmake include python samples src web CMakeLists.txt setup.py LICENSE".split()
    try:
        tracked = run("git", "-C", ROOT, "ls-files", *options, *folders).stdout.split("\0")
    except (AssertionError, FileNotFoundError):
        pytest.skip("not a git repository")
    missing = {name for name in tracked
               if name and (ROOT / name).is_file() and not name.endswith(".gitignore")} - names
    assert not missing
    assert not [name for name in names if "node_modules" in name or name.endswith(".so")]


# ------------------------------------------------------------------------------------ the tool


def test_the_tool_of_the_wheel(venv, tmp_path):
    version = run(venv / "isoatlas", "--version").stdout
    assert re.fullmatch(r"isoatlas [\d.]+\n", version)
    assert run(venv / "python", "-m", "isoatlas", "--version").stdout == version
    options = ["--iso", "100", "-q", "--html", tmp_path / "m.html", "-o", tmp_path / "m.vtp"]
    run(venv / "isoatlas", "extract", PROTEIN, *options)
    assert "isoatlas-geometry" in (tmp_path / "m.html").read_text()
    assert "genus 8" in run(venv / "isoatlas", "check", tmp_path / "m.vtp").stdout
    refused = run(venv / "isoatlas", "extract", PROTEIN, "--iso", "1e9", "-o", tmp_path / "n.ply",
                  status=2)
    assert refused.stderr.startswith("isoatlas: error:")


def test_same_bytes_as_the_tool_of_the_build_folder(venv, tmp_path):
    tool = os.environ.get("ISOATLAS_TOOL")
    if not tool:
        pytest.skip("set ISOATLAS_TOOL to the path of the command line tool")
    for program, name in ((venv / "isoatlas", "a"), (tool, "b")):
        for extension in ("glb", "3mf", "vtp"):
            run(program, "extract", PROTEIN, "--iso", "100", "-q", "-o",
                tmp_path / f"{name}.{extension}")
    for extension in ("glb", "3mf", "vtp"):
        ours, theirs = (tmp_path / f"{name}.{extension}" for name in "ab")
        assert ours.read_bytes() == theirs.read_bytes(), extension


@pytest.mark.skipif(not (os.environ.get("DISPLAY") or shutil.which("Xvfb")),
                    reason="no X display and no Xvfb")
def test_the_tool_of_the_wheel_draws(venv, tmp_path):
    run(venv / "isoatlas", "extract", PROTEIN, "--iso", "100", "-q", "-o", tmp_path / "m.glb")
    run(venv / "isoatlas", "picture", tmp_path / "m.glb", "-q", "-o", tmp_path / "m.png")
    assert (tmp_path / "m.png").stat().st_size > 10_000


def test_the_tool_starts_without_numpy(venv, tmp_path):
    (tmp_path / "numpy.py").write_text("raise SystemExit('numpy was imported')")
    alone = environment(PYTHONPATH=str(tmp_path))
    assert run(venv / "isoatlas", "--version", env=alone).stdout.startswith("isoatlas ")
    run(venv / "python", "-c", "import isoatlas", env=alone, status=1)


def test_the_tool_ends_when_its_reader_does(venv):
    """By SIGPIPE, which Python ignores."""
    command = f"'{venv / 'isoatlas'}' completion zsh | true; echo ${{PIPESTATUS[0]}}"
    for _ in range(20):
        printed = run("bash", "-c", command).stdout
        assert printed in ("141\n", "0\n")  # 0: it was faster than `true`
    big = f"'{venv / 'isoatlas'}' completion zsh > /dev/full"
    assert subprocess.run(["bash", "-c", big], capture_output=True).returncode != 0


def test_module_of_slicer(venv, contents):
    module = contents / "isoatlas/_tool/slicer/IsoAtlas"
    module.chmod(0o755)
    (contents / "isoatlas/_tool/bin/isoatlas").chmod(0o755)
    assert "<executable>" in run(module, "--xml").stdout


# ---------------------------------------------------------------------------------- the module


def test_current_packages(venv, tmp_path):
    done = run(venv / "python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-rs",
               HERE / "current_packages_test.py", cwd=tmp_path)
    assert "skipped" not in done.stdout


# They need nothing of the build folder.
MODULE_TESTS = ("arrays", "conversions", "examples", "marching_cubes", "pickle", "pyvista", "show")


def test_tests_of_the_module(venv, tmp_path):
    """The tests of the build folder's module, with the wheel and the current packages."""
    files = [ROOT / "tests/python" / f"test_{name}.py" for name in MODULE_TESTS]
    done = run(venv / "python", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-rs",
               "-c", ROOT / "pyproject.toml", *files, cwd=tmp_path,
               env=environment(ISOATLAS_TOOL=str(venv / "isoatlas")))
    for package in ("numpy", "pyvista", "VTK", "trimesh", "skimage", "scikit-image"):
        assert f"{package} is not installed" not in done.stdout


USER_PROGRAM = """
import numpy as np
import numpy.typing as npt

import isoatlas


def largest(array: npt.NDArray[np.uint8], iso: float) -> tuple[float, int]:
    mesh = isoatlas.extract(array, iso, max_distance="0.5vx", keep_components=1, order="xyz")
    component: isoatlas.Component = mesh.components[0]
    return component.area, mesh.levels[-1].faces.shape[0]


volume: isoatlas.Volume = isoatlas.examples.load_protein()
print(largest(volume.array, 100))
"""
WRONG = "\nreveal: str = isoatlas.extract(volume, 100)\nisoatlas.extract(volume, iso_value=1)\n"


def test_mypy_checks_programs_of_users(venv, tmp_path):
    (tmp_path / "program.py").write_text(USER_PROGRAM)
    (tmp_path / "wrong.py").write_text(USER_PROGRAM + WRONG)
    mypy = [venv / "mypy", "--strict", "--python-executable", venv / "python"]
    found = run(*mypy, "program.py", "wrong.py", cwd=tmp_path, status=1).stdout
    errors = [line for line in found.splitlines() if ": error: " in line]
    assert len(errors) == 2 and all(line.startswith("wrong.py:") for line in errors), found
    assert "Incompatible types in assignment" in errors[0] and '"iso_value"' in errors[1]
    run(*mypy, "-m", "isoatlas._core", cwd=tmp_path)  # the stubs of the extension


def test_pyright_checks_programs_of_users(venv, tmp_path):
    (tmp_path / "program.py").write_text(USER_PROGRAM)
    (tmp_path / "wrong.py").write_text(USER_PROGRAM + WRONG)
    configuration = {"typeCheckingMode": "strict", "reportUnknownMemberType": False,
                     "reportUnknownVariableType": False, "reportUnknownArgumentType": False}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(configuration))
    pyright = [venv / "pyright", "--pythonpath", venv / "python", "--outputjson"]
    printed = run(*pyright, "program.py", "wrong.py", cwd=tmp_path, status=1).stdout
    found = [it for it in json.loads(printed)["generalDiagnostics"] if it["severity"] == "error"]
    assert {pathlib.Path(it["file"]).name for it in found} == {"wrong.py"}, found
    assert "reportAssignmentType" in [it["rule"] for it in found]
    assert any("iso_value" in it["message"] for it in found)
