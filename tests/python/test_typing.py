# SPDX-License-Identifier: Apache-2.0
"""Types and docstrings."""

import inspect
import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

import isoatlas
from conftest import ROOT


@pytest.mark.parametrize(
    "what", [ROOT / "python" / "isoatlas", pathlib.Path(__file__).with_name("usage_for_mypy.py")]
)
def test_mypy_finds_no_errors(what, tmp_path):
    mypy = shutil.which("mypy")
    if mypy is None:
        pytest.skip("mypy is not installed")
    files = ["--config-file", ROOT / "pyproject.toml", "--cache-dir", tmp_path, what]
    environment = {**os.environ, "MYPYPATH": str(ROOT / "python"), "PYTHONPATH": ""}
    run = subprocess.run(
        [mypy, "--strict", "--warn-unused-ignores", *files],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=environment,
    )
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize(
    "what", [ROOT / "python" / "isoatlas", pathlib.Path(__file__).with_name("usage_for_mypy.py")]
)
def test_pyright_finds_no_errors(what, tmp_path):
    """Pyright is not in Debian: PyPI and npm have it."""
    folder = os.path.dirname(sys.executable)
    pyright = shutil.which("pyright") or shutil.which("pyright", path=folder)
    if pyright is None:
        pytest.skip("pyright is not installed")
    configuration = {
        "include": [os.path.relpath(what, tmp_path)],
        "extraPaths": [str(ROOT / "python")],
        "pythonVersion": "3.9",
        "reportMissingImports": "none",  # packages that a user may have
        "reportMissingModuleSource": "none",
    }
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(configuration))
    command = [pyright, "-p", tmp_path, "--pythonpath", sys.executable, "--outputjson"]
    found = json.loads(subprocess.run(command, capture_output=True, text=True).stdout)
    assert found["summary"]["filesAnalyzed"] > 0
    errors = [f"{it['file']}: {it['message']}" for it in found["generalDiagnostics"]]
    assert not errors, "\n".join(errors)


def public():
    for name in isoatlas.__all__:
        it = getattr(isoatlas, name)
        if not name.startswith("_"):
            yield name, it
        if inspect.isclass(it):
            for member, value in vars(it).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    yield f"{name}.{member}", value


@pytest.mark.parametrize(("name", "it"), list(public()))
def test_public_names_have_docstrings(name, it):
    assert it.__doc__ and len(it.__doc__.strip()) > 10


@pytest.mark.parametrize(
    "function", [isoatlas.extract, isoatlas.check, isoatlas.marching_cubes, isoatlas.read_volume]
)
def test_docstrings_describe_each_parameter(function):
    text = function.__doc__.split("Parameters\n")[1].split("Returns\n")[0]
    named = {
        name.strip()
        for line in text.splitlines()
        if line.startswith("    ") and not line.startswith("     ")
        for name in line.split(" :")[0].split(",")
    }
    missing = [
        name
        for name in inspect.signature(function).parameters
        if name not in named and f"``{name}``" not in function.__doc__
    ]
    assert missing == []


def test_docstrings_of_submodules():
    for module in (isoatlas.examples,):
        assert module.__doc__
        for name in module.__all__:
            assert getattr(module, name).__doc__, name


def test_stub_has_all_names_of_the_extension():
    from isoatlas import _core

    stub = (ROOT / "python" / "isoatlas" / "_core.pyi").read_text()
    for name in vars(_core):
        if not name.startswith("__"):
            assert f"def {name}(" in stub or f"class {name}:" in stub, name
    for name in vars(_core.Levels):
        if not name.startswith(("__", "_pybind")):
            assert f"def {name}(" in stub, name
