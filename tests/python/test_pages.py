# SPDX-License-Identifier: Apache-2.0
"""Runs all commands and snippets of the tutorial pages and compares the output with the page."""

import importlib.util
import os
import pathlib
import shlex
import sys

import pytest

from conftest import ROOT

specification = importlib.util.spec_from_file_location(
    "page_commands", ROOT / "scripts" / "page_commands.py"
)
page_commands = importlib.util.module_from_spec(specification)
specification.loader.exec_module(page_commands)
PAGES = page_commands.tutorial_pages()


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_output_is_that_on_the_page(path, tool, monkeypatch, tmp_path):
    # The python3 of the pages is the interpreter that the module is for.
    python = tmp_path / "python3"
    python.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} "$@"\n')
    python.chmod(0o755)
    tool_folder = pathlib.Path(os.environ["ISOATLAS_TOOL"]).parent
    path_variable = os.pathsep.join([str(tmp_path), str(tool_folder), os.environ["PATH"]])
    monkeypatch.setenv("PATH", path_variable)
    page = page_commands.Page(path)
    with page_commands.folder_with_samples() as folder:
        page.run(folder)
    if page.skipped:
        pytest.skip(f"needs {', '.join(page.skipped)}")
    assert page.ran >= 1
    advice = "scripts/page_commands.py --update writes the output into the page"
    assert not page.problems, "\n".join([*page.problems, advice])


def test_comparison_ignores_times_and_small_changes_of_numbers():
    assert page_commands.same(
        "35 components, 1,580 vertices, 485 ms\n", "35 components, 1,581 vertices, 12 s\n"
    )
    assert not page_commands.same("35 components\n", "36 components\n")
    assert not page_commands.same("1,580 vertices\n", "1,800 vertices\n")
    assert not page_commands.same("1 component\n", "1 loop\n")
    assert not page_commands.same("1 component\n", "1 component\n2 loops\n")


def test_finds_outdated_output(tmp_path):
    (tmp_path / "page.md").write_text(
        "```console\n$ echo one; \\\n  echo two\none\ntwo\n$ false\n$ echo $?\n0\n```\n\n"
        "```python\nprint(3)\n```\n\n```text\n4\n```\n"
    )
    page = page_commands.Page(tmp_path / "page.md")
    text = page.run(tmp_path)
    assert page.ran == 2 and len(page.problems) == 2
    assert text == page.text.replace("\n0\n", "\n1\n").replace("\n4\n", "\n3\n")
