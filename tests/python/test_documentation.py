# SPDX-License-Identifier: Apache-2.0
"""Runs the snippets of docs/python.md and README.md, in order and in one folder per page."""

import builtins
import importlib.util
import os
import re
import subprocess
import webbrowser

import numpy as np
import pytest

import isoatlas
from conftest import ROOT, torus

PAGE = (ROOT / "docs" / "python.md").read_text()
README = (ROOT / "README.md").read_text()


def snippets(text):
    """(language, required package, code) of each block that states a language."""
    return [
        tuple(block)
        for block in re.findall(r"^```(python|sh)(?: (\S+))?\n(.*?)^```$", text, re.M | re.S)
    ]


def write_scan(folder):
    """Write the scan.nii.gz of the pages: a torus, and a ball that is not connected to it."""
    samples = np.maximum(
        torus((44, 22, 14)),
        (1.4 - np.linalg.norm(np.indices((44, 22, 14)).T - (36.2, 9.8, 7.1), axis=-1)).T,
    )
    import gzip
    import struct

    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, 44, 22, 14, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 16, 32)  # float32
    struct.pack_into("<8f", header, 76, 1, 1, 1, 1.5, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352)
    struct.pack_into("<f", header, 112, 1)
    struct.pack_into("<hh", header, 252, 0, 1)  # sform
    struct.pack_into("<12f", header, 280, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1.5, 0)
    header[344:348] = b"n+1\0"
    with gzip.open(folder / "scan.nii.gz", "wb") as file:
        file.write(bytes(header) + (300.5 + 100 * samples).astype("<f4").tobytes(order="F"))


def run(page, tmp_path, monkeypatch):
    write_scan(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(webbrowser, "open", lambda address: True)
    names, ran = {}, 0
    for language, needs, code in page:
        if language != "python" or (
            needs and importlib.util.find_spec({"vtk": "vtkmodules"}.get(needs, needs)) is None
        ):
            continue
        exec(compile(code, f"snippet {ran}: {code.splitlines()[0]}", "exec"), names)
        ran += 1
    return names, ran


def test_every_snippet_of_the_page_runs(tmp_path, monkeypatch, capsys):
    blocks = snippets(PAGE)
    names, ran = run(blocks, tmp_path, monkeypatch)
    assert ran >= sum(language == "python" and not needs for language, needs, _ in blocks) >= 8
    printed = capsys.readouterr().out
    for text in ("2 components", "empty_surface", "level 1: max_vertices 50: reached"):
        assert text in printed
    assert "order: expected it with this spacing: order='ijk'" in printed
    for file in ("bone.stl", "bone.json", "bone.html", "print.stl", "field.glb"):
        assert (tmp_path / file).stat().st_size > 0
    assert len(names["mesh"].faces) > 0


def test_readme_snippets_run(tmp_path, monkeypatch, capsys):
    blocks = snippets(README)
    assert any(language == "python" for language, _, _ in blocks)
    # A small volume stands in for the embryo, which takes half a minute.
    monkeypatch.setattr(isoatlas.examples, "load_embryo", lambda: isoatlas.Volume(50.5 + torus()))
    run(blocks, tmp_path, monkeypatch)


def test_example_of_the_package_docstring_runs(tmp_path, monkeypatch):
    code = "\n".join(
        line.strip()[4:]
        for line in isoatlas.__doc__.splitlines()
        if line.strip().startswith(">>> ")
    )
    run([("python", "", code)], tmp_path, monkeypatch)
    assert (tmp_path / "bone.ply").is_file()


def test_install_commands_are_tested():
    ((_, _, commands),) = [block for block in snippets(PAGE) if block[0] == "sh"]
    test = (ROOT / "tests" / "python" / "test_install.py").read_text()
    script = (ROOT / "scripts" / "install_dependencies.sh").read_text()
    assert "snippets(PAGE)" in test  # test_install.py runs all commands except the first
    first, *_ = commands.strip().splitlines()
    assert first == "scripts/install_dependencies.sh python" and "python) wanted" in script
    path = ROOT / "scripts" / "install_dependencies.sh"
    assert subprocess.run(["bash", "-n", path]).returncode == 0
    assert os.access(path, os.X_OK)


def test_table_of_errors_matches_the_classes():
    rows = re.findall(r"^\| `(\w+)` \| `(\w+)` \| `(\w+)` \|", PAGE, re.M)
    assert len(rows) == 6
    for name, base, code in rows:
        cls = getattr(isoatlas, name)
        assert issubclass(cls, getattr(builtins, base)) and cls.code == code


@pytest.mark.parametrize("link", sorted(set(re.findall(r"\]\(([^)#]+)", PAGE))))
def test_links_exist(link):
    assert (ROOT / "docs" / link).exists()
