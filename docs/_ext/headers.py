# SPDX-License-Identifier: Apache-2.0
"""The directive `header`: all that a header of include/isoatlas declares, in its order.

It is taken from doxygen's XML, by breathe.
"""

import pathlib
import xml.etree.ElementTree as ElementTree

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

LOG = logging.getLogger(__name__)
HEADERS = pathlib.Path(__file__).resolve().parents[2] / "include" / "isoatlas"
KINDS = {
    "function": "doxygenfunction",
    "enum": "doxygenenum",
    "typedef": "doxygentypedef",
    "variable": "doxygenvariable",
}


def members(xml, header):
    """(line, directive, name) of all that the header declares in the namespace isoatlas.

    These are structs, classes, functions, enums, types and constants.
    """

    def is_here(element):
        location = element.find("location")
        return location is not None and pathlib.PurePosixPath(location.get("file")).name == header

    for file in [*xml.glob("structisoatlas_*.xml"), *xml.glob("classisoatlas_*.xml")]:
        for compound in ElementTree.parse(file).iter("compounddef"):
            name = compound.findtext("compoundname")
            if is_here(compound) and name.count("::") == 1:  # those inside others come with them
                line = int(compound.find("location").get("line"))
                yield line, f"doxygen{compound.get('kind')}", name
    for member in ElementTree.parse(xml / "namespaceisoatlas.xml").iter("memberdef"):
        if is_here(member) and member.get("kind") in KINDS:
            arguments = (
                member.findtext("argsstring") or "" if member.get("kind") == "function" else ""
            )
            name = f"isoatlas::{member.findtext('name')}{arguments}"
            yield int(member.find("location").get("line")), KINDS[member.get("kind")], name


class Header(SphinxDirective):
    required_arguments = 1

    def run(self):
        header = self.arguments[0]
        xml = pathlib.Path(self.config.breathe_projects[self.config.breathe_default_project])
        found = sorted(members(xml, header))
        self.env.__dict__.setdefault("headers_shown", set()).add(header)
        self.env.note_dependency(str(HEADERS / header))
        if not found:
            LOG.warning(
                "%s declares nothing that doxygen knows", header, location=self.get_location()
            )
        text = StringList()
        for _, directive, name in found:
            options = (
                [":members:", ":undoc-members:"]
                if directive in ("doxygenstruct", "doxygenclass")
                else []
            )
            for line in [f".. {directive}:: {name}", *(f"   {option}" for option in options), ""]:
                text.append(line, header)
        # Prepares what "@throws" needs, also where no other text comes before it.
        self.state.inline_text("", self.lineno)
        node = nodes.Element()
        self.state.nested_parse(text, self.content_offset, node)
        for paragraph in list(node.findall(nodes.paragraph)):
            # Its links do not resolve, and the class lists its bases.
            if paragraph.astext().startswith("Subclassed by"):
                paragraph.parent.remove(paragraph)
        return node.children


def check_that_all_are_shown(app, env):
    shown = getattr(env, "headers_shown", set())
    for header in sorted(HEADERS.glob("*.h")):
        if header.name not in shown and "namespace isoatlas" in header.read_text():
            LOG.warning(
                "include/isoatlas/%s is missing: add it under its own heading",
                header.name,
                location="api/cpp",
            )


def setup(app):
    app.add_directive("header", Header)
    app.connect("env-check-consistency", check_that_all_are_shown)
    return {"parallel_read_safe": False}
