# SPDX-License-Identifier: Apache-2.0
"""Makes Jupyter notebooks pages of the site: their Markdown, code and output.

The environment variable ISOATLAS_NOTEBOOKS names a folder with copies that scripts/run_notebooks.py
ran, which contain the 3-D pages. Without it, the output is the text that the notebooks keep.
"""

import json
import os
import pathlib

from myst_parser.parsers.sphinx_ import MystParser

FENCE = 12 * "`"  # longer than any in the output


def fenced(directive, text):
    """A block of Markdown."""
    return f"{FENCE}{directive}\n{text.rstrip()}\n{FENCE}\n"


def markdown_of_output(output):
    """An output of a cell: its 3-D page, or else its text."""
    data = output.get("data", {})
    if "text/html" in data:
        return fenced("{raw} html", "".join(data["text/html"]))
    return fenced("text", "".join(output.get("text") or data.get("text/plain", "")))


def markdown_of(notebook):
    """The Markdown of a notebook, given as a dict."""
    parts = []
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            parts.append(source + "\n")
        elif cell["cell_type"] == "code":
            parts.append(fenced("python", source))
            parts += [markdown_of_output(output) for output in cell["outputs"]]
    return "\n".join(parts)


class NotebookParser(MystParser):
    """Parses .ipynb files."""

    supported = ("notebook",)

    def parse(self, inputstring, document):
        folder = os.environ.get("ISOATLAS_NOTEBOOKS")
        path = pathlib.Path(document["source"])
        if folder and (pathlib.Path(folder) / path.name).is_file():
            inputstring = (pathlib.Path(folder) / path.name).read_text()
        super().parse(markdown_of(json.loads(inputstring)), document)


def setup(app):
    app.add_source_suffix(".ipynb", "notebook")
    app.add_source_parser(NotebookParser)
    return {"parallel_read_safe": True}
