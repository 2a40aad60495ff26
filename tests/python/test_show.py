# SPDX-License-Identifier: Apache-2.0
"""The page: to_html(), save("x.html"), show(), and meshes in notebooks."""

import html
import json
import pathlib
import re
import subprocess
import sys
import types
import webbrowser

import numpy as np
import pytest

import isoatlas
from conftest import SAMPLES, torus
from isoatlas import _html

REFINE = [{"max_distance": "1vx"}, {"max_distance": "0.5vx"}]
MESH = isoatlas.extract(torus(), 0.0, order="ijk", refine=REFINE)


def data_of(page):
    """The JSON data of a page."""
    text = re.search(r'<script type="application/json" id="isoatlas-data">(.*?)</script>', page)
    return json.loads(text[1])


def page_in(output):
    """The page in the output of a notebook."""
    return html.unescape(re.search(r'<iframe srcdoc="([^"]*)"', output)[1])


def level_sizes(page):
    (result,) = data_of(page)["results"]
    sizes = [(level["vertices"], level["triangles"]) for level in result["levels"]]
    encoded = result["geometry"]["levels"]
    assert sizes == [(level["vertices"], level["triangles"]["count"]) for level in encoded]
    return sizes


SIZES = [(len(level.vertices), len(level.faces)) for level in MESH.levels]


def test_page_has_all_levels_and_loads_nothing():
    page = MESH.to_html()
    assert page.startswith("<!doctype html>") and level_sizes(page) == SIZES
    (result,) = data_of(page)["results"]
    assert result["title"] == "array at 0" and result["marching_cubes"] is None
    assert result["levels"][-1]["metrics"]["max-distance"]["maximum"] <= 0.5
    assert not re.search(r'(?:src|href)="(?!data:)', page)
    assert page == MESH.to_html()


def test_save_writes_the_same_page(tmp_path):
    MESH.save(tmp_path / "m.HTML", report=tmp_path / "m.json")
    assert (tmp_path / "m.HTML").read_text() == MESH.to_html()
    report = json.loads((tmp_path / "m.json").read_text())
    assert len(report["levels"]) == 3 and report["files"] == []


def test_page_of_a_file(tmp_path, tool):
    MESH.save(tmp_path / "m.glb")
    again = isoatlas.read_mesh(tmp_path / "m.glb")
    assert level_sizes(again.to_html()) == SIZES
    tool("report", tmp_path / "m.glb", "-o", tmp_path / "tool.html")
    ours = data_of(again.to_html())["results"][0]
    theirs = data_of((tmp_path / "tool.html").read_text())["results"][0]
    assert (ours.pop("title"), theirs.pop("title")) == ("mesh", "m.glb")
    assert ours == theirs


def test_page_of_a_volume_is_that_of_the_command_line(tool, tmp_path):
    volume = SAMPLES / "protein_iron.nhdr"
    tool("extract", volume, "--iso", "100", "-q", "-o", tmp_path / "m.ply",
         "--html", tmp_path / "tool.html")  # fmt: skip
    (theirs,) = data_of((tmp_path / "tool.html").read_text())["results"]
    (ours,) = data_of(isoatlas.extract(isoatlas.read(volume), 100).to_html())["results"]
    assert theirs["marching_cubes"]["triangles"] > 0
    for only_there in ("marching_cubes", "command"):
        assert ours.pop(only_there) is None and theirs.pop(only_there) is not None
    assert ours == theirs


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("m-{level}.html", {}, "a page shows all levels"),
        ("m.html", {"glb_per_level": True}, "glb_per_level: expected it with NAME.glb"),
        ("m.html", {"report": "m.html"}, "the report would replace the page"),
        ("none/m.html", {}, "none"),
    ],
)
def test_bad_names_write_nothing(name, options, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(isoatlas.Error, match=message):
        MESH.save(name, **options)
    assert list(tmp_path.iterdir()) == []


def test_page_replaces_no_volume(tmp_path):
    path = tmp_path / "volume.html"  # the content decides the format
    np.save(tmp_path / "v.npy", torus())
    path.write_bytes((tmp_path / "v.npy").read_bytes())
    mesh = isoatlas.extract(isoatlas.read_volume(path, spacing=(1, 1, 1)), 0.0, coarse=True)
    with pytest.raises(isoatlas.BadArgumentError, match="would replace the volume"):
        mesh.save(path)


def test_show_opens_the_browser(monkeypatch, tmp_path):
    opened = []
    monkeypatch.setattr(webbrowser, "open", lambda address: opened.append(address) or True)
    file = MESH.show()
    assert opened == [file.as_uri()] and file.read_text() == MESH.to_html()
    assert MESH.show() != file
    assert MESH.show(tmp_path / "m.html") == tmp_path / "m.html"
    assert (tmp_path / "m.html").read_text() == MESH.to_html()
    with pytest.raises(isoatlas.BadArgumentError, match="ends in .html"):
        MESH.show(tmp_path / "m.txt")


def test_show_without_a_browser_names_the_file(monkeypatch):
    monkeypatch.setattr(webbrowser, "open", lambda address: False)
    with pytest.warns(RuntimeWarning, match="no browser could be opened; the page is /.*html") as w:
        MESH.show()
    assert w[0].filename == __file__


def test_show_in_a_notebook(monkeypatch):
    shown = []
    shell = types.SimpleNamespace(kernel=object())
    fake = types.ModuleType("IPython")
    fake.get_ipython = lambda: shell
    fake.display = types.ModuleType("IPython.display")
    fake.display.display = shown.append
    monkeypatch.setitem(sys.modules, "IPython", fake)
    monkeypatch.setitem(sys.modules, "IPython.display", fake.display)
    monkeypatch.setattr(webbrowser, "open", lambda address: pytest.fail("opened a browser"))
    assert MESH.show() is None and shown == [MESH]
    del shell.kernel  # IPython in a terminal
    monkeypatch.setattr(webbrowser, "open", lambda address: True)
    assert isinstance(MESH.show(), pathlib.Path)


def test_notebooks_show_the_page_in_a_frame():
    output = MESH._repr_html_()
    assert len(output) < 5_000_000 and "&lt;isoatlas.Mesh: " in output
    assert output.isascii() and not MESH.to_html().isascii()
    assert page_in(output) == MESH.to_html()
    frame = output[output.index("<iframe") :]
    assert "allow-scripts" in frame and "allow-same-origin" not in frame


@pytest.mark.parametrize(("shown", "text"), [(2, "the finest 1 of 3"), (1, "the finest 2 of 3")])
def test_large_meshes_show_coarse_levels(shown, text, monkeypatch):
    most = max(len(_html._frame(MESH._core.page(k))) for k in range(1, shown + 1))
    monkeypatch.setattr(_html, "NOTEBOOK_BYTES", most)
    output = MESH._repr_html_()
    assert level_sizes(page_in(output)) == SIZES[:shown]
    assert text in output and "mesh.show(" in output


def test_meshes_too_large_for_a_notebook(monkeypatch):
    monkeypatch.setattr(_html, "NOTEBOOK_BYTES", 1000)
    output = MESH._repr_html_()
    assert "Too large for a notebook" in output and "<iframe" not in output


def test_notebooks_without_pages_show_the_text():
    def page(level_count):
        raise isoatlas.UnsupportedError("built without pages")

    assert _html.for_notebook("<isoatlas.Mesh>", 1, page, [4]) == (
        "<div><code>&lt;isoatlas.Mesh&gt;</code></div>"
    )


def test_pages_of_balanced_levels():
    mesh = isoatlas.extract(torus(), 0.0, placement="balanced", refine=REFINE)
    sizes = [(len(level.vertices), len(level.faces)) for level in mesh.levels]
    for count in (1, 2, 3):
        assert level_sizes(mesh._core.page(count)) == sizes[:count]


IMPORTS = """
import sys
import numpy
before = set(sys.modules)
import isoatlas
print(*sorted({name.split(".")[0] for name in set(sys.modules) - before}))
"""


def test_import_loads_nothing_heavy():
    run = subprocess.run([sys.executable, "-c", IMPORTS], capture_output=True, text=True)
    loaded = set(run.stdout.split())
    assert "isoatlas" in loaded
    heavy = {"IPython", "pyvista", "scipy", "tempfile", "tqdm", "trimesh", "vtkmodules"}
    assert not loaded & (heavy | {"webbrowser"})
