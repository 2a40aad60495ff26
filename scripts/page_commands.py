#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands and the snippets of pages of the documentation, and compares what they print with what the pages say.

  scripts/page_commands.py PAGE...            says where a page is out of date
  scripts/page_commands.py --update PAGE...   writes what is printed now into the pages

The tool has to be on PATH, the Python module on PYTHONPATH. A page is run from top to bottom in an empty folder that has `samples`:

  ```console   lines with `$ ` are commands (a backslash at the end continues one), the lines below are what they print, errors included
  ```sh        a script; its exit status has to be 0
  ```python    a snippet; names are kept for the next ones. ```python NAME is left out where the package NAME is missing
  ```text      directly below a script or a snippet: what that prints

Blocks inside of tabs are run like others; `<!-- not run: WHY -->` above a block leaves it out. Durations, sizes of files, digests and
versions of libraries are not compared; other numbers may differ by 5 %, whole numbers below 100 not at all.
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
BLOCK = re.compile(r"^(?P<skip><!-- not run: [^\n]* -->\n+)?```(?P<language>console|sh|python|text)(?: (?P<needs>\S+))?\n(?P<code>.*?)^```$", re.M | re.S)
UNSTABLE = re.compile(r"\b[\d,.]+ (?:ms|s|min|KiB|MiB|bytes)\b|\b[0-9a-f]{64}\b|(?<=libtiff )[\d.]+|(?<=zlib )[\d.]+")
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?")


class OutOfDate(Exception):
    """The text says where, what the page has and what is printed."""


def same(said, printed):
    """Is a text of the page what is printed, up to what changes from run to run?"""
    texts = [UNSTABLE.sub("(changes)", text).rstrip() for text in (said, printed)]
    if NUMBER.sub("#", texts[0]) != NUMBER.sub("#", texts[1]):
        return False
    for words in zip(*(NUMBER.findall(text) for text in texts)):
        a, b = (float(word.replace(",", "")) for word in words)
        if words[0] != words[1] and (a.is_integer() and abs(a) < 100 or abs(a - b) > 0.05 * abs(a)):
            return False
    return True


def shell(code, folder, status=0):
    """(exit status, what it prints): standard error and standard output, in the order of the writing."""
    done = subprocess.run(
        ["bash", "-c", f"(exit {status})\n{code}"], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env={**os.environ, "LC_ALL": "C.UTF-8", "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    return done.returncode, done.stdout


def commands(code):
    """(command as it stands, what the page says that it prints) of each command of a console block."""
    found, is_continued = [], False
    for line in code.splitlines(keepends=True):
        if line.startswith("$ ") or is_continued:
            if is_continued:
                found[-1][0] += line
            else:
                found.append([line, ""])
            is_continued = line.endswith("\\\n")
        elif not found:
            raise OutOfDate(f"a console block starts without a command: {line}")
        else:
            found[-1][1] += line
    return found


class Page:
    """One page. run() gives its text with what is printed now."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.text = self.path.read_text()
        self.problems = []
        self.ran = 0
        self.skipped = []

    def line(self, position):
        return self.text.count("\n", 0, position) + 1

    def note(self, position, what, said, printed):
        if not same(said, printed):
            self.problems.append(f"{self.path}:{self.line(position)}: {what.strip()}\n--- the page says\n{said}--- it prints\n{printed}")

    def run(self, folder):
        names, new, done, printed, status = {"__name__": "page"}, [], 0, None, 0
        for block in BLOCK.finditer(self.text):
            new.append(self.text[done : block.start()])
            done = block.end()
            language, code = block["language"], block["code"]
            is_below = printed is not None and not new[-1].strip()
            if language == "text":
                if is_below:
                    self.note(block.start(), "the block above", code, printed)
                    code = code if same(code, printed) else printed
                printed = None
            elif block["skip"]:
                printed = None
            elif block["needs"] and importlib.util.find_spec({"vtk": "vtkmodules"}.get(block["needs"], block["needs"])) is None:
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
                        raise OutOfDate(f"{self.path}:{self.line(block.start())}: exit status {status}\n{code}{printed}")
                else:
                    printed = self.run_python(block, folder, names)
            start = block.start("code") - block.start()
            new.append(block[0][:start] + code + block[0][block.end("code") - block.start() :])
        return "".join(new) + self.text[done:]

    def run_console(self, block, folder, status):
        code = ""
        for command, said in commands(block["code"]):
            status, printed = shell(command[2:].rstrip("\n"), folder, status)
            if printed and not printed.endswith("\n"):
                printed += "\n"
            printed = re.sub(r"[ \t]+$", "", printed, flags=re.M)
            self.note(block.start(), command, said, printed)
            code += command + (said if same(said, printed) else printed)
        return code, status

    def run_python(self, block, folder, names):
        where = f"{self.path}:{self.line(block.start())}"
        out, before = io.StringIO(), os.getcwd()
        os.chdir(folder)
        try:
            with contextlib.redirect_stdout(out):
                exec(compile("\n" * self.line(block.start("code") - 1) + block["code"], str(self.path), "exec"), names)
        except Exception as error:
            raise OutOfDate(f"{where}: {type(error).__name__}: {error}\n{block['code']}") from error
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="+", type=pathlib.Path, metavar="PAGE")
    parser.add_argument("--update", action="store_true", help="write what is printed into the pages")
    arguments = parser.parse_args()
    if shutil.which("isoatlas") is None or importlib.util.find_spec("isoatlas") is None:
        parser.error("the tool isoatlas has to be on PATH, the Python module on PYTHONPATH: docs/get-started.md says how")
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
        print(f"{path}: {page.ran} blocks ran" + (f", left out without {', '.join(page.skipped)}" if page.skipped else ""), flush=True)
    return 1 if has_problems else 0


if __name__ == "__main__":
    sys.exit(main())
