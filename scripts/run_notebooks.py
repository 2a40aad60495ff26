#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the notebooks of the documentation.

  scripts/run_notebooks.py              lists the differences between notebooks and output
  scripts/run_notebooks.py --update     writes the current output, as text, into the notebooks
  scripts/run_notebooks.py --out DIR    writes copies with all output, 3-D pages included

Needs nbclient and ipykernel (Debian: python3-nbclient, python3-ipykernel), and the Python module on
PYTHONPATH. Notebooks are kept without 3-D pages, which are large; the documentation site runs them.
Exit status: 0 if the notebooks ran and their output is current, 1 if not, 77 if a package is
missing.
"""

import argparse
import importlib.util
import json
import os
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
NOTEBOOKS = ROOT / "docs" / "notebooks"

specification = importlib.util.spec_from_file_location(
    "page_commands", ROOT / "scripts" / "page_commands.py"
)
page_commands = importlib.util.module_from_spec(specification)
specification.loader.exec_module(page_commands)


def is_possible():
    """Whether the packages that run a notebook are installed."""
    return all(importlib.util.find_spec(name) for name in ("nbclient", "ipykernel"))


def executed(path):
    """The notebook, as a dict, after it ran in a new folder.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        A cell raised an exception; the text has the cell and the traceback.
    """
    import nbclient
    import nbformat

    os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # a warning of the debugger
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        client = nbclient.NotebookClient(
            notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": folder}}
        )
        client.execute()
    return json.loads(nbformat.writes(notebook))


def text_outputs(cell):
    """The outputs of a cell as one text."""
    texts = []
    for output in cell.get("outputs", ()):
        text = output["text"] if "text" in output else output.get("data", {}).get("text/plain", "")
        texts.append("".join(text).rstrip("\n"))
    return "\n".join(texts)


def without_pages(notebook):
    """The notebook with its outputs as text, without times and names of the machine."""
    for cell in notebook["cells"]:
        cell.get("metadata", {}).pop("execution", None)
        for output in cell.get("outputs", ()):
            for kind in [kind for kind in output.get("data", {}) if kind != "text/plain"]:
                del output["data"][kind]
    notebook["metadata"] = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    return notebook


def written(notebook):
    """The text of the notebook's file."""
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


def differences(kept, new):
    """One text for each cell whose output changed."""
    found = []
    for number, (one, other) in enumerate(zip(kept["cells"], new["cells"])):
        expected, printed = text_outputs(one), text_outputs(other)
        if not page_commands.same(expected, printed):
            found.append(f"cell {number}: expected\n{expected}\ngot\n{printed}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--out", type=pathlib.Path)
    options = parser.parse_args()
    if not is_possible():
        print("nbclient or ipykernel is not installed: scripts/install_dependencies.sh docs")
        return 77
    status = 0
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        kept = json.loads(path.read_text())
        new = executed(path)
        if options.out:
            options.out.mkdir(parents=True, exist_ok=True)
            (options.out / path.name).write_text(written(new))
        elif options.update:
            path.write_text(written(without_pages(new)))
        else:
            for difference in differences(kept, new):
                print(f"{path.relative_to(ROOT)}: {difference}")
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
