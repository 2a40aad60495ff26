#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands and snippets on pages of the documentation and compares their output.

  scripts/page_commands.py PAGE...            lists the differences between page and output
  scripts/page_commands.py --update PAGE...   writes the current output into the pages

PATH must contain the tool, and PYTHONPATH the Python module. The blocks of a page run from top to
bottom in a folder that contains only `samples`:

  ```console   lines that start with `$ ` are commands (a backslash at the end continues one); the
               lines below are the output, errors included. ```console NAME is skipped if the
               program NAME is not on the PATH
  ```sh        a script; its exit status must be 0
  ```python    a snippet; it can use the names of earlier snippets. ```python NAME is skipped if the
               package NAME is not installed
  ```text      the output of the script or snippet directly above

Blocks inside tabs run like others; `<!-- not run: WHY -->` above a block skips it. Durations, file
sizes, digests and library versions are not compared. Whole numbers below 100 must be equal; other
numbers may differ by 5 %.
"""

import argparse
import contextlib
import importlib.util
import io
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(
    r"^(?P<skip><!-- not run: [^\n]* -->\n+)?"
    r"```(?P<language>console|sh|python|text)(?: (?P<needs>\S+))?\n(?P<code>.*?)^```$",
    re.M | re.S,
)
UNSTABLE = re.compile(
    r"\b[\d,.]+ (?:ms|s|min|KiB|MiB|bytes)\b|\b[0-9a-f]{64}\b|(?<=libtiff )[\d.]+|(?<=zlib )[\d.]+"
)
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?")


def tutorial_pages():
    """The pages that the test `python.pages` runs by this script."""
    docs = ROOT / "docs"
    return sorted([docs / "index.md", docs / "get-started.md", *(docs / "tasks").glob("*.md")])


class PageError(Exception):
    """A block of a page cannot be run. The text states where, and the output."""


def same(expected, printed):
    """Whether two outputs are equal, except for what changes from run to run."""
    texts = [UNSTABLE.sub("(changes)", text).rstrip() for text in (expected, printed)]
    if NUMBER.sub("#", texts[0]) != NUMBER.sub("#", texts[1]):
        return False
    for words in zip(*(NUMBER.findall(text) for text in texts)):
        a, b = (float(word.replace(",", "")) for word in words)
        if words[0] != words[1] and (a.is_integer() and abs(a) < 100 or abs(a - b) > 0.05 * abs(a)):
            return False
    return True


def shell(code, folder, status=0):
    """Run a script with `status` as the previous exit status.

    Returns the exit status and the output: standard error and standard output, interleaved.
    """
    done = subprocess.run(
        ["bash", "-c", f"(exit {status})\n{code}"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env={**os.environ, "LC_ALL": "C.UTF-8", "PYTHONUNBUFFERED": "1"},
    )
    return done.returncode, done.stdout


def commands(code):
    """(lines of the command, expected output) for each command of a console block."""
    found, is_continued = [], False
    for line in code.splitlines(keepends=True):
        if line.startswith("$ ") or is_continued:
            if is_continued:
                found[-1][0] += line
            else:
                found.append([line, ""])
            is_continued = line.endswith("\\\n")
        elif not found:
            raise PageError(f"a console block must start with a command, got: {line}")
        else:
            found[-1][1] += line
    return found


def is_installed(language, name):
    """Whether the Python package, or the program for a console block, is installed."""
    if language == "console":
        return shutil.which(name) is not None
    return importlib.util.find_spec({"vtk": "vtkmodules"}.get(name, name)) is not None


class Page:
    """A page of the documentation. run() returns its text with the current output."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.text = self.path.read_text()
        self.problems = []
        self.ran = 0
        self.skipped = []

    def line_number(self, position):
        return self.text.count("\n", 0, position) + 1

    def compare(self, position, what, expected, printed):
        if not same(expected, printed):
            self.problems.append(
                f"{self.path}:{self.line_number(position)}: {what.strip()}\n"
                f"--- on the page\n{expected}--- printed\n{printed}"
            )

    def run(self, folder):
        names, new, done, printed, status = {"__name__": "page"}, [], 0, None, 0
        for block in BLOCK.finditer(self.text):
            new.append(self.text[done : block.start()])
            done = block.end()
            language, code = block["language"], block["code"]
            is_below = printed is not None and not new[-1].strip()
            if language == "text":
                if is_below:
                    self.compare(block.start(), "the block above", code, printed)
                    code = code if same(code, printed) else printed
                printed = None
            elif block["skip"]:
                printed = None
            elif block["needs"] and not is_installed(language, block["needs"]):
                self.skipped.append(block["needs"])
                printed = None
            else:
                self.ran += 1
                if language == "console":
                    code, status = self.run_console(block, folder, status)
                    printed = None
                elif language == "sh":
                    status, printed = shell("set -euo pipefail\n" + code, folder)
                    if status:
                        where = f"{self.path}:{self.line_number(block.start())}"
                        raise PageError(f"{where}: exit status {status}\n{code}{printed}")
                else:
                    printed = self.run_python(block, folder, names)
            start = block.start("code") - block.start()
            new.append(block[0][:start] + code + block[0][block.end("code") - block.start() :])
        return "".join(new) + self.text[done:]

    def run_console(self, block, folder, status):
        code = ""
        for command, expected in commands(block["code"]):
            status, printed = shell(command[2:].rstrip("\n"), folder, status)
            if printed and not printed.endswith("\n"):
                printed += "\n"
            printed = re.sub(r"[ \t]+$", "", printed, flags=re.M)
            self.compare(block.start(), command, expected, printed)
            code += command + (expected if same(expected, printed) else printed)
        return code, status

    def run_python(self, block, folder, names):
        where = f"{self.path}:{self.line_number(block.start())}"
        # Empty lines first: line numbers in errors are those of the page.
        source = "\n" * self.line_number(block.start("code") - 1) + block["code"]
        out, before = io.StringIO(), os.getcwd()
        os.chdir(folder)
        try:
            with contextlib.redirect_stdout(out):
                exec(compile(source, str(self.path), "exec"), names)
        except Exception as error:
            raise PageError(f"{where}: {type(error).__name__}: {error}\n{block['code']}") from error
        finally:
            os.chdir(before)
        return out.getvalue()


@contextlib.contextmanager
def folder_with_samples():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "samples").symlink_to(ROOT / "samples")
        yield folder


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("pages", nargs="+", type=pathlib.Path, metavar="PAGE")
    parser.add_argument(
        "--update", action="store_true", help="write the current output into the pages"
    )
    arguments = parser.parse_args()
    if shutil.which("isoatlas") is None or importlib.util.find_spec("isoatlas") is None:
        parser.error(
            "PATH must contain the tool isoatlas and PYTHONPATH the Python module, "
            "see docs/get-started.md"
        )
    has_problems = False
    for path in arguments.pages:
        page = Page(path)
        with folder_with_samples() as folder:
            text = page.run(folder)
        if arguments.update and text != page.text:
            path.write_text(text)
            print(f"{path}: updated")
        elif not arguments.update:
            print(*page.problems, sep="\n", end="\n" if page.problems else "")
            has_problems = has_problems or bool(page.problems)
        print(
            f"{path}: {page.ran} blocks ran"
            + (f", skipped without {', '.join(page.skipped)}" if page.skipped else ""),
            flush=True,
        )
    return 1 if has_problems else 0


if __name__ == "__main__":
    sys.exit(main())
