#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that the files and anchors of all links inside the documentation exist.

Links to other sites are not checked.

scripts/check_links.py             the Markdown files, as a code host shows them
scripts/check_links.py --html DIR  the built site
"""

import argparse
import html.parser
import pathlib
import re
import sys
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
FENCE = re.compile(r"^(`{3,})[^\n]*\n.*?^\1[ \t]*$", re.M | re.S)
EXTERNAL = re.compile(r"[a-z][a-z0-9+.-]*:|//", re.I)


def markdown_files():
    return sorted(
        [
            *ROOT.glob("*.md"),
            *(ROOT / "docs").rglob("*.md"),
            *(ROOT / "samples").glob("*.md"),
            *(ROOT / "examples").rglob("*.md"),
        ]
    )


def prose(path):
    """The text of a page without code blocks and inline code; line numbers are kept."""
    text = FENCE.sub(lambda block: "\n" * block[0].count("\n"), path.read_text())
    text = re.sub(r"^(?: {4}|\t).*$", "", text, flags=re.M)
    return re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", "``", text)


def anchors(path):
    """The anchors of the headings on code hosts: lower case, no punctuation, hyphens for blanks."""
    found, count = set(), {}
    text = FENCE.sub("", path.read_text())
    for heading in re.findall(r"^#{1,6} +(.*?) *#*$", text, re.M):
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        number = count.get(slug, 0)
        count[slug] = number + 1
        found.add(f"{slug}-{number}" if number else slug)
    return found | set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))


def check_markdown():
    problems = []
    for path in markdown_files():
        text = prose(path)
        for match in re.finditer(r"\]\(<?([^)\s>]+)>?(?: \"[^\"]*\")?\)", text):
            link = match[1]
            if EXTERNAL.match(link):
                continue
            where = f"{path.relative_to(ROOT)}:{text.count(chr(10), 0, match.start()) + 1}"
            target, _, anchor = link.partition("#")
            file = (path.parent / urllib.parse.unquote(target)).resolve() if target else path
            if not file.exists():
                problems.append(f"{where}: {link}: no such file")
            elif ROOT not in file.parents and file != ROOT:
                problems.append(f"{where}: {link}: outside the repository")
            elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                problems.append(
                    f"{where}: {link}: {file.relative_to(ROOT)} has no heading #{anchor}"
                )
    return problems


class Page(html.parser.HTMLParser):
    """The ids and links of an HTML page."""

    def __init__(self, path):
        super().__init__()
        self.ids, self.links = set(), []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.ids.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)


def check_html(folder):
    folder = folder.resolve()
    pages = {path: Page(path) for path in sorted(folder.rglob("*.html"))}
    if not pages:
        return [f"{folder}: no pages"]
    problems = []
    for path, page in pages.items():
        for link in page.links:
            if EXTERNAL.match(link):
                continue
            target, _, anchor = link.partition("#")
            target = urllib.parse.unquote(target.partition("?")[0])
            file = (path.parent / target).resolve() if target else path
            if not file.exists():
                problems.append(f"{path.relative_to(folder)}: {link}: no such file")
            elif anchor and file in pages and urllib.parse.unquote(anchor) not in pages[file].ids:
                problems.append(f"{path.relative_to(folder)}: {link}: no such anchor")
    return problems


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--html", type=pathlib.Path, help="the folder of the built site")
    arguments = parser.parse_args()
    problems = check_html(arguments.html) if arguments.html else check_markdown()
    print(*problems, sep="\n", end="\n" if problems else "", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
