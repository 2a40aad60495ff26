# SPDX-License-Identifier: Apache-2.0
"""Pages in browsers and notebooks."""

from __future__ import annotations

import html
import os
import pathlib
import sys
import warnings
from typing import TYPE_CHECKING, Any, Callable, Sequence

from .errors import BadArgumentError, UnsupportedError

if TYPE_CHECKING:
    from ._mesh import Mesh

NOTEBOOK_BYTES = 4_000_000  # notebooks with outputs above 5 MB are slow to open and to keep
_TRIANGLE_BYTES = 3  # an encoded triangle of a page takes more than this


def is_page(path: str | os.PathLike[str]) -> bool:
    return os.fsdecode(path).lower().endswith(".html")


def page_path(path: str | os.PathLike[str] | None) -> pathlib.Path:
    """The file of a page: ``path``, or a file in a new temporary folder.

    Raises
    ------
    BadArgumentError
        The name does not end in .html.
    """
    if path is not None:
        if not is_page(path):
            raise BadArgumentError(f"path: expected a name that ends in .html, got {path!r}")
        return pathlib.Path(os.fsdecode(path)).resolve()
    import tempfile

    return pathlib.Path(tempfile.mkdtemp(prefix="isoatlas-")) / "mesh.html"


def open_in_browser(file: pathlib.Path) -> None:
    """Open the page; warn if there is no browser."""
    import webbrowser

    if not webbrowser.open(file.as_uri()):
        warnings.warn(
            f"no browser could be opened; the page is {file}", RuntimeWarning, stacklevel=3
        )


def show_in_notebook(mesh: Mesh) -> bool:
    """Show the mesh below the current cell. Returns False where there is no notebook."""
    ipython: Any = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None or getattr(shell, "kernel", None) is None:
        return False
    from IPython.display import display

    display(mesh)
    return True


def for_notebook(
    text: str, level_count: int, page: Callable[[int], str], triangles: Sequence[int]
) -> str:
    """The description ``text`` with the page of the first levels that fit into a notebook.

    Parameters
    ----------
    page : function
        Makes the page of a number of levels.
    triangles : sequence of int
        Number of triangles of each level.
    """
    heading = f"<div><code>{html.escape(text)}</code></div>"
    for count in range(level_count, 0, -1):
        if sum(triangles[:count]) * _TRIANGLE_BYTES > NOTEBOOK_BYTES:
            continue
        try:
            frame = _frame(page(count))
        except UnsupportedError:  # built without pages
            return heading
        if len(frame) > NOTEBOOK_BYTES:
            continue
        if count < level_count:
            heading += (
                f"<div>Shown without the finest {level_count - count} of {level_count} levels, "
                "which are too large for a notebook; <code>mesh.show('mesh.html')</code> opens "
                "all of them in the browser.</div>"
            )
        return heading + frame
    return heading + (
        "<div>Too large for a notebook; <code>mesh.show('mesh.html')</code> opens it in the "
        "browser.</div>"
    )


def _frame(page: str) -> str:
    """The page inside another page. It can run its script, but has no access to the other page.

    The text is ASCII, so that it does not depend on the encoding of the other page.
    """
    source = html.escape(page).encode("ascii", "xmlcharrefreplace").decode()
    return (
        f'<iframe srcdoc="{source}" title="isoatlas" width="100%" height="600" '
        'frameborder="0" sandbox="allow-scripts allow-downloads allow-popups" '
        'allow="fullscreen; clipboard-write" loading="lazy"></iframe>'
    )
