#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of README and docs, and compiles their C++.

Each block of each page is classified: commands, a snippet in a known language, or text. Commands
with `isoatlas` run from top to bottom in one folder per page. Volumes and meshes that a page names
without making them are small generated ones. Output below a command must be what the tool prints.
Other commands must be in NOT_RUN, with the reason. The environment names the tool (ISOATLAS_TOOL)
and the build folder (ISOATLAS_BUILD); ISOATLAS_NO_PICTURES leaves out the drawing commands. Needs
only the standard library and bash.
"""

import gzip
import importlib.util
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from array import array

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from markdown_blocks import ROOT, all_blocks, blocks_of_text, cpp_program, pages  # noqa: E402

specification = importlib.util.spec_from_file_location(
    "page_commands", ROOT / "scripts/page_commands.py")
page_commands = importlib.util.module_from_spec(specification)
specification.loader.exec_module(page_commands)

TOOL = os.environ.get("ISOATLAS_TOOL")
BUILD = pathlib.Path(os.environ.get("ISOATLAS_BUILD", ROOT / "build/release"))
CXX = os.environ.get("CXX", "g++")
HAS_PICTURES = not os.environ.get("ISOATLAS_NO_PICTURES") and (os.environ.get("DISPLAY") or
                                                               shutil.which("Xvfb"))

SHELL = {"sh", "console"}
# Languages of blocks that are not commands.
OTHER = {"python", "cpp", "cmake", "text", "bibtex"}
# tests/python/test_documentation.py runs the Python of these pages; those of TUTORIAL are run by
# tests/python/test_pages.py.
PYTHON_PAGES = {"README.md", "docs/python.md"}
# The tests of tests/hosts run these in their hosts.
HOST_PAGES = {"docs/hosts/napari.md", "docs/hosts/paraview.md"}
TUTORIAL = {str(path.relative_to(ROOT)) for path in page_commands.tutorial_pages()}

# Blocks without a language that are no commands: page -> how they start.
TEXT_BLOCKS = {
    "docs/architecture.md": ["volume -> surface"],
    "docs/reference/command-line.md": [
        "--refine max-distance:2vx",  # options; test_options_of_fragments checks them
        "  intersections 3 pairs",  # the form of these three is tested in tests/cli/cli_test.py
        "  distance      to the isosurface",
        "isoatlas: head.ply: is nowhere near",
    ],
    "docs/reference/files.md": ["scene 0 -> node 0"],
    "docs/theory/01-surface.md": ["b N + U / 8"],
    "docs/theory/04-covering.md": ["h(x) <= h(y)", "h = R_g everywhere"],
}

# Commands that cannot run here: how they start, the reason, and the file that tests them or what
# they call. Names of files, options, presets and programs in them are checked nevertheless.
NOT_RUN = [
    (r"scripts/make_package\.sh", "builds the package", "tests/install/package_test.sh"),
    (r"sudo apt install \./build/release/isoatlas_", "needs root; a Debian root has it",
     "tests/install/try_package.sh"),
    (r"scripts/demo\.sh", "builds; its extraction is on the page and runs", "README.md"),
    (r"scripts/install_dependencies\.sh", "installs packages", "scripts/test.sh"),
    (r"scripts/test\.sh", "builds and runs the tests", ".ci/run"),
    (r"(cmake|ctest) (--preset|--build)", "builds and runs the tests", "scripts/test.sh"),
    (r"export PATH=", "sets the environment, as this test does", "tests/docs/CMakeLists.txt"),
    (r"python3 -m venv|venv/bin/pip", "builds the module", "tests/python/test_install.py"),
    (r"scripts/build_wheel\.sh|pip install build/wheels/|venv/bin/(isoatlas|python) ",
     "needs the wheel", "tests/wheel/test_wheel.py"),
    (r"RC_PARAMS=\S+ (seed=\S+ )?build/release/bin/test_property", "runs for a long time",
     "scripts/nightly.sh"),
    (r"scripts/(format\.sh|check_\w+\.py)", "is a test by itself", "tests/CMakeLists.txt"),
    (r"mkdir -p build/corpus", "prepares the fuzzer", "tests/fuzz/CMakeLists.txt"),
    (r"build/fuzz/bin/fuzz_extract|scripts/(fuzz_files|keep_fuzz_corpus)\.sh",
     "fuzzes, with clang; every build replays the corpus", "tests/fuzz/CMakeLists.txt"),
    (r"/usr/bin/python3 bench/compare\.py|build/bench/bin/", "measures for a long time",
     "bench/CMakeLists.txt"),
    (r"bench/instructions\.py", "counts instructions for minutes", "bench/CMakeLists.txt"),
    (r"scripts/page_commands\.py", "is what python.pages runs", "tests/python/test_pages.py"),
    (r"isoatlas view (?!--help)", "runs until its page is closed", "tests/page/view_tool_test.mjs"),
    (r"cat part\.geo|gmsh |tetgen ", "needs a mesher that is no dependency",
     "docs/tasks/simulation.md"),
]

# Commands whose exit status may be 1: page, a part of the command, and the reason.
MAY_VIOLATE = [
    ("docs/gallery.md", "--refine max-vertices:", "the limit of vertices comes first"),
    ("docs/gallery.md", "brain_fa.nii.gz", "a small volume stands in for the brain"),
]

# Folders that a page takes to exist.
FOLDERS = {"README.md": ["build/demo"]}  # scripts/demo.sh makes it

VOLUMES = (".nrrd", ".nii", ".nrrd.gz", ".nii.gz")
MESHES = (".ply", ".stl", ".obj", ".off", ".vtp", ".3mf", ".gii", ".glb", ".vtm")


# ------------------------------------------------------------------------------------- commands


def is_console(block):
    return block.language == "console" or (not block.language and
                                           re.search(r"(?m)^\$ ", block.text) is not None)


def commands(block):
    """(command, output below it or None) for each command of a block."""
    if is_console(block):
        return [(command[2:].rstrip("\n"), output)
                for command, output in page_commands.commands(block.text)]
    # A backslash at the end of a line continues the command.
    found = re.findall(r"(?m)^(?:.*\\\n)*.*$", block.text)
    return [(command, None) for command in found
            if command.strip() and not command.startswith("#")]


def is_run(command):
    """Whether the command runs the tool."""
    one_line = command.replace("\\\n", " ")
    if reason_not_to_run(one_line):
        return False
    return re.search(r"(^|[|&;(] *)(build/release/bin/)?isoatlas ", one_line) is not None


def reason_not_to_run(command):
    """(reason, file) of NOT_RUN, or None for an unknown command."""
    for pattern, reason, where in NOT_RUN:
        if re.match(pattern, command):
            return reason, where
    return None


def is_known(command):
    return is_run(command) or reason_not_to_run(command) is not None


def is_text(block):
    """Whether the block is in TEXT_BLOCKS."""
    return not block.language and any(
        block.text.startswith(start) for start in TEXT_BLOCKS.get(block.page, []))


def is_shell(block):
    """Whether the block consists of commands."""
    if block.language or is_text(block):
        return block.language in SHELL
    return any(is_known(command) for command, _ in commands(block))


def problems_of_block(block):
    """What is not known about a block, one line each."""
    if block.language.startswith("{") or block.language in OTHER:
        return []
    if block.language and block.language not in SHELL:
        return [f"{block}: unknown language {block.language}"]
    if is_text(block):
        return []
    if not is_shell(block):
        return [f"{block}: neither a known command nor in TEXT_BLOCKS: {block.text[:60]!r}; "
                "fence it with ```text, ```sh or another language"]
    if block.page in TUTORIAL:
        return []  # runs as a script, see TutorialPages
    return [f"{block}: unknown command: {command}" for command, _ in commands(block)
            if not is_known(command)]


# ----------------------------------------------------------------------------- generated volumes


def write_volume(path, isovalue, label=None, size=(26, 22, 16)):
    """Write a torus and a ball as float32 samples around the isovalue, which is the surface; or as
    the samples with a label."""
    nx, ny, nz = size
    samples = array("f")
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                ring = math.hypot((x - 10.3) / 1.15, y - 10.6) - 6.2
                torus = 2.6 - math.hypot(ring, z - 7.4)
                ball = 1.8 - math.dist((x, y, z), (22.2, 17.8, 7.1))
                inside = max(torus, ball)
                samples.append(isovalue + 40 * inside if label is None else label * (inside >= 0))
    if sys.byteorder == "big":
        samples.byteswap()
    if path.name.endswith((".nrrd", ".nrrd.gz")):
        header = ("NRRD0004\ntype: float\ndimension: 3\n"
                  f"sizes: {nx} {ny} {nz}\nspacings: 1 1 1.5\nendian: little\nencoding: raw\n\n"
                  ).encode()
    else:
        header = bytearray(352)  # NIfTI-1
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, 3, nx, ny, nz, 1, 1, 1, 1)
        struct.pack_into("<hh", header, 70, 16, 32)  # float32
        struct.pack_into("<8f", header, 76, 1, 1, 1, 1.5, 0, 0, 0, 0)
        struct.pack_into("<ff", header, 108, 352, 1)
        struct.pack_into("<b", header, 123, 2)  # millimetres
        struct.pack_into("<hh", header, 252, 0, 1)  # sform
        struct.pack_into("<12f", header, 280, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1.5, 0)
        header[344:348] = b"n+1\0"
    data = bytes(header) + samples.tobytes()
    path.write_bytes(gzip.compress(data, 1) if path.name.endswith(".gz") else data)


def words(command):
    """The words of a command, without comments."""
    return shlex.split(command.replace("\\\n", ""), comments=True)


def inputs(command):
    """Names of volumes and meshes that a command reads."""
    found, before = [], ""
    for word in words(command):
        is_output = before in ("-o", "--output", "--report", "--html", ">") or word.startswith(">")
        if not is_output and word.endswith(VOLUMES + MESHES) and not word.startswith("-"):
            found.append(word)
        before = word
    return found


class Folder:
    """The folder in which the commands of a page run."""

    def __init__(self, path, page, texts):
        self.path = path
        self.texts = texts
        (path / "bin").mkdir()
        (path / "bin/isoatlas").symlink_to(TOOL)
        (path / "samples").mkdir()
        for sample in (ROOT / "samples").iterdir():
            (path / "samples" / sample.name).symlink_to(sample)
        # A small volume stands in for the embryo, which takes half a minute.
        (path / "samples" / "embryo.nrrd").unlink()
        write_volume(path / "samples" / "embryo.nrrd", 50.5)
        for folder in FOLDERS.get(page, []):
            (path / folder).mkdir(parents=True)

    def run(self, command):
        """The exit status and the output, standard error included."""
        command = command.replace("build/release/bin/isoatlas", "isoatlas")
        command = command.replace("/usr/share/isoatlas/samples", "samples")
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", command], cwd=self.path, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True, timeout=120,
            env={**os.environ, "LC_ALL": "C.UTF-8", "HOME": str(self.path),
                 "PATH": f"{self.path / 'bin'}{os.pathsep}{os.environ['PATH']}"})
        return done.returncode, done.stdout

    def isovalue(self, name):
        """The isovalue with which the page uses a volume."""
        for text in self.texts:
            found = re.search(r"--iso (\S+)", text)
            if found and name in words(text):
                return float(found[1])
        return 100.0

    def label(self, name):
        """The label with which the page uses a segmentation, or None."""
        for text in self.texts:
            found = re.search(r"--label (\d+)", text)
            if found and name in words(text):
                return int(found[1])
        return None

    def provide(self, command):
        """Write the files that the command reads and no earlier command wrote."""
        for name in inputs(command):
            path = self.path / name
            if path.exists() or name.startswith("/"):
                continue
            if name.endswith(VOLUMES):
                write_volume(path, self.isovalue(name), self.label(name))
                continue
            volume = self.path / "bin/any.nrrd"
            write_volume(volume, 0)
            status, printed = self.run(
                f"isoatlas extract {volume} --iso 0 --coarse -q -o {shlex.quote(name)}")
            if status:
                raise AssertionError(f"{name}: {printed}")


def without_times(text):
    return page_commands.UNSTABLE.sub("(changes)", text).rstrip()


def tool_has_pages():
    done = subprocess.run([TOOL, "report", "missing.json", "-o", "/nonexistent/p.html"],
                          capture_output=True, text=True)
    return "without pages" not in done.stderr


def run_page(page, found, path):
    """Run the commands of a page. Returns what is wrong, and the commands left out."""
    texts = [command for block in found for command, _ in commands(block)]
    folder = Folder(path, page, texts)
    has_pages = tool_has_pages()
    problems, left_out = [], []
    for block in found:
        for command, output in commands(block):
            if not is_run(command):
                continue
            if (" picture " in command and not HAS_PICTURES or
                    ".html" in command and not has_pages):
                left_out.append(command)
                continue
            folder.provide(command)
            status, printed = folder.run(command)
            may_be = {0}
            if output and re.search(r"(?m)^isoatlas: (?!warning)", output):
                may_be = {1, 2, 3, 4}
            for where, part, _ in MAY_VIOLATE:
                if where == page and part in command:
                    may_be = {0, 1}
            if status not in may_be:
                problems.append(f"{block}: exit status {status}: {command}\n{printed}")
            elif output and without_times(output) != without_times(printed):
                problems.append(f"{block}: {command}\n--- on the page\n{output}"
                                f"--- printed\n{printed}")
    return problems, left_out


class Blocks(unittest.TestCase):
    """Every block is known: none can be added that no test covers."""

    def test_every_block_is_known(self):
        found = all_blocks()
        self.assertGreater(len(found), 100)
        problems = [problem for block in found for problem in problems_of_block(block)]
        self.assertFalse(problems, "\n" + "\n".join(problems))

    def test_lists_have_no_entry_without_use(self):
        found = all_blocks()
        for page, starts in TEXT_BLOCKS.items():
            for start in starts:
                self.assertTrue(
                    any(block.page == page and block.text.startswith(start) for block in found),
                    f"TEXT_BLOCKS: {page}: {start}")
        texts = [command for block in found if is_shell(block)
                 for command, _ in commands(block)]
        for pattern, _, where in NOT_RUN:
            self.assertTrue((ROOT / where).is_file(), where)
            self.assertTrue(any(re.match(pattern, text) for text in texts), f"NOT_RUN: {pattern}")
        for page, part, _ in MAY_VIOLATE:
            self.assertTrue(any(part in block.text for block in found if block.page == page), part)

    def test_tutorial_pages_run_every_block(self):
        """tests/python/test_pages.py runs them by page_commands.py, which finds fences only."""
        for page in sorted(TUTORIAL):
            text = (ROOT / page).read_text(encoding="utf-8")
            run = {text.count("\n", 0, match.start("code")) + 1: match
                   for match in page_commands.BLOCK.finditer(text)}
            for block in blocks_of_text(page, text):
                if not is_shell(block) and block.language != "python":
                    continue
                self.assertIn(block.line, run, f"{block}: page_commands.py does not find it")
                if run[block.line]["skip"]:
                    for command, _ in commands(block):
                        self.assertTrue(is_known(command), f"{block}: {command}")

    def test_python_is_run(self):
        for block in all_blocks():
            if block.language == "python":
                self.assertIn(block.page, PYTHON_PAGES | HOST_PAGES | TUTORIAL,
                              f"{block}: no test runs it")

    def test_cmake_is_run(self):
        """tests/install/install_test.py builds a program with each of them."""
        text = (ROOT / "tests/install/install_test.py").read_text(encoding="utf-8")
        self.assertIn('block.language == "cmake"', text)

    def test_unknown_blocks_are_found(self):
        text = ("Text\n\n    frobnicate a.nrrd\n\n- item\n\n      isoatlas info a.nrrd\n\n```\n"
                "one\n```\n```fortran\n```\n\n```sh\nisoatlas info a.nrrd\nrm -r b\n```\n\n"
                "    two\n")
        found = blocks_of_text("page.md", text)
        self.assertEqual([block.line for block in found], [3, 7, 10, 13, 16, 20])
        self.assertEqual(found[1].text, "isoatlas info a.nrrd\n")
        problems = [problem for block in found for problem in problems_of_block(block)]
        self.assertEqual([int(problem.split(":")[1]) for problem in problems],
                         [3, 10, 13, 16, 20])


class NotRun(unittest.TestCase):
    """Commands that do not run here name files, options, presets and programs that exist."""

    def listed(self):
        for block in all_blocks():
            if not is_shell(block):
                continue
            for command, _ in commands(block):
                if not is_run(command) and reason_not_to_run(command):
                    for part in re.split(r" *(?:&&|\|\||;|\|) *", command):
                        yield block, words(part)

    def test_names_exist(self):
        presets = json.loads((ROOT / "CMakePresets.json").read_text())
        presets = {preset["name"] for preset in presets["configurePresets"]} - {"base"}
        lists = "\n".join(path.read_text() for folder in ("tests", "bench", "src", "apps", "cmake")
                          for path in (ROOT / folder).rglob("*")
                          if path.name == "CMakeLists.txt" or path.suffix == ".cmake")
        lists += (ROOT / "CMakeLists.txt").read_text()
        dependencies = (ROOT / "scripts/install_dependencies.sh").read_text()
        checked = 0
        for block, line in self.listed():
            while line and "=" in line[0]:
                line = line[1:]
            if not line or line[0] in ("export", "sudo", "mkdir", "gmsh", "tetgen", "cat",
                                       "venv/bin/pip"):
                continue
            checked += 1
            where = f"{block}: {' '.join(line)}"
            if line[0].endswith("python3") and line[1] != "-m":
                line = line[1:]
            script = ROOT / line[0]
            if line[0].startswith(("scripts/", "bench/")):
                self.assertTrue(script.is_file() and os.access(script, os.X_OK), where)
                text = script.read_text()
                for word in line[1:]:
                    if word.startswith("--"):
                        self.assertIn(word, text, where)
            if line[0] == "scripts/install_dependencies.sh":
                self.assertIn(f"\n  {line[1]}) wanted=", dependencies, where)
            if "--preset" in line:
                self.assertIn(line[line.index("--preset") + 1], presets, where)
            for word in line:
                option = re.match(r"-D(ISOATLAS_\w+)=", word)
                if option:
                    self.assertRegex(lists, rf"(option|set)\({option[1]}\b", where)
                program = re.match(r"build/(\w+)/bin/(?:test_|peer_)?(\w+)$", word)
                if program:
                    self.assertIn(program[1], presets, where)
                    self.assertRegex(lists, rf"\b{program[2]}\b", where)
        self.assertGreater(checked, 20)

    def test_version_of_the_package(self):
        version = re.search(r"project\(isoatlas\s+VERSION ([\d.]+)",
                            (ROOT / "CMakeLists.txt").read_text())[1]
        for path in pages():
            for found in re.findall(r"isoatlas_([\d.]+)_amd64", path.read_text(encoding="utf-8")):
                self.assertEqual(found, version, path)

    def test_demo_runs_the_command_on_the_page(self):
        extract = r"build/release/bin/isoatlas extract (?:.*\\\n)*.*\n"
        found = {name: words(re.search(extract, (ROOT / name).read_text())[0])
                 for name in ("README.md", "scripts/demo.sh")}
        self.assertEqual(found["README.md"], found["scripts/demo.sh"])


@unittest.skipUnless(TOOL, "set ISOATLAS_TOOL to the path of the command line tool")
class Commands(unittest.TestCase):

    def test_commands_run_and_print_what_the_page_shows(self):
        ran = []
        for path in pages():
            page = str(path.relative_to(ROOT))
            text = path.read_text(encoding="utf-8")
            found = [block for block in blocks_of_text(page, text) if is_shell(block)]
            if page in TUTORIAL:  # only what tests/python/test_pages.py leaves out
                skipped = {text.count("\n", 0, match.start("code")) + 1
                           for match in page_commands.BLOCK.finditer(text) if match["skip"]}
                found = [block for block in found if block.line in skipped]
            if not found:
                continue
            with self.subTest(page=page), tempfile.TemporaryDirectory() as folder:
                problems, left_out = run_page(page, found, pathlib.Path(folder))
                for command in left_out:
                    print(f"{page}: left out: {command}")
                ran.append(page)
                self.assertFalse(problems, "\n" + "\n".join(problems))
        self.assertLessEqual({"README.md", "docs/reference/command-line.md", "docs/report.md"},
                             set(ran))

    def test_wrong_commands_are_found(self):
        text = ("```sh\nisoatlas info a.nrrd\nisoatlas check a.ply --frobnicate\n```\n\n"
                "    $ isoatlas info missing.tif\n    isoatlas: error: another text\n"
                "    $ isoatlas completion bash > a\n    text\n")
        with tempfile.TemporaryDirectory() as folder:
            problems, _ = run_page("page.md", blocks_of_text("page.md", text),
                                   pathlib.Path(folder))
        self.assertEqual(len(problems), 3, problems)
        self.assertIn("page.md:2: exit status 2: isoatlas check a.ply --frobnicate", problems[0])

    def options(self, command):
        page = subprocess.run([TOOL, *command.split(), "--help"], capture_output=True, text=True)
        self.assertEqual(page.returncode, 0, command)
        return set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", page.stdout))

    def test_commands_in_sentences(self):
        """`isoatlas ...` within a line: the command and its options exist."""
        options = {name: self.options(name) for name in
                   ("extract", "info", "view", "check", "levels", "report", "picture",
                    "completion", "blocks plan", "blocks run", "blocks merge")}
        checked = 0
        for path in pages():
            text = re.sub(r"(?ms)^ *```.*?^ *```$", "", path.read_text(encoding="utf-8"))
            for found in re.findall(r"`isoatlas\s+([^`]+)`", text):
                command, *rest = found.split()
                if command in ("COMMAND", "help") or not re.fullmatch(r"[a-z]+", command):
                    continue
                if command == "blocks":
                    command = " ".join([command, *rest[:1]])
                self.assertIn(command, options, f"{path}: isoatlas {found}")
                for word in rest:
                    if re.match(r"--?[a-z]", word):
                        self.assertIn(word.split("=")[0], options[command],
                                      f"{path}: isoatlas {found}")
                checked += 1
        self.assertGreater(checked, 20)

    def test_options_of_fragments(self):
        """The example of --refine in command-line.md, which shows options only."""
        (fragment,) = [block.text for block in all_blocks() if block.text.startswith("--refine ")]
        with tempfile.TemporaryDirectory() as name:
            folder = Folder(pathlib.Path(name), "", [])
            write_volume(folder.path / "a.nrrd", 0)
            status, printed = folder.run(
                f"isoatlas extract a.nrrd --iso 0 -q -o a.glb {fragment.strip()}")
        self.assertIn(status, (0, 1), printed)


@unittest.skipUnless((BUILD / "include").is_dir(), "set ISOATLAS_BUILD to the build folder")
class Cpp(unittest.TestCase):

    def test_blocks_compile(self):
        """tests/install/install_test.py also builds and runs them."""
        found = [block for block in all_blocks() if block.language == "cpp"]
        self.assertTrue(any(block.page == "README.md" for block in found))
        vtk = [f"-isystem{path}" for path in pathlib.Path("/usr/include").glob("vtk-*")]
        for block in found:
            with self.subTest(block=str(block)):
                if "<vtk" in block.text and not vtk:
                    self.skipTest("VTK's headers are not in /usr/include")
                done = subprocess.run(
                    [*shlex.split(CXX), "-std=c++20", "-fsyntax-only", "-Wall", "-x", "c++", "-",
                     f"-I{ROOT}/include", f"-I{BUILD}/include", *vtk], input=cpp_program(block),
                    capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr[-3000:])


if __name__ == "__main__":
    unittest.main()
