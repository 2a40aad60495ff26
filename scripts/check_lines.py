#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that lines of code and prose have at most 100 characters.

Prints file:line and the length of each longer line, and exits with status 1 if there is one. Checks
the files that git tracks and new ones that it does not ignore. The exemptions are LEFT_OUT, and in
any file a line that is only a link. In Markdown, tables and quoted output are exempt, too.
"""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT = 100
SUFFIXES = {
    *(".h", ".cpp", ".inl", ".py", ".pyi", ".cmake", ".in", ".sh", ".md", ".bib", ".cff"),
    *(".ts", ".mjs", ".js", ".css", ".html", ".json", ".toml"),
}
NAMES = {"CMakeLists.txt", ".clang-format", ".clang-tidy", ".editorconfig", ".ci/run"}

# Files and folders that are not checked -> reason.
LEFT_OUT = {
    "docs/decisions": "history, which is not rewritten",
    "docs/results.md": "results of measurements, most of them pasted from the output of a program",
    "docs/benchmarks.md": "bench/compare.py writes it",
    "web/package-lock.json": "npm writes it",
}

# A line that is only a URL or a link in Markdown, after the mark of a comment or a list: it has no
# place to break.
URL = r"<?https?://\S+"
IMAGE = r"!\[[^\[\]]*\]\(\S+\)"
LINK = rf"\[({IMAGE}|[^\[\]]*)\]\(\S+\)"
ONLY_LINK = re.compile(rf"\s*(//|#|[-*])?\s*({URL}|{IMAGE}|{LINK})[.,;]?\s*")

# Blocks of code in Markdown with these languages quote output, which is shown as the program prints
# it. In a console block, the commands are checked.
OUTPUT = {"", "text", "console"}
FENCE = re.compile(r"\s*(?P<marks>```+|~~~+)\s*(?P<language>[\w{}-]*)")
ITEM = re.compile(r"\s*([-*+]|\d+[.)])\s+")


def is_left_out(name):
    return any(name == area or name.startswith(area + "/") for area in LEFT_OUT)


def is_checked(name):
    path = pathlib.PurePosixPath(name)
    wanted = path.suffix in SUFFIXES or path.name in NAMES or name in NAMES
    return wanted and not is_left_out(name) and (ROOT / name).is_file()


def files():
    """Names of the checked files, relative to the root of the repository."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [name for name in sorted(set(listed.split("\0"))) if name and is_checked(name)]


def without_quotes(lines):
    """(number, line) of the lines of a Markdown page that are not in a table or quoted output."""
    fence = None  # the marks that end the fenced block
    language = ""
    in_command = False  # the line before ends with a backslash
    text_column = 0  # where the text of the current list item starts; code has 4 blanks more
    in_indented = False
    after_blank = True
    for number, line in enumerate(lines, 1):
        start = FENCE.match(line)
        if fence:
            is_command = language == "console" and (in_command or line.startswith("$ "))
            in_command = is_command and line.endswith("\\")
            if line.strip() == fence:
                fence = None
            elif is_command or language not in OUTPUT:
                yield number, line
            continue
        if start:
            fence, language, in_command = start["marks"], start["language"], False
            after_blank = in_indented = False
            continue
        if not line.strip():
            after_blank = True
            continue
        column = len(line) - len(line.lstrip())
        in_indented = column >= text_column + 4 and (in_indented or after_blank)
        if not in_indented:
            item = ITEM.match(line)
            if item:
                text_column = item.end()
            elif column < text_column and after_blank:
                text_column = 0
            if not line.lstrip().startswith("|"):
                yield number, line
        after_blank = False


def findings():
    for name in files():
        lines = (ROOT / name).read_text(encoding="utf-8").splitlines()
        checked = without_quotes(lines) if name.endswith(".md") else enumerate(lines, 1)
        for number, line in checked:
            if len(line) > LIMIT and not ONLY_LINK.fullmatch(line):
                yield name, number, len(line)


def main():
    failed = False
    for name, number, length in findings():
        failed = True
        print(f"{name}:{number}: {length} characters, at most {LIMIT} are allowed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
