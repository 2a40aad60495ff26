# SPDX-License-Identifier: Apache-2.0
"""Installs the module from a fresh copy of the sources, as in docs/python.md, and by CMake.

Both work without a network, except that npm downloads the libraries of the page.
"""

import os
import subprocess
import sys

import pytest

from conftest import ROOT
from test_documentation import PAGE, snippets

TRY = """
import isoatlas, sys
mesh = isoatlas.extract(isoatlas.read(sys.argv[1]), 100, coarse=True)
assert mesh.report["version"] == isoatlas.__version__
example = isoatlas.examples.load_protein()
assert isoatlas.extract(example, 100, coarse=True).volume == mesh.volume
assert "isoatlas-geometry" in mesh.to_html()
print(isoatlas.__file__, mesh)
"""


def environment(**more):
    return {
        key: value
        for key, value in os.environ.items()
        if key not in ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE")
    } | more


def run(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


@pytest.fixture
def sources(tmp_path):
    """A copy of all files that git tracks or would add."""
    options = "-z --cached --others --exclude-standard".split()
    try:
        files = run("git", "-C", ROOT, "ls-files", *options).split("\0")
    except (AssertionError, FileNotFoundError):
        pytest.skip("not a git repository")
    copy = tmp_path / "sources"
    for name in files:
        if name and (ROOT / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_bytes((ROOT / name).read_bytes())
            (copy / name).chmod((ROOT / name).stat().st_mode)
    return copy


def test_pip(sources, tmp_path):
    ((_, _, commands),) = [block for block in snippets(PAGE) if block[0] == "sh"]
    # The first command installs what the build needs; the test machine has it.
    _, *lines = commands.strip().splitlines()
    script = "\n".join(lines).replace("python3 ", f"{sys.executable} ", 1)
    # With the flags, the folders and the ccache of scripts/test.sh, little is left to compile.
    # tests/wheel tests the command-line tool in the package.
    build = environment(
        CMAKE_ARGS="-DISOATLAS_WARNINGS_AS_ERRORS=ON -DISOATLAS_BUILD_TOOL=OFF",
        CMAKE_BUILD_PARALLEL_LEVEL="2",
        ISOATLAS_CMAKE_FOLDER=str(sources / "build" / "release"),
        CCACHE_BASEDIR=str(sources),
    )
    run("bash", "-euc", script, cwd=sources, env=build)
    command = [sources / "venv/bin/python", "-c", TRY, ROOT / "samples/protein_iron.nhdr"]
    printed = run(*command, cwd=tmp_path, env=environment())
    assert str(sources / "venv") in printed and "genus 8" in printed
    files = run(sources / "venv/bin/pip", "show", "-f", "isoatlas", cwd=tmp_path, env=environment())
    samples = ["samples/embryo.nrrd", "samples/protein_iron.raw", "samples/LICENSE-samples.txt"]
    for name in ("py.typed", "_core.pyi", "_core.cpython", "errors.py", "pyvista.py", *samples):
        assert f"isoatlas/{name}" in files
    refused = subprocess.run(
        [sources / "venv/bin/isoatlas"], capture_output=True, text=True, env=environment()
    )
    assert refused.returncode == 2 and "without the command-line tool" in refused.stderr


def test_cmake(tmp_path):
    build = os.environ.get("ISOATLAS_BUILD")
    if not build:
        pytest.skip("set ISOATLAS_BUILD to the build folder")
    run("cmake", "--install", build, "--prefix", tmp_path, "--component", "python")
    (package,) = tmp_path.glob("lib/python3*/*-packages/isoatlas")
    command = [sys.executable, "-c", TRY, ROOT / "samples/protein_iron.nhdr"]
    printed = run(*command, cwd="/", env=environment(PYTHONPATH=str(package.parent)))
    assert str(package) in printed
    assert (package / "py.typed").is_file() and (package / "_core.pyi").is_file()


LOAD_WITH_NUMPY_2 = """
import importlib.util, sys, types
numpy = sys.modules["numpy"] = types.ModuleType("numpy")
numpy.__version__ = "2.1.0"
specification = importlib.util.spec_from_file_location("_core", sys.argv[1])
try:
    importlib.util.module_from_spec(specification)
    print("loaded")
except ImportError as error:
    print(error)
"""


def test_numpy_2_is_refused_by_an_old_pybind11():
    import isoatlas._core

    printed = run(sys.executable, "-c", LOAD_WITH_NUMPY_2, isoatlas._core.__file__)
    if printed == "loaded\n":
        pytest.skip("the module was built with a pybind11 that supports NumPy 2")
    assert "supports only NumPy 1, and this is NumPy 2.1.0; install numpy<2" in printed
