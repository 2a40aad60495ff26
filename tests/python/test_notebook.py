# SPDX-License-Identifier: Apache-2.0
"""Runs the notebooks of the documentation and compares the output with the kept one."""

import importlib.util
import json

import pytest

from conftest import ROOT

specification = importlib.util.spec_from_file_location(
    "run_notebooks", ROOT / "scripts" / "run_notebooks.py"
)
run_notebooks = importlib.util.module_from_spec(specification)
specification.loader.exec_module(run_notebooks)
PATHS = sorted(run_notebooks.NOTEBOOKS.glob("*.ipynb"))


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_output_is_the_kept_one(path):
    if not run_notebooks.is_possible():
        pytest.skip("nbclient or ipykernel is not installed")
    kept, new = json.loads(path.read_text()), run_notebooks.executed(path)
    problems = run_notebooks.differences(kept, new)
    assert not problems, "\n".join([*problems, "scripts/run_notebooks.py --update"])
    pages = [
        output["data"]["text/html"]
        for cell in new["cells"]
        for output in cell.get("outputs", ())
        if "text/html" in output.get("data", {})
    ]
    assert len(pages) == 2
    for page in pages:
        assert "<iframe srcdoc=" in "".join(page) and len("".join(page)) < 5_000_000


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_kept_notebooks_are_small_and_complete(path):
    assert path.stat().st_size < 20_000
    kept = json.loads(path.read_text())
    assert path.read_text() == run_notebooks.written(run_notebooks.without_pages(kept))
    for cell in kept["cells"]:
        if cell["cell_type"] == "code":
            assert cell["execution_count"] is not None
            assert cell["outputs"] or "".join(cell["source"]).endswith("pass")


def test_finds_outdated_output():
    cell = {"outputs": [{"output_type": "stream", "name": "stdout", "text": ["3 faces\n"]}]}
    other = {"outputs": [{"output_type": "execute_result", "data": {"text/plain": ["4 faces"]}}]}
    one, two = {"cells": [{"cell_type": "markdown"}, cell]}, {"cells": [{}, other]}
    assert run_notebooks.differences(one, one) == []
    assert len(run_notebooks.differences(one, two)) == 1


def test_a_notebook_with_an_error_fails(tmp_path):
    if not run_notebooks.is_possible():
        pytest.skip("nbclient or ipykernel is not installed")
    import nbclient

    notebook = json.loads(PATHS[0].read_text())
    notebook["cells"] = [{**notebook["cells"][1], "source": ["raise RuntimeError('no')"]}]
    (tmp_path / "n.ipynb").write_text(json.dumps(notebook))
    with pytest.raises(nbclient.exceptions.CellExecutionError, match="RuntimeError"):
        run_notebooks.executed(tmp_path / "n.ipynb")
