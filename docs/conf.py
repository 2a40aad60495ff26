# SPDX-License-Identifier: Apache-2.0
"""The documentation site, by Sphinx. scripts/build_docs.sh builds it and lists its requirements."""

import os
import pathlib
import re
import sys

from docutils import nodes
from docutils.parsers.rst import Directive, directives
from sphinx import addnodes

DOCS = pathlib.Path(__file__).resolve().parent
ROOT = DOCS.parent
sys.path.insert(0, str(DOCS / "_ext"))

project = "isoatlas"
author = "the isoatlas contributors"
copyright = "the isoatlas contributors. Apache License 2.0"
release = version = re.search(
    r"project\(isoatlas VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()
)[1]

extensions = [
    "breathe",
    "headers",
    "myst_parser",
    "notebook_pages",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_inline_tabs",
]
nitpicky = True
exclude_patterns = ["_ext", "_static"]

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4  # as a code host makes them: [text](page.md#heading)

html_theme = "furo"
html_title = f"isoatlas {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
pygments_style = "friendly"
pygments_dark_style = "monokai"
copybutton_prompt_text = "$ "
copybutton_line_continuation_character = "\\"
copybutton_only_copy_prompt_lines = True
highlight_language = "text"

# The API of C++: doxygen's XML, which scripts/build_docs.sh makes.
breathe_projects = {
    "isoatlas": os.environ.get(
        "ISOATLAS_DOXYGEN_XML", str(ROOT / "build" / "docs" / "doxygen" / "xml")
    )
}
breathe_default_project = "isoatlas"
breathe_show_include = False
breathe_default_members = ("members",)
cpp_index_common_prefix = ["isoatlas::"]

# The API of Python: the module that CMake builds has to be on PYTHONPATH.
autodoc_mock_imports = ["dask", "distributed", "pyvista"]  # of other versions in Debian, or none
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings describe types
autoclass_content = "class"
default_role = "py:obj"
napoleon_use_rtype = False
napoleon_use_param = False
napoleon_use_ivar = True
napoleon_custom_sections = [("Warns", "returns_style")]

# What other projects document, and what is inside namespaces that doxygen leaves out.
nitpick_ignore_regex = [
    # Sample, Range and F are parameters of templates.
    ("cpp:identifier", r"isoatlas|std|size_t|ptrdiff_t|u?int\d+_t|Sample|Range|F"),
    # "@throws Error(bad_file)": breathe takes the code for a type; "@throws as extract()".
    (
        "cpp:identifier",
        "as|bad_argument|bad_file|unsupported|empty_surface|internal|out_of_memory|cancelled",
    ),
    ("py:.*", r"(?!isoatlas).*"),
]

# Files beside docs/ that are pages of the site.
PAGES_BESIDE = {
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "README.md": "index.md",
    "samples/README.md": "samples.md",
}
PAGE_IN_TEXT = re.compile(r"docs/([\w/-]+)\.md")


def lead_links_beside_docs(app, doctree):
    """Makes a link to a file beside docs/ lead to the page that includes the file.

    On a code host, the link leads to the file itself.
    """
    folder = pathlib.PurePosixPath(app.env.docname).parent
    for link in doctree.findall(addnodes.pending_xref):
        if link.get("reftype") != "myst":
            continue
        target, hash, anchor = link["reftarget"].partition("#")
        path = os.path.normpath(DOCS / folder / target)
        beside = os.path.relpath(path, ROOT).replace(os.sep, "/")
        if target and beside in PAGES_BESIDE:
            link["reftarget"] = os.path.relpath(PAGES_BESIDE[beside], folder) + hash + anchor


def link_pages_in_api(app, doctree):
    """Comments of headers and docstrings name pages as docs/NAME.md: make them links."""
    if not app.env.docname.startswith("api/"):
        return
    for text in list(doctree.findall(nodes.Text)):
        parts = PAGE_IN_TEXT.split(text)
        if len(parts) == 1 or isinstance(
            text.parent, (nodes.literal, nodes.literal_block, nodes.reference)
        ):
            continue
        new = []
        for k, part in enumerate(parts):
            if k % 2 == 0:
                new.append(nodes.Text(part))
                continue
            link = addnodes.pending_xref(
                "",
                nodes.inline("", f"docs/{part}.md"),
                refdomain="std",
                reftype="doc",
                reftarget=f"/{part}",
                refdoc=app.env.docname,
                refexplicit=True,
                refwarn=True,
            )
            new.append(link)
        text.parent.replace(text, new)


class LeftOut(Directive):
    """In place of autodoc's directives where the module is not there."""

    required_arguments = 1
    has_content = True
    option_spec = {"members": directives.unchanged}

    def run(self):
        return [
            nodes.paragraph(
                "",
                "",
                nodes.literal("", self.arguments[0]),
                nodes.Text(": left out, the site was built without the module."),
            )
        ]


def leave_python_out(app):
    if app.tags.has("without_python"):
        for name in ("autofunction", "autoclass", "autoexception"):
            app.add_directive(name, LeftOut, override=True)


def setup(app):
    app.connect("builder-inited", leave_python_out)
    app.connect("doctree-read", lead_links_beside_docs)
    app.connect("doctree-read", link_pages_in_api)
