#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the isoatlas tool: cli_test.py TOOL [TestClass ...]. Needs only the standard library."""

import array
import base64
import hashlib
import json
import math
import os
import pathlib
import pty
import random
import re
import resource
import select
import shlex
import shutil
import signal
import stat
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

TOOL = pathlib.Path(sys.argv[1]).resolve()
DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "reference"
FIELD = pathlib.Path(__file__).resolve().parents[1] / "data" / "field"
MESH_EXTENSIONS = ["ply", "stl", "obj", "off", "vtp", "3mf", "gii"]
METRICS = [
    "max-distance", "mean-distance", "area-curvature", "area-curvature-smooth", "geodesic-ratio",
    "normal-angle"
]
SOFT = ["max-vertices", "min-vertices", "min-edge", "max-edge", "min-aspect"]

# -------------------------------------------------------------------------------------- volumes


def sphere(size, radius=0.35, inside=1.0):
    """Distances to a sphere around the middle, x fastest: positive inside; radius relative to x."""
    nx, ny, nz = size
    cx, cy, cz = ((n - 1) / 2 for n in size)
    return array.array(
        "f", (inside * (radius * nx - math.sqrt((x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2))
              for z in range(nz) for y in range(ny) for x in range(nx)))


def torus(n):
    """Positive inside a torus about the z axis: genus 1."""
    c = (n - 1) / 2
    return array.array("f", (0.12 * n - math.hypot(math.hypot(x - c, y - c) - 0.3 * n, z - c)
                             for z in range(n) for y in range(n) for x in range(n)))


def gyroid(n):
    """A surface of many triangles that is meshed quickly."""
    waves = [(math.sin(i / 4), math.cos(i / 4)) for i in range(n)]
    return bytes(
        int(128 + 40 * (sx * cy + sy * cz + sz * cx)) for sz, cz in waves for sy, cy in waves
        for sx, cx in waves)


MANY_TRIANGLES = [
    "--raw-type", "uint8", "--iso", "128.5", "--coarse", "--max-radius", "0.3vx",
    "--allow-self-intersections"
]


def tiff(samples, n):
    """An uncompressed stack of n pages of n x n bytes, each in one strip."""
    directory = 2 + 12 * 8 + 4
    out = bytearray(b"II*\0" + struct.pack("<I", 8))
    for page in range(n):
        start = len(out)
        entries = [(256, 4, n), (257, 4, n), (258, 3, 8), (259, 3, 1), (262, 3, 1),
                   (273, 4, start + directory), (278, 4, n), (279, 4, n * n)]
        out += struct.pack("<H", len(entries)) + b"".join(
            struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in entries)
        end = start + directory + n * n
        out += struct.pack("<I", end if page < n - 1 else 0)
        out += samples[page * n * n:(page + 1) * n * n]
    return bytes(out)


def nifti(samples, n):
    """n x n x n bytes in NIfTI-1, sform 1 x 1 x 1 mm."""
    header = bytearray(352)
    fields = [(0, "i", 348), (40, "8h", 3, n, n, n, 1, 1, 1, 1), (70, "hh", 2, 8),
              (76, "8f", *[1.0] * 8), (108, "f", 352.0), (123, "b", 2), (254, "h", 1),
              (280, "12f", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0), (344, "4s", b"n+1\0")]
    for at, kind, *values in fields:
        struct.pack_into("<" + kind, header, at, *values)
    return bytes(header) + samples


def little(samples):
    if sys.byteorder == "big":
        samples = array.array(samples.typecode, samples)
        samples.byteswap()
    return samples.tobytes()


def nrrd(samples, size, kind="float", *extra):
    if len(size) == 3 and not any(line.startswith(("spac", "thick", "axis")) for line in extra):
        extra = ("spacings: 1 1 1", *extra)  # without a spacing the tool warns
    header = [
        "NRRD0004", f"type: {kind}", f"dimension: {len(size)}",
        "sizes: " + " ".join(map(str, size)), "encoding: raw", "endian: little", *extra
    ]
    data = samples if isinstance(samples, bytes) else little(samples)
    return "\n".join(header).encode() + b"\n\n" + data


def off(positions, triangles):
    lines = ["OFF", f"{len(positions)} {len(triangles)} 0"]
    lines += ["%g %g %g" % p for p in positions] + ["3 %d %d %d" % t for t in triangles]
    return ("\n".join(lines) + "\n").encode()


TETRAHEDRON = ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3),
                                                              (2, 0, 3)])

# ----------------------------------------------------------------------------------------- base


def restore_signals():
    # Background jobs of a shell ignore Ctrl-C, and so would the tool, but these tests send Ctrl-C.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


class ToolTest(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="isoatlas-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def put(self, name, content):
        path = self.folder / name
        path.write_bytes(content)
        return path

    def put_sphere(self, name="sphere.nrrd", n=20, **options):
        return self.put(name, nrrd(sphere((n, n, n), **options), (n, n, n)))

    def files(self):
        return sorted(str(p.relative_to(self.folder)) for p in self.folder.rglob("*"))

    def run_tool(self, *arguments, locale="C.UTF-8", limit=None, **options):

        def prepare():
            restore_signals()
            if limit:
                resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

        environment = {**os.environ, "LC_ALL": locale, **options.pop("env", {})}
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
        return subprocess.run([str(TOOL), *map(str, arguments)], env=environment, cwd=self.folder,
                              preexec_fn=prepare, timeout=50, encoding="utf-8", **options)

    def succeed(self, *arguments, **options):
        result = self.run_tool(*arguments, **options)
        self.assertEqual((result.returncode, result.stderr), (0, ""), arguments)
        return result.stdout

    def fail_with(self, status, pattern, *arguments, **options):
        """The tool exits with `status`, prints one matching line on stderr and writes no file."""
        before = self.files()
        result = self.run_tool(*arguments, **options)
        self.assertEqual(result.returncode, status, result.stderr)
        self.assertRegex(result.stderr, r"\Aisoatlas: error: [^\n]+\n\Z")
        self.assertRegex(result.stderr, pattern)
        self.assertFalse(result.stdout)
        self.assertEqual(self.files(), before)
        return result.stderr

    def refuse(self, pattern, *arguments, **options):
        return self.fail_with(2, pattern, *arguments, **options)

    def refuse_volume(self, pattern, volume, *options, iso="0.5"):
        self.refuse(pattern, "extract", volume, "--iso", iso, "-o", "out.ply", "--report",
                    "out.json", *options)


# ---------------------------------------------------------------------------------------- tests


def options_in(text):
    return set(re.findall(r"(?<![\w-])(--?[a-z][a-z-]*)\b", text))


READING = ("--channel --time --layer --array --series --spacing --roi --max-memory --raw-size "
           "--raw-type --raw-spacing --raw-endian --raw-offset ")


class Help(ToolTest):
    OPTIONS = {
        "extract": "--iso --label --connectivity --save-field -o --output --format --report "
        "--inside --topology --coarse --max-radius --covering --event-persistence --threads "
        "--nan --space -q --quiet -v --verbose "
        "-h --help " + READING + "--levels --refine --max-distance --mean-distance "
        "--area-curvature --area-curvature-smooth --geodesic-ratio --normal-angle --max-vertices "
        "--min-vertices --min-edge --max-edge --min-aspect --border --placement --glb-per-level "
        "--measure --measure-samples --min-component-size --keep-components "
        "--keep-near --drop-near "
        "--interpolation --supersample --adaptive-supersample "
        "--allow-self-intersections --strict --html --neuroglancer --memory --block-size --parts",
        "info": "--json -h --help " + READING,
        "view": "--iso --inside --no-browser --port -q --quiet -h --help " + READING,
        "check": "--json --self-intersections --volume --iso --inside --topology --nan "
        "--interpolation --space --samples -h --help " + READING, "levels": "--json -h --help",
        "report": "-o --output -q --quiet -h --help",
        "picture": "-o --output --level --style --size --view --up --zoom -q --quiet -h --help",
        "completion": "-h --help",
        "blocks-run": "--blocks --threads -q --quiet -h --help",
        "blocks-merge": "--threads -q --quiet -v --verbose -h --help",
    }
    OPTIONS["blocks-plan"] = OPTIONS["extract"]

    def test_pages_have_every_section_and_option(self):
        for command, options in self.OPTIONS.items():
            page = self.succeed(command, "--help")
            for title in [
                    "NAME", "SYNOPSIS", "DESCRIPTION", "INPUT", "RUNNING", "EXAMPLES",
                    "EXIT STATUS", "FILES"
            ]:
                self.assertRegex(page, rf"(?m)^{title}$", command)
            listed = options_in("\n".join(re.findall(r"(?m)^    (-.*)$", page)))
            self.assertEqual(listed, set(options.split()), command)
            self.assertLessEqual(max(map(len, page.splitlines())), 80, command)
            self.assertFalse(re.search(r"(?m)[ \t]$", page), "trailing blanks")
        for title in ["INPUT", "SURFACE", "MESH", "LEVELS", "OUTPUT", "RUNNING"]:
            self.assertIn(f"\n{title}\n", self.succeed("extract", "-h"))

    def test_common_options_of_extract_are_on_the_first_screen(self):
        screen = self.succeed("extract", "--help").splitlines()[:24]
        start = screen.index("COMMON OPTIONS")
        names = [line.split()[0].rstrip(",") for line in screen[start:] if line.startswith("    -")]
        self.assertEqual(names, ["--iso", "-o", "--max-distance", "--levels", "--report", "--html"])
        self.assertTrue(any(line.startswith("    isoatlas extract ") for line in screen[start:]),
                        "an example")

    def test_main_page_names_the_commands(self):
        page = self.succeed("--help")
        for command in self.OPTIONS:
            self.assertRegex(page, rf"(?m)^    {command.replace('-', ' ')} ")

    def test_version(self):
        for words in (["--version"], ["version"], ["-V"]):
            self.assertRegex(self.succeed(*words), r"\Aisoatlas \d+\.\d+\.\d+\n\Z")

    def test_all_ways_to_request_help(self):
        self.assertEqual(self.succeed("help"), self.succeed("--help"))
        for command in self.OPTIONS:
            page = self.succeed(command, "--help")
            for words in (["help", command], ["--help", command], ["-h", command], [
                    command, "help"
            ], [command, "-h"], [command, "nowhere", "--frobnicate", "--help"]):
                self.assertEqual(self.succeed(*words), page, words)

    def test_command_line_page_documents_every_option(self):
        text = (DOCS / "command-line.md").read_text(encoding="utf-8")
        for command, options in self.OPTIONS.items():
            if command == "blocks-plan":  # its options are those of extract
                continue
            title = command.replace("-", " ")
            section = re.search(rf"(?ms)^## isoatlas {title}$(.*?)(?=^## |\Z)", text)
            self.assertIsNotNone(section, command)
            in_tables = "\n".join(re.findall(r"(?m)^\| (.*?) \|", section.group(1)))
            self.assertEqual(options_in(in_tables), set(options.split()), command)

    def test_errors_page_documents_every_status(self):
        text = (DOCS / "errors.md").read_text(encoding="utf-8")
        statuses = set(map(int, re.findall(r"(?m)^\| (\d+) \|", text)))
        self.assertEqual(statuses, {0, 1, 2, 3, 4, 129, 130, 143})


class Reading(ToolTest):

    def test_json_has_the_documented_keys(self):
        self.put_sphere()
        found = json.loads(self.succeed("info", "sphere.nrrd", "--json"))
        keys = {key for key in leaves(found) if not key.startswith("volume.")} | {"volume"}
        self.assertEqual(keys, documented("isoatlas-info-1"))
        self.assertEqual(found["volume"]["format"], "NRRD")
        self.assertEqual(found["volume"]["path"], "sphere.nrrd")

    def test_the_digest_is_that_of_the_samples(self):
        samples = bytes(range(64))
        self.put("a.raw", samples)
        raw = ["--raw-size", "4,4,4", "--raw-type", "uint8"]
        found = json.loads(self.succeed("info", "a.raw", "--json", *raw))["volume"]["sha256"]
        self.assertEqual(found, hashlib.sha256(samples).hexdigest())
        self.assertIn(found, self.succeed("info", "a.raw", *raw))
        self.put("big.raw", struct.pack(">32h", *range(32)))
        found = json.loads(
            self.succeed("info", "big.raw", "--json", "--raw-size", "4,4,2", "--raw-type", "int16",
                         "--raw-endian", "big"))
        self.assertEqual(found["volume"]["sha256"],
                         hashlib.sha256(struct.pack("<32h", *range(32))).hexdigest())

    def test_raw_offset_skips_bytes_before_headerless_samples(self):
        self.put("a.raw", b"header of 20 bytes.." + bytes(range(64)))
        raw = ["--raw-size", "4,4,4", "--raw-type", "uint8"]
        self.assertRegex(self.succeed("info", "a.raw", *raw, "--raw-offset", "20"),
                         r"range +0 to 63\n")
        self.refuse("has 84 bytes, but after an offset of 10 4 x 4 x 4 samples", "info", "a.raw",
                    *raw, "--raw-offset", "10")

    def test_spacing_overrides_the_file_and_may_have_a_unit(self):
        self.put_sphere()
        self.assertRegex(self.succeed("info", "sphere.nrrd", "--spacing", "1,2,3"),
                         r"spacing +1 2 3\n")
        self.assertRegex(self.succeed("info", "sphere.nrrd", "--spacing", "0.2,0.2,1um"),
                         r"spacing +0.2 0.2 1 um\n")
        self.refuse("--spacing.*three positive numbers", "info", "sphere.nrrd", "--spacing", "1,1")
        self.refuse("--spacing.*three positive numbers", "info", "sphere.nrrd", "--spacing",
                    "1,1,1furlong")

    def test_memory_limit(self):
        self.put_sphere()
        self.fail_with(4, "more than the limit of 1000", "info", "sphere.nrrd", "--max-memory",
                       "1000")
        self.refuse("--max-memory.*a size like 8GiB", "info", "sphere.nrrd", "--max-memory", "much")


class Blocks(ToolTest):
    """Volumes in blocks."""

    EXTRACT = ["sphere.nrrd", "--iso", "0", "--refine", "max-distance:1vx", "--refine",
               "max-distance:0.4vx"]
    CUT = ["--block-size", "9,8,10"]

    def setUp(self):
        super().setUp()
        self.put_sphere()

    def plan(self, *more):
        return self.succeed("blocks", "plan", *self.EXTRACT, *self.CUT, "-o", "p.glb", "--report",
                            "p.json", "--parts", "parts", *more)

    def test_all_ways_give_the_same_bytes(self):
        self.succeed("extract", *self.EXTRACT, *self.CUT, "-o", "a.glb", "--report", "a.json", "-q")
        text = self.plan()
        self.assertRegex(text, r"\A\d+ blocks of up to 9 x 8 x 10 grid cells\. Next:\n"
                         r"  isoatlas blocks run parts\n  isoatlas blocks merge parts\n\Z")
        count = int(text.split()[0])
        self.assertGreater(count, 8)
        self.succeed("blocks", "run", "parts", "--blocks", f"3:{count - 1}", "--threads", "1")
        self.refuse(f"blocks 0, 1 and 2 of {count} missing; make them with "
                    "`isoatlas blocks run ", "blocks", "merge", "parts")
        self.assertFalse((self.folder / "p.glb").exists())
        self.assertEqual(self.succeed("blocks", "run", "parts"),
                         f"{count} of {count} blocks made\n")
        self.assertIn(f"{count} blocks of up to 9 x 8 x 10 grid cells",
                      self.succeed("blocks", "merge", "parts"))
        self.assertEqual((self.folder / "a.glb").read_bytes(),
                         (self.folder / "p.glb").read_bytes())
        self.succeed("extract", *self.EXTRACT, *self.CUT, "--parts", "others", "-o", "o.glb", "-q")
        self.assertEqual((self.folder / "a.glb").read_bytes(),
                         (self.folder / "o.glb").read_bytes())
        one, other = (json.loads((self.folder / name).read_text()) for name in ("a.json", "p.json"))
        self.assertEqual(one["blocks"]["size"], [9, 8, 10])
        self.assertEqual(one["blocks"], other["blocks"])
        self.succeed("extract", *self.EXTRACT, "-o", "w.glb", "--report", "w.json", "-q")
        whole = json.loads((self.folder / "w.json").read_text())
        self.assertIsNone(whole["blocks"])
        for level in one["levels"]:
            for key in ("components", "genus", "boundary_loops", "kinds"):
                self.assertEqual(level[key], whole["reference"][key])
            self.assertEqual(level["self_intersections"], 0)
        for level, bound in zip(one["levels"][1:], (1.0, 0.4)):
            self.assertLessEqual(level["distance_at_most"] - level["rounding"], bound)

    def test_a_killed_run_loses_only_the_block_that_it_was_making(self):
        count = int(self.plan().split()[0])
        run = subprocess.Popen([TOOL, "blocks", "run", "parts", "-q"], cwd=self.folder)
        parts = self.folder / "parts"
        deadline = time.monotonic() + 60
        while len(list(parts.glob("*.mesh"))) < 3 and time.monotonic() < deadline:
            time.sleep(0.001)
        run.kill()
        run.wait()
        made = {path: path.stat().st_mtime_ns for path in parts.glob("*.mesh")}
        self.assertGreaterEqual(len(made), 3)
        self.succeed("blocks", "run", "parts", "-q")
        self.assertEqual(len(list(parts.glob("*.mesh"))), count)
        for path, when in made.items():
            self.assertEqual(path.stat().st_mtime_ns, when, path.name)
        self.succeed("blocks", "merge", "parts", "-q")
        self.succeed("extract", *self.EXTRACT, *self.CUT, "-o", "a.glb", "-q")
        self.assertEqual((self.folder / "a.glb").read_bytes(),
                         (self.folder / "p.glb").read_bytes())

    def test_an_interrupted_run_keeps_its_blocks(self):
        self.plan()
        run = subprocess.Popen([str(TOOL), "blocks", "run", "parts"], cwd=self.folder,
                               stderr=subprocess.PIPE, encoding="utf-8", preexec_fn=restore_signals)
        deadline = time.monotonic() + 60
        while not list(self.folder.glob("parts/*.mesh")) and time.monotonic() < deadline:
            time.sleep(0.001)
        run.send_signal(signal.SIGINT)
        _, message = run.communicate(timeout=20)
        if run.returncode == 0:  # it was too fast
            return
        self.assertEqual(run.returncode, 130)
        self.assertEqual(message, "isoatlas: interrupted; the meshes of finished blocks are kept\n")
        self.assertTrue(list(self.folder.glob("parts/*.mesh")))

    def test_runs_share_the_work(self):
        self.plan()
        runs = [subprocess.Popen([TOOL, "blocks", "run", "parts", "-q", "--threads", "1"],
                                 cwd=self.folder) for _ in range(3)]
        self.assertEqual([run.wait() for run in runs], [0, 0, 0])
        self.succeed("blocks", "run", "parts", "-q")
        self.succeed("blocks", "merge", "parts", "-q")
        self.assertEqual(sorted(path.suffix for path in (self.folder / "parts").iterdir()
                                if path.suffix != ".mesh"), [".json"])

    def test_changed_samples_are_meshed_again(self):
        self.plan()
        self.succeed("blocks", "run", "parts", "-q")
        before = (self.folder / "parts/block-000000.mesh").read_bytes()
        volume = self.folder / "sphere.nrrd"
        data = bytearray(volume.read_bytes())
        data[-4:] = b"\0\0\0\0"  # the last sample of the last block
        volume.write_bytes(data)
        self.succeed("blocks", "run", "parts", "-q")
        self.assertEqual((self.folder / "parts/block-000000.mesh").read_bytes(), before)

    def test_bad_input(self):
        self.plan()
        self.refuse("parts/plan.json: is the plan of another run", "blocks", "plan", *self.EXTRACT,
                    "-o", "p.glb", "--block-size", "8", "--parts", "parts")
        self.succeed("blocks", "run", "parts", "-q")
        part = self.folder / "parts/block-000001.mesh"
        data = part.read_bytes()
        for damaged in (data[:-1], data[:40], b"", data[:-3] + b"abc"):
            part.write_bytes(damaged)
            self.refuse(r"block-000001\.mesh: is (damaged|not the file of a block); delete it and "
                        "make its block again", "blocks", "merge", "parts")
        version = re.search(rb" (\S+) ", data)[1]
        part.write_bytes(data.replace(version, b"0.0.9", 1))
        self.refuse(r"block-000001.mesh: was made by isoatlas 0\.0\.9, expected ", "blocks",
                    "merge", "parts")
        self.succeed("blocks", "run", "parts", "-q")  # makes it again
        self.succeed("blocks", "merge", "parts", "-q")
        part.write_bytes((self.folder / "parts/block-000002.mesh").read_bytes())
        self.refuse("block-000001.mesh: is the file of block 2", "blocks", "merge", "parts")
        self.refuse("nowhere: has no plan.json", "blocks", "run", "nowhere")
        self.refuse("--blocks: the plan has the blocks 0 to 17, found 999", "blocks", "run",
                    "parts", "--blocks", "999")
        (self.folder / "parts/plan.json").write_text("{}")
        self.refuse("plan.json: is not a plan", "blocks", "run", "parts")
        extract = ["extract", "sphere.nrrd", "--iso", "0", "-o", "a.ply", "--block-size"]
        self.refuse("a choice of components cannot be had in blocks", *extract, "8",
                    "--keep-components", "1")
        self.refuse("--block-size: expected one or three numbers of grid cells", *extract, "8,8")
        self.refuse("--memory excludes --block-size", *extract, "8", "--memory", "1G")
        self.refuse("expected a size like 8GiB or 500MB", *extract[:-1], "--memory", "much")
        self.refuse("expected numbers of blocks like 0:9", "blocks", "run", "parts", "--blocks",
                    "9:0")
        self.refuse("there is no command 'blocks'", "blocks")
        self.refuse("--parts is missing", "blocks", "plan", "sphere.nrrd", "--iso", "0", "-o",
                    "a.ply")


class Labels(ToolTest):
    """Segmentations: --label in place of --iso."""

    def setUp(self):
        super().setUp()
        n, centre = 20, 9.3
        labels = []
        for z in range(n):
            for y in range(n):
                for x in range(n):
                    distance = math.dist((x, y, z), (centre, centre, centre))
                    labels.append(0 if distance > 7 else 2 if x < 9 else 5)
        self.put("labels.nrrd", nrrd(bytes(labels), (n, n, n), "unsigned char"))

    def volume_of(self, *labels):
        wanted = [word for label in labels for word in ("--label", str(label))]
        self.succeed("extract", "labels.nrrd", *wanted, "--max-distance", "0.2vx", "-o", "m.ply",
                     "--report", "m.json")
        report = json.loads((self.folder / "m.json").read_text())
        self.assertEqual(report["reference"]["components"], 1)
        return report["levels"][-1]["extent"]["volume"]

    def test_labels_are_smooth_and_their_union_is_one_part(self):
        ball = 4 / 3 * math.pi * 7**3
        self.assertAlmostEqual(self.volume_of(2, 5) / ball, 1, delta=0.08)
        halves = self.volume_of(2) + self.volume_of(5)
        self.assertLess(halves, ball)

    def test_the_field_is_a_volume_with_the_same_counts(self):
        self.succeed("extract", "labels.nrrd", "--label", "2", "-o", "m.ply", "--save-field",
                     "field.nrrd", "--report", "m.json")
        report = json.loads((self.folder / "m.json").read_text())
        checked = json.loads(self.succeed("check", "m.ply", "--volume", "field.nrrd", "--iso", "0",
                                          "--topology", "faces", "--json"))
        self.assertEqual(checked["components"], report["reference"]["components"])
        self.assertLess(checked["distance"]["maximum"], 0.75)
        self.succeed("extract", "field.nrrd", "--iso", "0", "--topology", "faces", "-o", "same.ply")
        self.assertEqual((self.folder / "m.ply").read_bytes(),
                         (self.folder / "same.ply").read_bytes())

    def test_samples_that_touch_at_an_edge(self):
        two = bytearray(5 * 5 * 5)
        two[2 + 5 * (2 + 5 * 2)] = two[3 + 5 * (3 + 5 * 2)] = 1
        self.put("two.nrrd", nrrd(bytes(two), (5, 5, 5), "unsigned char"))
        for connectivity, count in [("18", "1 component,"), ("6", "2 components,")]:
            printed = self.succeed("extract", "two.nrrd", "--label", "1", "--connectivity",
                                   connectivity, "-o", "two.ply")
            self.assertIn(count, printed)

    def test_what_does_not_go_together(self):
        for words, expected in [
            (["--iso", "3", "--label", "2"], "--iso excludes --label"),
            (["--label", "2", "--inside", "below"], "--label excludes --inside"),
            (["--label", "2", "--topology", "trilinear"], "--label excludes --topology"),
            (["--label", "2.5"], "--label: expected the whole number of a label, got '2.5'"),
            (["--iso", "2", "--save-field", "f.nrrd"], "--save-field requires --label"),
            (["--label", "2", "--save-field", "f.nii"],
             "--save-field: expected a name that ends in .nrrd, got 'f.nii'"),
            (["--label", "2", "--connectivity", "26"], "--connectivity: expected one of 18, 6"),
            (["--label", "3"], "no sample has the label 3; the labels are 0, 2, 5"),
            (["--label", "2", "--block-size", "8"],
             "--label needs the whole volume in memory, not blocks"),
            ([], "--iso is missing"),
        ]:
            self.refuse(re.escape(expected), "extract", "labels.nrrd", *words, "-o", "m.ply")


class Units(ToolTest):
    BASE = ["extract", "sphere.nrrd", "--iso", "0", "-q", "-o", "a.ply"]

    def test_a_unit_needs_a_volume_that_states_one(self):
        self.put_sphere()
        self.refuse(
            "sphere.nrrd: max-distance: mm cannot be converted, the volume states no unit; .* "
            "spacing with a unit", *self.BASE, "--max-distance", "1mm")
        self.refuse("sphere.nrrd: min-component-size: mm cannot", *self.BASE,
                    "--min-component-size", "1mm3")

    def test_lengths_are_converted_and_named(self):
        self.put_sphere()
        um = ["--spacing", "2,2,2um", "--report", "r.json"]
        bounds = []
        for length in ("1", "1um", "1000nm", "0.001mm", "0.5vx", "1e-6 m"):
            self.succeed(*self.BASE, *um, "--max-distance", length)
            report = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            bounds.append(report["parameters"]["refine"][0][0]["bound"])
            self.assertEqual(report["input"]["unit"], "um")
        self.assertLess(max(bounds) / min(bounds) - 1, 1e-12)
        printed = self.succeed(*[a for a in self.BASE if a != "-q"], *um, "--max-distance",
                               "1000nm")
        self.assertRegex(printed, r"max-distance [0-9.]+ um")
        self.assertRegex(printed, r"spacing 2 x 2 x 2 um")


class Extract(ToolTest):

    def test_sphere_from_nrrd(self):
        self.put_sphere()
        printed = self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "--coarse")
        self.assertIn("1 component, genus 0, 0 boundary loops, Euler characteristic 2", printed)
        self.assertRegex(
            printed,
            r"(?m)certificate +passed.*; counted again: same topology, orientation and nesting$")
        self.assertIn("s.ply", printed)
        self.assertLessEqual(len(printed.splitlines()), 8)
        self.assertEqual(self.files(), ["s.ply", "sphere.nrrd"])

    def test_raw_samples_of_every_type_and_byte_order_give_the_same_topology(self):
        n = 16
        codes = {
            "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
            "int64": "q", "uint64": "Q", "float32": "f", "float64": "d"
        }
        values = [int(min(max(60 + 8 * s, 0), 120)) for s in torus(n)]
        for order, mark in (("little", "<"), ("big", ">")):
            for kind, code in codes.items():
                self.put("t.raw", struct.pack(f"{mark}{n ** 3}{code}", *values))
                printed = self.succeed("extract", "t.raw", "--raw-size", f"{n},{n},{n}",
                                       "--raw-type", kind, "--raw-endian", order, "--raw-spacing",
                                       "1,1,1", "--iso", "60.5", "-o", "t.off", "--coarse")
                self.assertIn("1 component, genus 1, 0 boundary loops", printed, (kind, order))

    def test_surface_that_leaves_the_volume_has_a_boundary_loop(self):
        n = 16
        ramp = array.array("f", (x + 0.1 * y for z in range(n) for y in range(n) for x in range(n)))
        self.put("half.nrrd", nrrd(ramp, (n, n, n)))
        self.assertIn(
            "1 component, genus 0, 1 boundary loop, Euler characteristic 1",
            self.succeed("extract", "half.nrrd", "--iso", "7.3", "-o", "h.ply", "--coarse"))

    def test_same_bytes_again_and_with_any_number_of_threads(self):
        self.put("noise.raw", random.Random(7).randbytes(20 ** 3))
        arguments = [
            "extract", "noise.raw", "--raw-size", "20,20,20", "--raw-type", "uint8", "--iso",
            "140.5", "-q", "--coarse"
        ]
        meshes = []
        for i, threads in enumerate(("1", "1", "2", "0")):
            self.assertEqual(self.succeed(*arguments, "--threads", threads, "-o", f"{i}.ply"), "")
            meshes.append((self.folder / f"{i}.ply").read_bytes())
        for mesh in meshes[1:]:
            self.assertEqual(mesh, meshes[0])

    def test_lengths_in_world_units_and_voxels(self):
        self.put(
            "s.nrrd",
            nrrd(
                sphere((20, 20, 20)), (20, 20, 20), "float",
                "space: left-posterior-superior\nspace units: \"mm\" \"mm\" \"mm\"\nspace "
                "directions: (2,0,0) (0,2,0) (0,0,2)"))
        meshes = []
        for length in ("6", "6mm", "3vx", "+6", "6e0mm", "6 mm", "6000um", "0.6cm", "0.006m",
                       "6e6 nm"):
            self.succeed("extract", "s.nrrd", "--iso", "0", "--max-radius", length,
                         "--event-persistence", length, "-o", "s.off", "-q", "--coarse")
            meshes.append((self.folder / "s.off").read_bytes())
        self.assertEqual(len(set(meshes)), 1)
        self.succeed("extract", "s.nrrd", "--iso", "0", "--event-persistence", "0", "-o", "s.off",
                     "-q", "--coarse")

    def test_covering(self):
        self.put_sphere(n=24)
        arguments = ["extract", "sphere.nrrd", "--iso", "0", "--coarse", "-q", "--report", "s.json"]
        meshes, coverings = {}, {}
        for name in (None, "sizing-field", "halving"):
            self.succeed(*arguments, *(["--covering", name] if name else []), "-o", "s.off")
            meshes[name] = (self.folder / "s.off").read_bytes()
            report = json.loads((self.folder / "s.json").read_text())
            coverings[name] = report["parameters"]["covering"]
            self.assertIs(report["levels"][0]["certificate"]["passed"], True)
            self.assertEqual(report["levels"][0]["kinds"],
                             [{"genus": 0, "boundary_loops": 0, "count": 1}])
        self.assertEqual(
            coverings, {None: "sizing-field", "sizing-field": "sizing-field", "halving": "halving"})
        self.assertEqual(meshes[None], meshes["sizing-field"])
        self.assertNotEqual(meshes[None], meshes["halving"])
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "--covering", "halving", "--refine",
                     "max-distance:0.5vx", "-o", "s.off", "-q")

    def test_inside_below_is_the_negated_volume(self):
        self.put_sphere("a.nrrd")
        self.put_sphere("b.nrrd", inside=-1.0)
        self.succeed("extract", "a.nrrd", "--iso", "0.25", "-o", "a.off", "-q", "--coarse")
        self.succeed("extract", "b.nrrd", "--iso", "-0.25", "--inside", "below", "-o", "b.off",
                     "-q", "--coarse")
        self.assertEqual((self.folder / "a.off").read_bytes(), (self.folder / "b.off").read_bytes())

    def test_topology(self):
        # Two opposite corners of a grid cell. The saddle between them is exactly at the isovalue,
        # so they are connected.
        self.put("cell.nrrd",
                 nrrd(array.array("f", [3, -1, -1, -1, -1, -1, -1, 3]), (2, 2, 2), "float"))
        for options, tunnels, components in (([], 1, 1), (["--topology", "faces"], 0, 2), ([
                "--topology", "trilinear"
        ], 1, 1)):
            self.succeed("extract", "cell.nrrd", "--iso", "0", "-o", "c.off", "--report", "c.json",
                         "-q", "--coarse", *options)
            report = json.loads((self.folder / "c.json").read_text())
            self.assertEqual(report["surface"]["topology"], "trilinear" if tunnels else "faces")
            self.assertEqual(report["reference"]["tunnels"], tunnels)
            self.assertEqual(report["levels"][-1]["components"], components)
            self.assertEqual(report["levels"][-1]["boundary_loops"], 2)

    def test_interpolation(self):
        self.put("s.nrrd", nrrd(sphere((20, 20, 20)), (20, 20, 20), "float"))
        reports, distances = {}, {}
        for name in ("trilinear", "tricubic"):
            self.succeed("extract", "s.nrrd", "--iso", "0", "-o", f"{name}.off", "--report",
                         "s.json", "-q", "--interpolation", name)
            reports[name] = json.loads((self.folder / "s.json").read_text())
            self.assertEqual(reports[name]["parameters"]["interpolation"], name)
            check = self.succeed("check", "--json", f"{name}.off", "--volume", "s.nrrd", "--iso",
                                 "0", "--interpolation", name)
            distances[name] = json.loads(check)["distance"]
            self.assertEqual(distances[name]["interpolation"], name)
        self.assertEqual(reports["trilinear"]["reference"], reports["tricubic"]["reference"])
        self.assertNotEqual(distances["trilinear"]["mean"], distances["tricubic"]["mean"])
        self.assertIn(
            "to the tricubic isosurface",
            self.succeed("check", "tricubic.off", "--volume", "s.nrrd", "--iso", "0",
                         "--interpolation", "tricubic"))

    def test_supersample(self):
        self.put("s.nrrd", nrrd(sphere((20, 20, 20)), (20, 20, 20), "float"))
        for name in ("trilinear", "tricubic"):
            c_vertices = {}
            for factor in (1, 3):
                self.succeed("extract", "s.nrrd", "--iso", "0", "-o", "s.off", "--report", "s.json",
                             "-q", "--interpolation", name, "--supersample", factor)
                report = json.loads((self.folder / "s.json").read_text())
                self.assertEqual(report["parameters"]["supersample"], factor)
                self.assertEqual(report["reference"]["kinds"],
                                 [{"genus": 0, "boundary_loops": 0, "count": 1}])
                c_vertices[factor] = report["reference"]["c_vertices"]
                distance = json.loads(
                    self.succeed("check", "--json", "s.off", "--volume", "s.nrrd", "--iso", "0",
                                 "--space", "lps", "--interpolation", name))["distance"]
                self.assertLess(distance["surface_to_mesh"]["voxels"]["maximum"], 0.6)
            self.assertAlmostEqual(c_vertices[3] / c_vertices[1], 9, delta=1)
        self.refuse(
            "supersampling 1000 times makes more samples than the limit of 2.36: expected 154 "
            "times at most", "extract", "s.nrrd", "--iso", "0", "-o", "t.off", "--supersample",
            "1000")

    def test_spaces(self):
        self.put(
            "s.nrrd",
            nrrd(sphere((20, 20, 20)), (20, 20, 20), "float", "space: left-posterior-superior",
                 "space directions: (2,0,0) (0,2,0) (0,0,2)", "space origin: (100,200,300)"))
        positions = {}
        for space in ("lps", "ras", "voxel"):
            self.succeed("extract", "s.nrrd", "--iso", "0", "--space", space, "-o", "s.off", "-q",
                         "--coarse")
            positions[space] = off_positions((self.folder / "s.off").read_text())
        self.assertGreater(len(positions["voxel"]), 3)
        for (x, y, z), lps, ras in zip(positions["voxel"], positions["lps"], positions["ras"],
                                       strict=True):
            world = (100 + 2 * x, 200 + 2 * y, 300 + 2 * z)
            for found, sign, wanted in zip(lps + ras, (1, 1, 1, -1, -1, 1), world + world):
                self.assertAlmostEqual(found, sign * wanted, places=2)

    def test_nan_on_one_side(self):
        samples = sphere((12, 12, 12))
        samples[5] = math.nan
        samples[7] = -math.inf
        self.put("n.nrrd", nrrd(samples, (12, 12, 12)))
        self.succeed("extract", "n.nrrd", "--iso", "0", "-o", "a.ply", "--nan", "below", "--coarse")
        self.assertIn(
            "2 components",
            self.succeed("extract", "n.nrrd", "--iso", "0", "-o", "b.ply", "--nan", "above",
                         "--coarse"))

    def test_sheared_grid_is_meshed_but_not_refined(self):
        self.put(
            "s.nrrd",
            nrrd(sphere((20, 20, 20)), (20, 20, 20), "float", "space: left-posterior-superior",
                 "space directions: (1,0,0) (0.7,1,0) (0,0,1)", "space origin: (0,0,0)"))
        arguments = ["extract", "s.nrrd", "--iso", "0", "-o", "s.ply"]
        for options in ([], ["--space", "voxel"], ["--coarse", "--max-vertices",
                                                   "9"], ["--coarse", "--measure"]):
            self.refuse(
                r"s\.nrrd: the grid is sheared \(its x and y axes are at 55 degrees\).*--coarse",
                *arguments, *options)
        self.succeed(*arguments, "--coarse")

    def test_a_violated_default_bound_does_not_change_the_exit_status(self):
        self.put("s.nrrd", nrrd(sphere((20, 20, 20)), (20, 20, 20), "float"))
        arguments = [
            "extract", "s.nrrd", "--iso", "0", "-o", "n.ply", "--report", "r.json",
            "--max-vertices", "12"
        ]
        self.assertRegex(self.succeed(*arguments),
                         r"level 1 .*; violated: max-distance \(default 0\.5\)")
        distance = json.loads((self.folder / "r.json").read_text())["levels"][1]["constraints"][1]
        self.assertEqual((distance["quantity"], distance["satisfied"], distance["default"]),
                         ("max-distance", False, True))
        requested = self.run_tool(*arguments, "--max-distance", "0.5vx")
        self.assertRegex(requested.stderr,
                         r"\Aisoatlas: level 1: max-distance 0\.5: reached [^\n]+\n\Z")
        self.assertEqual(requested.returncode, 1)

    def test_measured_distance_is_in_the_line_of_the_level(self):
        self.put_sphere()
        arguments = [
            "extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "--measure-samples", "1000",
            "--refine"
        ]
        printed = self.succeed(*arguments, "max-distance:1vx")
        for level in (0, 1):
            self.assertRegex(
                printed,
                rf"level {level} .*, measured at most [\d.]+ \(99 % within [\d.]+\), aspect")
        self.assertNotIn("above the bound", printed)
        self.assertRegex(
            self.run_tool(*arguments, "max-distance:0.0001vx").stdout,
            r"measured at most [^,]+, above the bound 0\.0001, aspect")

    def test_distances_are_labelled_proved_or_sampled(self):
        self.put_sphere()
        arguments = ["extract", "sphere.nrrd", "--iso", "0", "-o", "s.glb", "--report", "s.json"]
        proved = (r"proved: no point of the mesh is farther than 0\.50000\d* from the isosurface, "
                  r"nor of the isosurface from the mesh")
        measured = r"sampled at 1,\d\d\d points \([\d.]+ per voxel face\) of the mesh"
        sampled = r"sampled at .*about 2 .*per voxel face"
        measure, cubic = ("--measure-samples", "1000"), ("--interpolation", "tricubic")
        requested = ("--max-distance", "0.5")
        for options, expected in (((), sampled), (measure, measured), (requested, proved),
                                  (requested + cubic, sampled), (requested + measure,
                                                                 rf"{proved}; {measured}")):
            self.assertRegex(self.succeed(*arguments, *options), rf"(?m)^  distances +{expected}")
            for levels in ("s.glb", "s.json"):
                self.assertRegex(self.succeed("levels", levels), rf"(?m)^  distances +{expected}")
        measured = json.loads(self.succeed("levels", "s.glb", "--json"))["levels"][-1]["measured"]
        self.assertEqual(
            measured["maximum"],
            max(measured[side]["maximum"] for side in ("mesh_to_surface", "surface_to_mesh")))
        self.succeed(*arguments, "--coarse")
        self.assertNotIn("sampled", self.succeed("levels", "s.json"))

    def test_quiet_and_verbose(self):
        self.put_sphere()
        arguments = ["extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "--coarse"]
        self.assertEqual(self.succeed(*arguments, "-q"), "")
        verbose = self.succeed(*arguments, "-v")
        for word in ("surface", "coarsen", "cover", "certify", "repair", "memory"):
            self.assertIn(word, verbose)
        self.assertGreater(len(verbose.splitlines()), len(self.succeed(*arguments).splitlines()))


def off_positions(text):
    words = " ".join(line.split("#")[0] for line in text.splitlines()).split()
    count = int(words[1])
    numbers = list(map(float, words[4:4 + 3 * count]))
    return list(zip(numbers[0::3], numbers[1::3], numbers[2::3]))


class Outputs(ToolTest):

    def test_every_format_passes_check(self):
        self.put_sphere()
        for extension in MESH_EXTENSIONS:
            self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", f"s.{extension}", "-q",
                         "--coarse")
            checked = json.loads(self.succeed("check", f"s.{extension}", "--json"))
            self.assertEqual((checked["euler_characteristic"], checked["boundary_edges"]), (2, 0),
                             extension)
        self.assertEqual(len(self.files()), 1 + len(MESH_EXTENSIONS))

    def test_existing_files_are_replaced_and_links_followed(self):
        self.put_sphere()
        self.put("old.ply", b"old")
        (self.folder / "link.ply").symlink_to("old.ply")
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "link.ply", "-q", "--coarse")
        self.assertTrue((self.folder / "link.ply").is_symlink())
        self.succeed("check", "old.ply")

    def test_mesh_has_usual_permissions(self):
        self.put_sphere()
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "--report", "s.json",
                     "-q", "--coarse")
        plain = stat.S_IMODE(self.put("plain", b"").stat().st_mode)
        for name in ("s.ply", "s.json"):
            self.assertEqual(stat.S_IMODE((self.folder / name).stat().st_mode), plain)

    def test_a_failed_run_leaves_the_old_files(self):
        self.put_sphere()
        old = self.put("s.ply", b"old")
        self.refuse("range", "extract", "sphere.nrrd", "--iso", "1000", "-o", "s.ply")
        self.assertEqual(old.read_bytes(), b"old")

    def put_far_noise(self):
        """A volume so far from the origin that float32 rounds by up to a fortieth of a voxel.

        Rounding makes triangles of an .stl intersect, but not those of a .ply.
        """
        noise = random.Random(16)
        self.put(
            "far.nrrd",
            nrrd(array.array(
                "f", [noise.random() for _ in range(343)]), (7, 7, 7), "float", "space: LPS",
                 "space directions: (1,0,0) (0,1,0) (0,0,1)", "space origin: (4e5,4e5,4e5)"))

    def test_more_threads_than_processors_print_no_message(self):
        self.put_sphere()
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "--coarse", "--threads",
                     "64")

    def test_self_intersections_by_rounding_are_listed_with_positions(self):
        self.put_far_noise()
        extract = ("extract", "far.nrrd", "--iso", "0.5", "--coarse", "-q")
        self.succeed(*extract, "-o", "s.ply", "--report", "r.json")
        self.assertIsNone(
            json.loads((self.folder / "r.json").read_text())["files"][0]["self_intersections"])
        result = self.run_tool(*extract, "-o", "s.stl", "--report", "r.json")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        line = (r"isoatlas: s\.stl: level 0: (\d+) self-intersections caused by rounding to "
                r"float32, near \(40000\d\.\d\d, ")
        found = re.search(line, result.stderr)
        self.assertTrue(found, result.stderr)
        checked = json.loads(
            self.run_tool("check", "s.stl", "--self-intersections",
                          "--json").stdout)["self_intersections"]
        self.assertEqual(int(found[1]), checked["pairs"])
        [file] = json.loads((self.folder / "r.json").read_text())["files"]
        self.assertEqual(file["self_intersections"], [checked])

    def test_strict_writes_nothing_if_a_bound_or_a_guarantee_is_violated(self):
        self.put_far_noise()
        before = self.files()
        extract = ("extract", "far.nrrd", "--iso", "0.5", "--coarse", "--strict", "--report",
                   "r.json")
        result = self.run_tool(*extract, "-o", "s.stl")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertIn("self-intersections caused by rounding", result.stderr)
        self.assertRegex(result.stderr, r"isoatlas: nothing was written, because of --strict\n\Z")
        self.assertEqual(self.files(), before)
        bounded = ("extract", "far.nrrd", "--iso", "0.5", "--strict", "--max-vertices", "4")
        self.assertEqual(self.run_tool(*bounded, "-o", "s.ply").returncode, 1)
        self.assertEqual(self.files(), before)
        self.succeed(*extract, "-o", "s.ply", "-q")

    def test_outputs_that_cannot_be_written(self):
        self.put_sphere()
        self.put("file", b"")
        (self.folder / "folder.ply").mkdir()
        os.mkfifo(self.folder / "pipe.ply")
        for place in ("file/s", "missing/s", "/proc/s", "/proc/self/s", "folder", "pipe"):
            self.refuse(re.escape(place), "extract", "sphere.nrrd", "--iso", "0", "-o",
                        place + ".ply")
            report = place + (".ply" if place in ("folder", "pipe") else ".json")
            self.refuse(re.escape(place), "extract", "sphere.nrrd", "--iso", "0", "-o", "ok.ply",
                        "--report", report)
        self.refuse("s.xyz", "extract", "sphere.nrrd", "--iso", "0", "-o", "s.xyz")
        self.refuse("ply", "extract", "sphere.nrrd", "--iso", "0", "-o", "noextension")

    def test_outputs_are_checked_before_the_volume_is_read(self):
        self.refuse("xyz", "extract", "missing.nrrd", "--iso", "0", "-o", "s.xyz")
        self.refuse("missing/s.json", "extract", "missing.nrrd", "--iso", "0", "-o", "s.ply",
                    "--report", "missing/s.json")

    def test_outputs_do_not_replace_each_other_or_the_volume(self):
        self.put_sphere()
        mesh_like = self.put_sphere("volume.ply")
        size = mesh_like.stat().st_size
        (self.folder / "sub").mkdir()
        extract = ["extract", "sphere.nrrd", "--iso", "0"]
        self.refuse("replace", *extract, "-o", "s.ply", "--report", "sub/../s.ply")
        self.refuse("replace", *extract, "-o", "s.ply", "--report", "sphere.nrrd")
        raw = ["--raw-size", "20,20,20", "--raw-type", "float32"]
        self.refuse("replace", "extract", "volume.ply", *raw, "--iso", "0", "-o", "./volume.ply")
        os.link(mesh_like, self.folder / "hard.ply")
        self.refuse("replace", "extract", "volume.ply", *raw, "--iso", "0", "-o", "hard.ply")
        (self.folder / "v").mkdir()
        piece = self.put_sphere("v/v_0.vtp")
        self.refuse("replace", "extract", piece, *raw, "--iso", "0", "-o", "v.vtm")
        self.refuse("volume's folder", "extract", "v", "--iso", "0", "-o", "v.vtm")
        self.refuse("replace", *extract, "-o", "s.glb", "--glb-per-level", "--report", "s.json")
        self.refuse("replace", *extract, "-o", "v.vtm", "--report", "v/v_0.vtp")
        self.refuse("replace", *extract, "-o", "s-{level}.ply", "--report", "s-1.ply")
        self.put("l-1.ply", b"old")
        (self.folder / "l-0.ply").symlink_to("l-1.ply")
        self.refuse("replace", *extract, "-o", "l-{level}.ply")
        self.assertEqual(mesh_like.stat().st_size, size)

    def test_full_standard_output_is_an_error(self):
        self.put("t.off", off(*TETRAHEDRON))
        with open("/dev/full", "w") as full:
            self.refuse("standard output", "check", "t.off", "--json", stdout=full)


class StandardStreams(ToolTest):
    """The name -: standard input for a volume, standard output for a mesh, a report or a page."""

    def put_noise(self, n):
        self.put("noise.raw", random.Random(7).randbytes(n ** 3))
        return ["--raw-size", f"{n},{n},{n}", "--raw-type", "uint8", "--iso", "140.5", "--coarse"]

    def stream(self, *arguments, volume=None, **options):
        """Runs the tool with a volume on standard input. The output is in bytes."""
        with open(volume or os.devnull, "rb") as file:
            return subprocess.run(
                [str(TOOL), *map(str, arguments)], cwd=self.folder, stdin=file, timeout=50,
                **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options})

    def test_every_format_has_the_bytes_of_a_file(self):
        raw = self.put_noise(10)
        for volume, options in ((self.folder / "noise.raw", raw), (FIELD / "v_far.vti", [
                "--iso", "0", "--coarse"
        ]), (FIELD / "r_sp_las.nrrd", ["--iso", "0"]), (FIELD / "n_gz_named.nii", ["--iso", "0"])):
            for extension in [*MESH_EXTENSIONS, "glb"]:
                result = self.stream("extract", "-", *options, "-o", "-", "--format", extension,
                                     "-q", volume=volume)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.run_tool("extract", volume, *options, "-o", f"a.{extension}", "-q")
                self.assertEqual(result.stdout, (self.folder / f"a.{extension}").read_bytes(),
                                 (volume, extension))
        self.assertEqual(
            self.stream("extract", "-", *options, "-o", "-", volume=volume).stdout,
            (self.folder / "a.ply").read_bytes())
        self.assertEqual(
            self.stream("extract", "-", *options, "-o", "-", "--format", ".STL",
                        volume=volume).stdout, (self.folder / "a.stl").read_bytes())

    def test_the_summary_goes_to_standard_error(self):
        options = self.put_noise(10)
        printed = self.succeed("extract", "noise.raw", *options, "-o", "a.ply")
        result = self.stream("extract", "-", *options, "-o", "-", "--report", "r.json",
                             volume=self.folder / "noise.raw")
        labels = lambda text: [line.split()[0] for line in text.splitlines()]
        self.assertEqual(labels(result.stderr.decode()), labels(printed))
        self.assertRegex(
            result.stderr.decode(),
            r"(?s)read +standard input: 10 x 10 x 10 .*wrote +standard output \(.*\), report "
            r"r\.json")
        self.assertEqual(self.stream("extract", "noise.raw", *options, "-o", "-", "-q").stderr, b"")

    def test_other_commands_that_read_standard_input(self):
        self.put_noise(10)
        volume = FIELD / "v_far.vti"
        printed = self.stream("info", "-", volume=volume)
        self.assertEqual((printed.returncode, printed.stderr), (0, b""))
        self.assertEqual(printed.stdout.decode().splitlines()[0], "standard input")
        self.assertEqual(printed.stdout.decode().splitlines()[1:],
                         self.succeed("info", volume).splitlines()[1:])
        self.succeed("extract", volume, "--iso", "0", "-o", "a.ply", "-q")
        measured = [
            json.loads(
                self.stream("check", "a.ply", "--volume", name, "--iso", "0", "--json",
                            volume=volume).stdout)["distance"] for name in ("-", volume)
        ]
        self.assertEqual([m.pop("volume") for m in measured], ["-", str(volume)])
        self.assertEqual(measured[0], measured[1])
        empty = self.stream("extract", "-", "--iso", "0", "-o", "b.ply")
        self.assertEqual((empty.returncode, empty.stderr),
                         (2, b"isoatlas: error: standard input: is empty\n"))
        none = self.stream("extract", "-", "--iso", "1e9", "-o", "b.ply", volume=volume)
        self.assertRegex(none.stderr.decode(), r"\Aisoatlas: error: standard input: [^\n]+\n\Z")
        self.assertNotIn("b.ply", self.files())

    def test_reports_and_pages(self):
        options = ["extract", "-", *self.put_noise(10), "-q"]
        volume = self.folder / "noise.raw"
        report = json.loads(
            self.stream(*options, "-o", "a.ply", "--report", "-", volume=volume).stdout)
        self.assertEqual((report["input"]["path"], report["files"][0]["path"]), ("-", "a.ply"))
        self.assertEqual((self.folder / "a.ply").stat().st_size, report["files"][0]["bytes"])
        page = self.stream(*options, "-o", "a.ply", "--html", "-", volume=volume).stdout
        self.assertTrue(page.startswith(b"<!doctype html>"))
        for both in (["-o", "-", "--report", "-"], ["-o", "a.ply", "--report", "-", "--html", "-"]):
            refused = self.stream(*options, *both, volume=volume)
            self.assertEqual((refused.returncode, refused.stdout), (2, b""))
            self.assertRegex(
                refused.stderr.decode(),
                "the (mesh|report) and the (report|page) would both go to standard output")
        # A report must not search for files named -: reading standard input would block.
        self.stream(*options, "-o", "a.ply", "--report", "r.json", volume=volume)
        self.succeed("report", "r.json", "-o", "r.html", stdin=subprocess.PIPE)
        self.stream(*options, "-o", "-", "--report", "r.json", volume=volume)
        self.assertEqual(json.loads((self.folder / "r.json").read_text())["files"][0]["path"], "-")
        self.refuse("r.json: names no file with a mesh", "report", "r.json", "-o", "s.html")
        self.put("-", b"not a mesh")
        self.refuse("r.json: names no file with a mesh", "report", "r.json", "-o", "s.html")

    def test_invalid_combinations(self):
        options = ["extract", "noise.raw", *self.put_noise(10)]
        self.refuse("--format needs -o -", *options, "-o", "a.ply", "--format", "stl")
        self.refuse("--format: expected one of ply, .*got 'vtm'", *options, "-o", "-", "--format",
                    "vtm")
        self.refuse("--glb-per-level", *options, "-o", "-", "--format", "glb", "--glb-per-level")
        with open("/dev/full", "w") as full:
            self.refuse("standard output: cannot be written: No space left", *options, "-o", "-",
                        "--report", "r.json", stdout=full)
        self.refuse("no temporary folder", *options, "-o", "-", env={"TMPDIR": "/proc"})
        terminal, other_side = pty.openpty()
        try:
            self.refuse("standard output is a terminal", *options, "-o", "-", stdout=other_side)
        finally:
            os.close(terminal), os.close(other_side)

    def test_no_temporary_files_are_left(self):
        options = ["extract", "noise.raw", *self.put_noise(10), "-q", "-o", "-", "--format", "obj"]
        environment = {"TMPDIR": str(self.folder)}
        self.assertEqual(self.run_tool(*options, env=environment).returncode, 0)
        self.assertEqual(
            self.run_tool(*options, "--report", "no/such/folder", env=environment).returncode, 2)
        self.assertEqual(self.files(), ["noise.raw"])

    def test_a_pipe_without_a_reader(self):
        self.put("g.raw", gyroid(32))  # more than the buffer of a pipe
        options = [
            "extract", "g.raw", "--raw-size", "32,32,32", *MANY_TRIANGLES, "--report", "r.json",
            "-q", "-o", "-"
        ]
        process = subprocess.Popen([str(TOOL), *options], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, preexec_fn=restore_signals)
        self.assertEqual(process.stdout.read(3), b"ply")
        process.stdout.close()  # in the middle of the mesh
        self.assertEqual(process.stderr.read(),
                         b"isoatlas: error: standard output: cannot be written: Broken pipe\n")
        process.stderr.close()
        self.assertEqual(process.wait(timeout=20), 2)
        self.assertEqual(self.files(), ["g.raw"])

        process = subprocess.Popen([str(TOOL), *options], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, preexec_fn=restore_signals)
        self.assertEqual(process.stdout.read(3), b"ply")  # the rest is not read: the tool waits
        process.send_signal(signal.SIGINT)
        sent = time.monotonic()
        self.assertEqual(
            process.stderr.read(),
            b"isoatlas: interrupted; standard output is incomplete, no file was written\n")
        self.assertLess(time.monotonic() - sent, 1.0)
        self.assertEqual(process.wait(timeout=20), 128 + signal.SIGINT)
        process.stdout.close(), process.stderr.close()
        self.assertEqual(self.files(), ["g.raw"])


class Rounding(ToolTest):
    """Far from the origin, stated errors include the rounding of the file to float32."""

    FAR = FIELD / "v_far.vti"  # voxels of 1 at (500000, 4649776, 100)

    def extract(self, name, *options):
        result = self.run_tool("extract", self.FAR, "--iso", "0", "-o", name, "--report", "r.json",
                               *options)
        report = json.loads((self.folder / "r.json").read_text())
        return result, report["levels"][-1], report["files"][0]

    def measured(self, name, *options):
        return json.loads(
            self.succeed("check", name, "--volume", self.FAR, "--iso", "0", "--json",
                         *options))["distance"]["maximum"]

    def test_the_stated_error_includes_the_rounding(self):
        requested = ("--min-vertices", "40", "--max-distance", "2")
        _, exact, _ = self.extract("far.ply", *requested)
        for name in ("far.stl", "far.gii"):
            result, level, file = self.extract(name, *requested)
            error = level["metrics"]["max-distance"]["maximum"]
            self.assertGreater(file["largest_rounding"], 0.2)
            self.assertEqual(level["rounding"], file["largest_rounding"])
            self.assertAlmostEqual(
                error, exact["metrics"]["max-distance"]["maximum"] + file["largest_rounding"],
                places=12)
            self.assertEqual(error, level["constraints"][1]["reached"])
            self.assertAlmostEqual(level["distance_at_most"], 2 + file["largest_rounding"],
                                   places=5)
            self.assertLessEqual(self.measured(name), level["distance_at_most"])
            self.assertGreater(self.measured(name),
                               exact["metrics"]["max-distance"]["maximum"])  # the rounding matters
            rounding = f"{file['largest_rounding']:.6g}"
            self.assertIn(f"max-distance {error:.6g} ({rounding} of it by rounding to float32)",
                          result.stdout)
            self.assertRegex(
                result.stderr,
                rf"\Aisoatlas: {name}: its float32 coordinates move vertices by up to "
                rf"{re.escape(rounding)}; [^\n]*"
                r"\.ply[^\n]*--space voxel[^\n]*\n\Z")
            self.assertEqual(result.returncode, 0)

    def test_a_requested_bound_includes_the_rounding(self):
        result, level, _ = self.extract("far.stl", "--max-distance", "0.55", "-q")
        self.assertEqual(result.returncode, 1)
        self.assertRegex(
            result.stderr,
            r"(?m)^isoatlas: level 1: max-distance 0\.55: reached 0\.79\d*: positions are rounded "
            r"to float32 in far\.stl")
        self.assertFalse(level["constraints"][0]["satisfied"])
        result, level, _ = self.extract("far.stl", "--min-vertices", "40", "--max-distance", "2",
                                        "-q")
        self.assertEqual(result.returncode, 0)
        self.assertTrue(level["constraints"][1]["satisfied"])
        self.assertLessEqual(self.measured("far.stl"), 2)
        for name in ("far.ply", "far.glb", "far.vtp", "far.3mf"):
            result, level, _ = self.extract(name, "--max-distance", "0.5", "-q")
            self.assertEqual((result.returncode, result.stderr), (0, ""), name)

    def test_rounding_near_the_origin_is_negligible(self):
        result, level, _ = self.extract("near.stl", "--space", "voxel", "--max-distance", "0.5",
                                        "-q")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertTrue(0 < level["rounding"] < 1e-5)
        self.assertAlmostEqual(self.measured("near.stl"),
                               self.measured("near.stl", "--space", "voxel"), places=12)

    def test_pages_and_streams(self):
        result, level, _ = self.extract("far.stl", "--html", "a.html", "-q", "--max-distance",
                                        "0.55")
        page, _, _ = page_parts(self.folder / "a.html")
        reached = level["metrics"]["max-distance"]["maximum"]
        self.assertGreater(reached, 0.55)
        self.assertAlmostEqual(
            page["results"][0]["levels"][-1]["metrics"]["max-distance"]["maximum"], reached,
            places=5)
        self.assertAlmostEqual(page["results"][0]["geometry"]["levels"][-1]["distance"]["maximum"],
                               reached, places=5)
        with open(self.folder / "s.stl", "wb") as file:
            result = self.run_tool("extract", self.FAR, "--iso", "0", "-o", "-", "--format", "stl",
                                   "-q", "--max-distance", "0.55", stdout=file)
        self.assertEqual(result.returncode, 1)
        self.assertIn("isoatlas: standard output: its float32 coordinates", result.stderr)
        self.assertIn("rounded to float32 in standard output", result.stderr)
        self.assertEqual((self.folder / "s.stl").read_bytes(),
                         (self.folder / "far.stl").read_bytes())


class Formats(ToolTest):

    def test_notes_name_the_changes_of_a_format(self):
        self.put_sphere()
        for name, note in (
            ("s.stl", r"\n  note +programs for printing read an \.stl as millimetres: the volume "
             r"states no unit\n"),
            ("s.3mf", r"\n  note +a \.3mf states a unit: millimetres, as the volume states none\n"),
            ("s.gii",
             r"\n  note +the coordinates of a \.gii are in RAS: x and y are those of LPS negated\n"
             )):
            printed = self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", name, "--report",
                                   "r.json", "--coarse")
            self.assertRegex(printed, note)
            file = json.loads((self.folder / "r.json").read_text())["files"][0]
            self.assertEqual(len(file["notes"]),
                             2 if name == "s.gii" else 1)  # notes about space and unit
            self.assertEqual((file["space"], file["unit"]), ("RAS", "mm") if name == "s.gii" else
                             ("LPS", None if name == "s.stl" else "mm"))
        self.assertNotIn(
            "note", self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "--coarse"))

    def test_a_note_for_an_open_mesh_in_a_3mf(self):
        ramp = array.array("f", (x for z in range(8) for y in range(8) for x in range(8)))
        self.put("half.nrrd", nrrd(ramp, (8, 8, 8)))
        self.assertIn("the mesh is open",
                      self.succeed("extract", "half.nrrd", "--iso", "3.5", "-o", "h.3mf"))

    def test_check_measures_in_the_unit_of_the_volume(self):
        self.put(
            "s.nrrd",
            nrrd(sphere((20, 20, 20)), (20, 20, 20), "float", "space: left-posterior-superior",
                 'space units: "nm" "nm" "nm"', "space directions: (2,0,0) (0,2,0) (0,0,2)",
                 "space origin: (100,200,300)"))
        distances = {}
        for name in ("s.ply", "s.3mf", "s.gii", "s.stl"):
            self.succeed("extract", "s.nrrd", "--iso", "0", "-o", name, "-q")
            distances[name] = json.loads(
                self.succeed("check", name, "--volume", "s.nrrd", "--iso", "0",
                             "--json"))["distance"]["mean"]
        self.assertAlmostEqual(distances["s.3mf"], distances["s.ply"], places=9)
        for name in ("s.gii", "s.stl"):
            self.assertAlmostEqual(distances[name], distances["s.ply"], places=3)
        if not distances["s.ply"] > 0:
            self.fail("nothing was measured")

    def test_nibabel_reads_the_same_surface(self):
        script = (
            "import json, nibabel; a = nibabel.load('s.surf.gii'); p, t = a.agg_data(('pointset', "
            "'triangle')); c = a.darrays[0].coordsys;"
            "print(json.dumps([p.tolist(), t.tolist(), c.dataspace, c.xformspace, "
            "a.get_arrays_from_intent('triangle')[0].meta['TopologicalType']]))")
        self.put_sphere()
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.surf.gii", "-q")
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.off", "-q", "--space", "ras")
        python = next(
            (p for p in (sys.executable, "/usr/bin/python3")
             if subprocess.run([p, "-c", "import nibabel"], capture_output=True).returncode == 0),
            None)
        if python is None:
            self.skipTest("nibabel is not there")
        read = subprocess.run([python, "-c", script], cwd=self.folder, capture_output=True,
                              check=True)
        points, triangles, *spaces, closed = json.loads(read.stdout)
        self.assertEqual((spaces, closed), ([1, 1], "Closed"))  # NIFTI_XFORM_SCANNER_ANAT
        text = (self.folder / "s.off").read_text()
        positions = off_positions(text)
        self.assertEqual(len(points), len(positions))
        for found, wanted in zip(points, positions):
            for a, b in zip(found, wanted):
                self.assertEqual(a, struct.unpack("f", struct.pack("f", b))[0])
        faces = [line.split()[1:] for line in text.splitlines() if line.startswith("3 ")]
        self.assertEqual(triangles, [list(map(int, face)) for face in faces])


class NothingHalfWritten(ToolTest):

    def put_gyroid(self, n):
        self.put("g.raw", gyroid(n))
        return ["extract", "g.raw", "--raw-size", f"{n},{n},{n}", *MANY_TRIANGLES, "-q", "-o"]

    def test_killed_while_writing(self):
        arguments = self.put_gyroid(64)
        self.assertEqual(self.run_tool(*arguments, "whole.obj").returncode, 0)
        whole = (self.folder / "whole.obj").read_bytes()
        killed_within, left = 0, []
        for attempt in range(6):
            old = self.put("a.obj", b"old")
            process = subprocess.Popen([str(TOOL), *arguments, "a.obj"], cwd=self.folder)
            wanted = attempt * len(whole) // 8
            while process.poll() is None:
                try:
                    parts = list(self.folder.glob(".isoatlas-*/.isoatlas.*.part"))
                    parts = [part for part in parts if part not in left]
                    if parts and parts[0].stat().st_size >= wanted:
                        killed_within += parts[0].stat().st_size < len(whole)
                        process.kill()
                        break
                except FileNotFoundError:
                    pass  # the file was renamed
            process.wait(timeout=20)
            left = list(self.folder.glob(".isoatlas-*/.isoatlas.*.part"))
            self.assertIn(old.read_bytes(), (b"old", whole))
            # Files of killed runs do not disturb later runs.
        self.assertGreater(killed_within, 0, "no run was killed in the middle")
        self.assertTrue(list(self.folder.glob(".isoatlas-*")))
        self.assertEqual(self.run_tool(*arguments, "a.obj").returncode, 0)
        self.assertEqual((self.folder / "a.obj").read_bytes(), whole)

    def mount_small_disk(self, size):
        disk = self.folder / "disk"
        disk.mkdir()
        if os.geteuid() != 0 or subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", disk],
                capture_output=True).returncode != 0:
            self.skipTest("no small file system can be mounted")
        self.addCleanup(subprocess.run, ["umount", "-l", disk], check=True)
        return disk

    def test_full_disk(self):
        """Each format on a disk that is too small for it."""
        arguments = self.put_gyroid(24)
        disk = self.mount_small_disk("16k")
        (disk / "old").write_bytes(b"old")
        for name in [
                *(f"a.{extension}" for extension in MESH_EXTENSIONS), "a.glb", "a.vtm",
                "a-{level}.ply"
        ]:
            result = self.run_tool(*arguments, disk / name)
            self.assertEqual(result.returncode, 2, (name, result.stderr))
            self.assertRegex(
                result.stderr,
                r"\Aisoatlas: error: [^\n]*disk/a[^\n]*(No space left on device|out of disk "
                r"space|OutOfDiskSpace)[^\n]*\n\Z", name)
            self.assertEqual([path.name for path in disk.iterdir()], ["old"], name)
        result = self.run_tool(*arguments, "b.ply", "--report", disk / "r.json", "--html",
                               disk / "r.html")
        self.assertEqual(result.returncode, 2)
        self.assertEqual([path.name for path in disk.iterdir()], ["old"])
        self.assertFalse((self.folder / "b.ply").exists())
        result = self.run_tool(*arguments, "-", env={"TMPDIR": str(disk)})
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr,
                         r"\Aisoatlas: error: standard output: [^\n]*No space left on device\n\Z")
        self.assertEqual([path.name for path in disk.iterdir()], ["old"])

    def test_blocks_on_a_full_disk(self):
        """What was made stays, and is used when there is space again."""
        self.put_sphere()
        disk = self.mount_small_disk("48k")
        extract = ["extract", "sphere.nrrd", "--iso", "0", "--coarse", "--block-size", "7",
                   "--parts", "disk/parts"]
        message = (r"\Aisoatlas: error: [^\n]*parts/block-\d+\.(mesh|lock)[^\n]*"
                   r"No space left on device\n\Z")
        result = self.run_tool(*extract, "-o", "a.ply")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, message)
        self.assertTrue(result.stderr.startswith("isoatlas: error: disk/parts/block-"))
        self.assertFalse((self.folder / "a.ply").exists())
        made = {path: path.read_bytes() for path in (disk / "parts").iterdir()}
        self.assertTrue(made)
        self.assertTrue(all(re.fullmatch(r"block-\d+\.mesh", path.name) for path in made), made)
        subprocess.run(["mount", "-o", "remount,size=8m", disk], check=True)
        self.succeed(*extract, "-o", "a.ply", "-q")
        for path, data in made.items():
            self.assertEqual(path.read_bytes(), data)
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "--coarse", "--block-size", "7", "-o",
                     "b.ply", "-q")
        self.assertEqual((self.folder / "a.ply").read_bytes(),
                         (self.folder / "b.ply").read_bytes())

    def test_a_volume_that_is_cut_while_it_is_read(self):
        """The file is truncated after an open or a read: an error, or the whole mesh."""
        library = os.environ.get("ISOATLAS_CUT_LIBRARY")
        if not library:
            self.skipTest("ISOATLAS_CUT_LIBRARY does not name the library that cuts files")
        n = 64
        samples = gyroid(n)
        sizes = f"{n} {n} {n}"
        mha = (f"ObjectType = Image\nNDims = 3\nElementSpacing = 1 1 1\nDimSize = {sizes}\n"
               f"ElementType = MET_UCHAR\nElementDataFile = LOCAL\n")
        vtk = (f"# vtk DataFile Version 3.0\na\nBINARY\nDATASET STRUCTURED_POINTS\n"
               f"DIMENSIONS {sizes}\nORIGIN 0 0 0\nSPACING 1 1 1\n"
               f"POINT_DATA {n ** 3}\nSCALARS a unsigned_char\nLOOKUP_TABLE default\n")
        zipped = nrrd(zlib.compress(samples, 0), (n, n, n), "uchar")
        volumes = {
            "a.raw": samples, "a.nrrd": nrrd(samples, (n, n, n), "uchar"), "z.nrrd": zipped.replace(
                b"encoding: raw", b"encoding: gzip"), "a.mha": mha.encode() + samples,
            "a.vtk": vtk.encode() + samples, "a.tif": tiff(samples, n), "a.nii": nifti(samples, n),
        }
        cut = 0
        for name, content in volumes.items():
            options = ["extract", name, "--iso", "128.5", "--coarse", "-q", "-o", "a.ply"]
            options += ["--spacing", "1,1,1"] if name == "a.tif" else []
            if name == "a.raw":
                options += ["--raw-size", f"{n},{n},{n}", "--raw-type", "uint8"]
            self.put(name, content)
            self.assertEqual(self.run_tool(*options).returncode, 0, name)
            whole = (self.folder / "a.ply").read_bytes()
            statuses = []
            for uses in (1, 2, 3, 4, 5, 6, 9, 14, 20):
                for length in (0, len(content) // 2):
                    self.put(name, content)
                    self.put("a.ply", b"old")
                    result = self.run_tool(
                        *options, env={
                            "LD_PRELOAD": library, "CUT_FILE": str(self.folder / name),
                            "CUT_AFTER": str(uses), "CUT_LENGTH": str(length)
                        })
                    statuses.append(result.returncode)
                    self.assertIn(result.returncode, (0, 2), (name, uses, length, result.stderr))
                    self.assertRegex(result.stderr, r"\A(isoatlas: error: [^\n]+\n)?\Z")
                    self.assertEqual((self.folder / "a.ply").read_bytes(),
                                     whole if result.returncode == 0 else b"old",
                                     (name, uses, length))
            self.assertIn(2, statuses, f"{name} was not cut while it was read")

    def test_a_folder_that_cannot_be_written(self):
        arguments = self.put_gyroid(8)
        folder = self.folder / "folder"
        folder.mkdir()
        (folder / "a.ply").write_bytes(b"old")
        if os.geteuid() == 0:
            if subprocess.run(["mount", "--bind", "-o", "ro", folder, folder],
                              capture_output=True).returncode != 0:
                self.skipTest("root writes everywhere")
            self.addCleanup(subprocess.run, ["umount", "-l", folder], check=True)
            subprocess.run(["mount", "-o", "remount,bind,ro", folder], check=True)
        else:
            folder.chmod(0o500)
        for name in ("a.ply", "b.3mf", "c.vtm"):
            self.refuse(
                rf"folder/{name}: cannot be written: (Read-only file system|Permission denied)",
                *arguments, folder / name)
        self.refuse("folder/r.json: cannot be written", *arguments, "d.ply", "--report",
                    folder / "r.json")
        self.assertEqual((folder / "a.ply").read_bytes(), b"old")


class BadArguments(ToolTest):

    def setUp(self):
        super().setUp()
        self.put_sphere(n=8)
        self.good = ["extract", "sphere.nrrd", "--iso", "0", "-o", "out.ply"]

    def test_usage(self):
        self.refuse(r"see isoatlas --help", "no-such-command")
        self.refuse(r"see isoatlas extract --help", "extract")
        self.refuse(r"--iso.*see isoatlas extract --help", "extract", "sphere.nrrd", "-o",
                    "out.ply")
        self.refuse(r"--output.*see isoatlas extract --help", "extract", "sphere.nrrd", "--iso",
                    "0")
        self.refuse(r"--frobnicate.*see isoatlas extract --help", *self.good, "--frobnicate")
        self.refuse(r"see isoatlas info --help", "info")
        self.refuse(r"see isoatlas check --help", "check", "a.ply", "b.ply")

    def test_values(self):
        for option, values in {
                "--iso": ["nan", "inf", "-inf", "", "1,5", "0x", "ten",
                          "1e999"], "--min-component-size": [
                              "-1", "2.5mm", "vx", "ten", "inf", "", "1e999"
                          ], "--keep-components": ["0", "-1", "1.5", "all", ""], "--keep-near": [
                              "1,2", "1,2,3,4", "1,2,x", "1,2,nan", ""
                          ], "--drop-near": ["1 2 3", ""], "--max-radius": [
                              "0", "-1", "3 furlongs", "vx", "mm", "1vxmm", "inf", "nanmm", "",
                              "2.5 px", "1e999"
                          ], "--event-persistence": ["-1", "abc", "3px", "infvx"], "--covering": [
                              "bins", "", "sizing fields", "halving,sizing-field"
                          ], "--threads": ["-1", "1.5", "many", "", "99999999999"],
                "--inside": ["outside", "", "0"], "--topology": ["cubic", "", "face"],
                "--interpolation": ["linear", "", "tri-cubic", "cubic"], "--adaptive-supersample": [
                    "-1", "9", "1.5", "", "many"
                ], "--supersample": ["0", "-2", "1.5", "2x", "", "99999999999"], "--nan": [
                    "refuse", ""
                ], "--space": ["lpi", "L P S"], "--placement": ["here", ""],
                "--border": ["shut", ""], "--measure-samples": ["0", "-1", "many"],
                "--max-distance": ["0", "-1", "0vx", "half", "1px", "inf"],
                "--min-edge": ["0", "x"], "--area-curvature": ["1", "0.5", "nan", "2vx"],
                "--geodesic-ratio": ["1", "inf"],
                "--normal-angle": ["0", "-5", "5rad", "deg"], "--max-vertices": [
                    "3", "-7", "1e3", "5.5", "99999999999"
                ], "--min-aspect": ["0", "1", "-0.1", "nan"], "--refine": [
                    "foo", "max-distance", "max-distance:", "max-distance:0", "max-distance:1vx,",
                    ":1", "max distance:1", "max-distance=1", "max-vertices:3", "normal-angle:15rad"
                ],
        }.items():
            base = self.good if option != "--iso" else ["extract", "sphere.nrrd", "-o", "out.ply"]
            for value in values:
                self.refuse(rf"{option}.*see isoatlas extract --help", *base, f"{option}={value}")
        self.refuse("--iso", *self.good, "--iso", "1")
        self.refuse("--quiet", *self.good, "-q", "-v")

    def test_levels(self):
        message = self.refuse("--refine.*'max-dist'", *self.good, "--refine", "max-dist:2")
        for known in METRICS + SOFT:
            self.assertIn(known, message)
        self.refuse("max-distance is given twice for level 2", *self.good, "--refine",
                    "max-distance:2", "--refine", "max-distance:1,max-distance:0.5")
        self.refuse("max-vertices is given twice for level 1", *self.good, "--refine",
                    "max-vertices:20", "--max-vertices", "30")
        self.refuse("--max-vertices", *self.good, "--max-vertices", "30", "--max-vertices", "40")
        self.refuse("--coarse.*--refine", *self.good, "--coarse", "--refine", "max-distance:1")
        self.refuse("--levels.*without --refine", *self.good, "--levels", "3", "--refine",
                    "max-distance:1")
        self.refuse("--levels.*without --coarse", *self.good, "--coarse", "--levels", "3")
        self.refuse("levels: .*max-distance", *self.good, "--levels", "3", "--normal-angle", "20")
        for number in ("0", "17", "2.5", "-1", "many"):
            self.refuse(f"--levels: expected a whole number from 1 to 16, got '{number}'",
                        *self.good, "--levels", number)
        self.refuse("--measure", *self.good, "--measure", "--measure-samples", "7")
        self.refuse("max-edge:1", *self.good, "--refine", "max-distance:1", "max-edge:1")

    def test_names_of_outputs(self):

        def refuse(pattern, name, *options):
            self.refuse(pattern, "extract", "missing.nrrd", "--iso", "0", "-o", name, *options)

        for name in ("s-{}.ply", "s-{lvl}.ply", "s-{level.ply", "{level"):
            refuse(r"only \{level\}", name)
        refuse("twice", "{level}-{level}.ply")
        refuse("folder", "{level}/s.ply")
        refuse("all levels", "s-{level}.vtm")
        refuse("there is no folder", "missing/s.glb")
        for name in ("s.ply", "s.vtm", "s-{level}.glb"):
            refuse(r"-o NAME\.glb", name, "--glb-per-level")
        self.put("s", b"no folder")
        refuse("is not a folder", "s.vtm")
        (self.folder / "s-1.ply").mkdir()
        refuse("s-1.ply", "s-{level}.ply")

    def test_raw_layout(self):
        raw = ["info", "sphere.nrrd"]
        self.refuse("--raw-type", *raw, "--raw-size", "8,8,8")
        self.refuse("--raw-size", *raw, "--raw-type", "uint8")
        self.refuse("--raw-size", *raw, "--raw-spacing", "1,1,1")
        for size in ("8,8", "8,8,8,8", "8x8x8", "8,8,0", "8,8,-8", "8,8,", "8,8,8.0",
                     "99999999999999999999,8,8"):
            self.refuse("--raw-size", *raw, f"--raw-size={size}", "--raw-type", "uint8")
        self.refuse("--raw-type.*float32", *raw, "--raw-size", "8,8,8", "--raw-type", "float")
        for spacing in ("0,1,1", "1,1", "-1,1,1", "nan,1,1"):
            self.refuse("--raw-spacing", *raw, "--raw-size", "8,8,8", "--raw-type", "uint8",
                        f"--raw-spacing={spacing}")
        self.refuse("--raw-endian", *raw, "--raw-size", "8,8,8", "--raw-type", "uint8",
                    "--raw-endian", "middle")


class WrongCommandLines(ToolTest):
    """Each line of wrong_command_lines.tsv gives its error line and writes no file."""

    LINES = [
        line.split("\t")
        for line in (pathlib.Path(__file__).parent /
                     "wrong_command_lines.tsv").read_text(encoding="utf-8").splitlines()
        if line and not line.startswith("#")
    ]

    def setUp(self):
        super().setUp()
        n = 12
        volume = nrrd(sphere((n, n, n)), (n, n, n))
        for name in ("scan.nrrd", "my scan.nrrd"):
            self.put(name, volume)
        header, samples = volume.split(b"\n\n", 1)
        self.put("scan.nhdr", header + b"\ndata file: scan.raw\n")
        for name in ("scan.raw", "bare.raw"):
            self.put(name, samples)
        for name in ("head.ply", "head.stl", "head.glb"):
            self.succeed("extract", "scan.nrrd", "--iso", "0", "-o", name, "--report",
                         "report.json", "-q")
        self.put("check.json", self.succeed("check", "head.ply", "--json").encode())
        self.put("page.html", b"<!doctype html>\n<title>a page</title>\n")
        self.put("photo.png", b"\x89PNG\r\n\x1a\n" + bytes(100))
        self.put("notes.txt", b"some notes\n")
        (self.folder / "slices").mkdir()

    def test_all_lines(self):
        self.assertGreaterEqual(len(self.LINES), 60)
        for line, expected in self.LINES:
            with self.subTest(line):
                program, *arguments = shlex.split(line)
                self.assertEqual(program, "isoatlas")
                self.refuse(re.escape(expected), *arguments)

    def test_no_arguments_list_the_commands(self):
        result = self.run_tool()
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertTrue(result.stderr.startswith("usage: isoatlas COMMAND"))
        for command in Help.OPTIONS:
            self.assertRegex(result.stderr, rf"(?m)^  {command.replace('-', ' ')} ")

    def test_unusual_but_correct_command_lines(self):
        extract = ["extract", "scan.nrrd", "-q", "--coarse"]
        self.succeed(*extract, "--iso", "-.5", "-o", "a.ply")
        self.succeed(*extract, "--iso=-5e-1", "-oa.ply")
        self.succeed("extract", "scan.nrrd", "-qo", "b.ply", "--iso", " 0 ")
        self.succeed(*extract, "--iso", "0", "--space", " LPS", "--inside", "Below", "-o", "a.ply")
        self.succeed("extract", "scan.nrrd", "-q", "--iso", "0", "--refine", "max-distance: 0.5vx",
                     "--refine", "MAX_DISTANCE:0.4 vx", "-o", "a.ply")
        self.succeed(*extract, "--iso", "0", "--max-radius", "9 VX", "-o", "a.ply")
        self.succeed("extract", "bare.raw", "--raw-size", "12, 12, 12", "--raw-type", "Float32",
                     "--iso", "0", "-q", "-o", "a.ply", "--coarse")
        self.put("-dash.nrrd", (self.folder / "scan.nrrd").read_bytes())
        self.succeed("extract", "-q", "--coarse", "--iso", "0", "-o", "a.ply", "--", "-dash.nrrd")
        self.put("check", (self.folder / "bare.raw").read_bytes())
        self.succeed("info", "check", "--raw-size", "12,12,12", "--raw-type", "float32")
        self.put("–scan.nrrd",
                 (self.folder / "scan.nrrd").read_bytes())  # a file may have such a name
        self.succeed("info", "–scan.nrrd")


class BadFiles(ToolTest):

    def test_missing_truncated_and_unknown(self):
        self.refuse_volume("nowhere.nrrd", "nowhere.nrrd")
        whole = nrrd(sphere((8, 8, 8)), (8, 8, 8))
        self.put("short.nrrd", whole[:-100])
        self.refuse_volume("short.nrrd", "short.nrrd")
        self.put("header.nrrd", whole[:40])
        self.refuse_volume("header.nrrd", "header.nrrd")
        self.put("empty.nrrd", b"")
        self.refuse_volume("empty.nrrd", "empty.nrrd")
        self.put("text.nrrd", b"this is no volume\n" * 10)
        self.refuse_volume("text.nrrd", "text.nrrd")
        self.put("v.jpeg2000", b"no mark of any format")
        self.refuse_volume("v.jpeg2000", "v.jpeg2000")
        self.put("bad\nname.nrrd", b"")
        self.refuse_volume("bad name.nrrd", "bad\nname.nrrd")

    def test_header_that_declares_too_many_samples(self):
        self.put("more.nrrd", nrrd(sphere((8, 8, 8)), (8, 8, 9)))
        self.refuse_volume("more.nrrd", "more.nrrd")
        self.put("raw.raw", bytes(8 * 8 * 8))
        self.refuse_volume("raw.raw.*512 bytes.*576 bytes", "raw.raw", "--raw-size", "8,8,9",
                           "--raw-type", "uint8")

    def test_sizes_that_overflow(self):
        huge = str(2 ** 32)
        self.put("huge.nrrd", nrrd(b"\0" * 64, (huge, huge, huge), "uchar"))
        self.refuse_volume("huge.nrrd", "huge.nrrd")
        self.put("huge.raw", b"\0" * 64)
        self.refuse_volume("huge.raw", "huge.raw", "--raw-size", f"{huge},{huge},{huge}",
                           "--raw-type", "float64")

    def test_images_that_are_not_scalar_volumes(self):
        self.put("vector.nrrd",
                 nrrd(bytes(3 * 512), (3, 8, 8, 8), "uchar", "kinds: vector domain domain domain"))
        self.refuse_volume("vector.nrrd", "vector.nrrd")
        self.put("flat.nrrd", nrrd(bytes(64), (8, 8), "uchar"))
        self.refuse_volume("flat.nrrd", "flat.nrrd")
        self.put("thin.nrrd", nrrd(bytes(64), (8, 8, 1), "uchar"))
        self.refuse_volume("thin.nrrd.*1", "thin.nrrd")
        self.put("thin.raw", bytes(64))
        self.refuse_volume("1", "thin.raw", "--raw-size", "1,8,8", "--raw-type", "uint8")

    def test_nan_and_infinity_are_counted(self):
        samples = sphere((8, 8, 8))
        samples[3 + 8 * (2 + 8 * 1)] = math.nan
        samples[400] = math.inf
        self.put("n.nrrd", nrrd(samples, (8, 8, 8)))
        message = self.refuse(r"\(3, ?2, ?1\)", "extract", "n.nrrd", "--iso", "0", "-o", "out.ply")
        self.assertRegex(message, r"(?i)nan")
        self.assertRegex(message, r"\b[12]\b")

    def test_empty_surface_names_the_range(self):
        self.put("c.nrrd", nrrd(bytes([7] * 511 + [40]), (8, 8, 8), "uchar"))
        self.refuse_volume(r"\b7\b.*\b40\b", "c.nrrd", iso="100")
        self.refuse_volume(r"\b7\b.*\b40\b", "c.nrrd", iso="3")
        self.put("same.nrrd", nrrd(bytes([7] * 512), (8, 8, 8), "uchar"))
        self.refuse_volume(r"\b7\b", "same.nrrd", iso="7")

    def test_supersampling_beyond_the_memory_names_the_largest_factor(self):
        self.put_sphere()
        extract = ["extract", "sphere.nrrd", "--iso", "0", "-o", "out.ply"]
        self.refuse(
            r"sphere.nrrd: supersampling 1000 times makes more samples than the limit of 2\^36: "
            r"expected \d+ times at most", *extract, "--supersample", "1000")
        limit = 1 << 30
        if self.run_tool("--version", limit=limit).returncode != 0:
            self.skipTest("the tool does not start with 1 GiB of address space (sanitizers)")
        started = time.monotonic()
        message = self.refuse(
            r"sphere.nrrd: supersampling 60 times needs about \d.* GiB of memory, but only 0.8 GiB "
            r"can be used: expected \d\d times at most", *extract, "--supersample", "60",
            limit=limit)
        self.assertLess(time.monotonic() - started, 5)
        largest = int(re.search(r"expected (\d+) times", message).group(1))
        self.refuse(f"supersampling {largest + 1} times needs", *extract, "--supersample",
                    str(largest + 1), limit=limit)

    def test_out_of_memory_is_status_4(self):
        limit = 1 << 30
        if self.run_tool("--version", limit=limit).returncode != 0:
            self.skipTest("the tool does not start with 1 GiB of address space (sanitizers)")
        with open(self.folder / "big.raw", "wb") as big:
            big.truncate(2 << 30)  # a hole: takes no disk
        self.fail_with(4, "memory", "extract", "big.raw", "--raw-size", "2048,1024,1024",
                       "--raw-type", "uint8", "--iso", "0.5", "-o", "out.ply", limit=limit)


class Interruption(ToolTest):

    def interrupt(self, number, *arguments, after=0.4):
        before = self.files()
        # The thread sanitizer sleeps for a second at exit by default.
        environment = {
            **os.environ, "TSAN_OPTIONS": os.environ.get("TSAN_OPTIONS", "") + " atexit_sleep_ms=0"
        }
        process = subprocess.Popen([str(TOOL), *map(str, arguments)], cwd=self.folder,
                                   env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   encoding="utf-8", preexec_fn=restore_signals)
        time.sleep(after)
        self.assertIsNone(process.poll(), "the job was too short to be interrupted")
        process.send_signal(number)
        sent = time.monotonic()
        output, errors = process.communicate(timeout=20)
        self.assertLess(time.monotonic() - sent, 1.0)
        self.assertEqual(process.returncode, 128 + number)
        self.assertEqual((output, errors), ("", "isoatlas: interrupted; nothing was written\n"))
        self.assertEqual(self.files(), before)

    def test_while_computing(self):
        n = 160
        self.put("noise.raw", random.Random(1).randbytes(n ** 3))
        for number, output in ((signal.SIGINT, "out.ply"), (signal.SIGTERM, "out.vtm"),
                               (signal.SIGHUP, "out.glb")):
            self.interrupt(number, "extract", "noise.raw", "--raw-size", f"{n},{n},{n}",
                           "--raw-type", "uint8", "--iso", "127.5", "-o", output, "--report",
                           "out.json")

    def test_while_reading(self):
        # Gigabytes of zeros in a small file: a deflate block after a full flush can be repeated.
        deflate = zlib.compressobj(1, zlib.DEFLATED, -15)
        block_bytes, blocks = 1 << 24, 256
        block = deflate.compress(bytes(block_bytes)) + deflate.flush(zlib.Z_FULL_FLUSH)
        end = b"\x03\x00" + struct.pack("<II", 0, block_bytes * blocks & 0xFFFFFFFF)
        gzip = b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + block * blocks + end
        self.put(
            "zeros.nrrd",
            nrrd(gzip, (2048, 2048, 1024), "uchar").replace(b"encoding: raw", b"encoding: gzip"))
        self.interrupt(signal.SIGINT, "info", "zeros.nrrd")
        self.interrupt(signal.SIGINT, "extract", "zeros.nrrd", "--iso", "0.5", "-o", "out.ply")

    def test_ignored_signals_stay_ignored(self):
        self.put_sphere()
        n = 160
        self.put("noise.raw", random.Random(1).randbytes(n ** 3))
        command = [
            str(TOOL), "extract", "noise.raw", "--raw-size", f"{n},{n},{n}", "--raw-type", "uint8",
            "--iso", "127.5", "-o", "out.ply"
        ]
        process = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, encoding="utf-8",
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN))
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=20)
        self.assertEqual(process.returncode, 128 + signal.SIGTERM)


def leaves(value, path=""):
    """Paths of all leaf keys, such as kinds[].genus for objects in arrays."""
    if isinstance(value, dict):
        return set().union(*(leaves(v, f"{path}.{k}" if path else k) for k, v in value.items()))
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return set().union(*(leaves(v, path + "[]") for v in value))
    return {path}


def empty_leaves(value, path=""):
    """Paths of the leaf keys that are null or an empty list: keys below them do not apply."""
    if isinstance(value, dict):
        return set().union(*(empty_leaves(v, f"{path}.{k}" if path else k)
                             for k, v in value.items()))
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return set().union(*(empty_leaves(v, path + "[]") for v in value))
    return {path} if value is None or value == [] else set()


def documented(schema):
    text = (DOCS / "report.md").read_text(encoding="utf-8")
    section = re.search(rf"(?ms)^## {schema}$(.*?)(?=^## |\Z)", text)
    return set(re.findall(r"(?m)^\| `([^`]+)` \|", section.group(1)))


class Report(ToolTest):

    def make(self, *options):
        """The report of a run that may violate constraints: status 0 or 1."""
        self.put_sphere()
        result = self.run_tool("extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "--report",
                               "s.json", "-q", *options)
        self.assertIn(result.returncode, (0, 1), result.stderr)
        return json.loads((self.folder / "s.json").read_text(encoding="utf-8"))

    def compare(self, value, wanted):
        found, empty = leaves(value), empty_leaves(value)
        below = lambda key, parent: key.startswith((parent + ".", parent + "[]"))
        for key in found - wanted:
            self.assertTrue(key in empty and any(below(other, key) for other in wanted),
                            f"{key} is not documented")
        for key in wanted - found:
            self.assertTrue(any(below(key, parent) for parent in empty),
                            f"{key} is documented and not there")

    def test_every_key_is_documented_and_every_documented_key_is_there(self):
        coarse = documented("isoatlas-report-3") - {"seconds.refine"}
        self.compare(self.make("--coarse"), coarse)
        self.compare(
            self.make("--coarse", "--min-component-size", "10vx", "--keep-components", "5"), coarse)
        self.compare(
            self.make("--coarse", "--max-vertices", "1000", "--max-distance", "1vx", "--placement",
                      "balanced"), documented("isoatlas-report-3"))
        checked = self.succeed("check", "s.ply", "--json", "--self-intersections", "--volume",
                               "sphere.nrrd", "--iso", "0", "--samples", "100")
        self.assertEqual(json.loads(checked)["self_intersections"], {"pairs": 0, "first": []})
        self.put(
            "m.off",
            off([(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1), (1, 1, -1), (5, 5, 0)], [(0, 1, 2),
                                                                                      (3, 4, 5)]))
        intersecting = json.loads(
            self.run_tool("check", "m.off", "--json", "--self-intersections").stdout)
        self.compare(
            json.loads(checked) | {"self_intersections": intersecting["self_intersections"]},
            documented("isoatlas-check-1"))
        refined = self.make("--refine", "max-distance:1vx", "--measure-samples", "1000")
        self.compare(refined,
                     documented("isoatlas-report-3") - ({"seconds.refine"} - leaves(refined)))
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "--coarse", "-o", "s.glb", "-q",
                     "--glb-per-level")
        self.compare(json.loads(self.succeed("levels", "s.glb", "--json")),
                     documented("isoatlas-levels-1"))
        of_report = {key for key in documented("isoatlas-report-3") if key.startswith("levels[].")}
        self.compare(
            json.loads((self.folder / "s.json").read_text()),
            documented("isoatlas-manifest-2")
            | of_report - {"levels[].path", "levels[].rounding", "levels[].seconds"})

    def test_values_of_a_run(self):
        report = self.make("--max-radius", "3vx", "--space", "voxel", "--threads", "2", "--coarse")
        self.assertEqual(report["schema"], "isoatlas-report-3")
        self.assertEqual(report["input"]["path"], "sphere.nrrd")
        self.assertEqual(report["input"]["size"], [20, 20, 20])
        self.assertEqual(report["input"]["sample_type"], "float32")
        self.assertEqual(report["parameters"]["max_radius"], 3)
        self.assertEqual(report["parameters"]["threads"], 2)
        self.assertEqual(report["parameters"]["space"], "voxel")
        self.assertIsNone(report["parameters"]["event_persistence"])
        self.assertEqual(len(report["levels"]), 1)
        level = report["levels"][0]
        self.assertIs(level["certificate"]["passed"], True)
        for key in ("components", "euler_characteristic", "genus", "boundary_loops", "kinds"):
            self.assertEqual(level[key], report["reference"][key])
        self.assertEqual(level["kinds"], [{"genus": 0, "boundary_loops": 0, "count": 1}])
        self.assertEqual(sum(level["quality"]["aspect_ratio"]["histogram"]), level["triangles"])
        self.assertEqual(len(level["quality"]["aspect_ratio"]["histogram"]), 20)
        self.assertEqual((level["path"], level["level"]), ("s.ply", 0))
        size = (self.folder / "s.ply").stat().st_size
        self.assertEqual(report["files"], [{
            "path": "s.ply", "levels": [0], "bytes": size, "positions": "float64",
            "largest_rounding": 0, "space": "voxel", "unit": None, "notes": [],
            "self_intersections": None
        }])
        stages = {k: v for k, v in report["seconds"].items() if k not in ("read", "write", "total")}
        self.assertAlmostEqual(sum(stages.values()), report["seconds"]["total"], delta=0.05)
        self.assertGreater(report["peak_memory_bytes"], 1 << 20)

    def test_constraints_in_the_order_of_the_command_line(self):

        def names(goal):
            return [constraint["quantity"] for constraint in goal]

        parameters = self.make()["parameters"]
        self.assertEqual((parameters["coarse"], parameters["refine"]),
                         ([], [[{"quantity": "max-distance", "bound": 0.5}]]))
        parameters = self.make("--max-vertices", "500", "--refine",
                               "max-distance:2vx,normal-angle:40deg", "--min-aspect", "0.1",
                               "--refine", "max-distance:1.5", "--max-edge", "9")["parameters"]
        self.assertEqual(
            [names(goal) for goal in parameters["refine"]],
            [["max-vertices", "max-distance", "normal-angle", "min-aspect", "max-edge"],
             ["max-vertices", "min-aspect", "max-distance", "max-edge"]])
        self.assertEqual(parameters["refine"][1][2]["bound"], 1.5)
        parameters = self.make("--min-edge", "0.1", "--max-vertices", "100")["parameters"]
        self.assertEqual(names(parameters["refine"][0]),
                         ["min-edge", "max-vertices", "max-distance"])
        self.assertEqual(
            names(
                self.make("--normal-angle", "60", "--max-vertices",
                          "100")["parameters"]["refine"][0]), ["normal-angle", "max-vertices"])
        parameters = self.make("--coarse", "--normal-angle", "10",
                               "--max-vertices=100")["parameters"]
        self.assertEqual((names(parameters["coarse"]), parameters["refine"]),
                         (["normal-angle", "max-vertices"], []))

    def test_agrees_with_an_independent_check(self):
        finest = self.make()["levels"][-1]
        checked = json.loads(self.succeed("check", "s.ply", "--json"))
        for key in ("vertices", "triangles", "components", "euler_characteristic", "genus",
                    "boundary_loops", "kinds"):
            self.assertEqual(checked[key], finest[key])

    def test_keys_come_in_the_same_order_each_time(self):
        self.make()
        first = re.findall(r'"(\w+)":', (self.folder / "s.json").read_text())
        self.make()
        self.assertEqual(first, re.findall(r'"(\w+)":', (self.folder / "s.json").read_text()))


class Info(ToolTest):

    def suggested(self, text):
        """The isovalues that `info` suggests, one on each line."""
        lines = text[text.index("isovalues"):].replace("isovalues", "").splitlines()
        return [
            float(line.split()[0]) for line in lines if re.match(r"\s*[-+.\d]+(e[-+]?\d+)?  ", line)
        ]

    def test_geometry(self):
        self.put(
            "v.nrrd",
            nrrd(sphere((10, 12, 14)), (10, 12, 14), "float", "space: left-posterior-superior",
                 "space directions: (0,0.5,0) (-2,0,0) (0,0,3)", "space origin: (1,-2,3.5)"))
        text = self.succeed("info", "v.nrrd")
        for pattern in (
                r"size +10 x 12 x 14, 1,680 samples", r"type +float32, 6\.6 KiB",
                r"spacing +0\.5 2 3", r"extent +4\.5 x 22 x 39", r"origin +1 -2 3\.5",
                r"orientation +PRS \(x towards Posterior, y towards Right, z towards Superior\)$",
                r"direction +0 -1 0\n +1 0 0\n +0 0 1$", r"not finite +0 NaN, 0 infinite$"):
            self.assertRegex(text, "(?m)" + pattern)

    def test_oblique(self):
        self.put(
            "v.nrrd",
            nrrd(bytes(512), (8, 8, 8), "uchar", "space: left-posterior-superior",
                 "space directions: (0.8,0.6,0) (-0.6,0.8,0) (0,0,1)", "space origin: (0,0,0)"))
        self.assertRegex(self.succeed("info", "v.nrrd"),
                         r"orientation +LPS .*oblique by 36\.9 degrees")

    def test_integer_samples_get_half_integer_isovalues(self):
        values = [10] * 300 + [100] * 150 + [200] * 62
        self.put("v.nrrd", nrrd(bytes(values), (8, 8, 8), "uchar"))
        text = self.succeed("info", "v.nrrd")
        self.assertIn("range         10 to 200", text)
        self.assertIn("no sample equals", text)
        found = self.suggested(text)
        self.assertTrue(found and all(value % 1 == 0.5 for value in found), found)
        self.assertTrue(
            any(10 < v < 100 for v in found) and any(100 < v < 200 for v in found), found)

    def test_suggestions_give_surfaces(self):
        self.put_sphere()
        for iso in self.suggested(self.succeed("info", "sphere.nrrd")):
            self.succeed("extract", "sphere.nrrd", "--iso", iso, "-o", "s.ply", "-q", "--coarse")

    def test_signed_distance_fields_get_isovalue_zero(self):
        samples = array.array("f", (max(-2, min(2, s)) for s in sphere((16, 16, 16))))
        self.put("d.nrrd", nrrd(samples, (16, 16, 16)))
        self.assertRegex(self.succeed("info", "d.nrrd"),
                         r"(?m)^(  isovalues)? +0 +the range is symmetric about 0")
        whole = array.array("h", (round(100 * s) for s in samples))
        self.put("i.nrrd", nrrd(whole, (16, 16, 16), "short"))
        self.assertIn(-0.5, self.suggested(self.succeed("info", "i.nrrd")))

    def test_binary_and_constant(self):
        self.put("b.nrrd", nrrd(bytes([0] * 500 + [1] * 12), (8, 8, 8), "uchar"))
        self.assertEqual(self.suggested(self.succeed("info", "b.nrrd")), [0.5])
        self.put("c.nrrd", nrrd(bytes([3] * 512), (8, 8, 8), "uchar"))
        self.assertRegex(self.succeed("info", "c.nrrd"), r"isovalues +none: all samples are equal")

    def test_not_finite_samples_are_counted_not_drawn(self):
        samples = sphere((8, 8, 8))
        samples[9], samples[10], samples[11] = math.inf, math.nan, -math.inf
        self.put("n.nrrd", nrrd(samples, (8, 8, 8)))
        self.assertRegex(self.succeed("info", "n.nrrd"),
                         r"not finite +1 NaN, 2 infinite, first at \(1, 1, 0\)")
        self.put("all.nrrd", nrrd(array.array("f", [math.nan] * 512), (8, 8, 8)))
        self.assertRegex(self.succeed("info", "all.nrrd"), r"not finite +512 NaN")

    def test_extreme_values(self):
        self.put("d.nrrd", nrrd(array.array("d", [-1.7e308, 1.7e308] * 256), (8, 8, 8), "double"))
        self.succeed("info", "d.nrrd")
        self.put("q.raw", struct.pack("<512q", *([-2 ** 63, 2 ** 63 - 1] * 256)))
        self.succeed("info", "q.raw", "--raw-size", "8,8,8", "--raw-type", "int64")
        self.put("f.nrrd", nrrd(array.array("f", [1e-42, 3e-42] * 256), (8, 8, 8)))
        self.succeed("info", "f.nrrd")

    def test_histogram_depends_on_the_locale(self):
        self.put_sphere()
        self.assertRegex(self.succeed("info", "sphere.nrrd", locale="en_US.UTF-8"), "[▁▂▃▄▅▆▇█]")
        plain = self.succeed("info", "sphere.nrrd", locale="C")
        self.assertTrue(plain.isascii())
        self.assertIn("#", plain)

    def test_bad_files(self):
        self.refuse("nowhere", "info", "nowhere.nrrd")


class Check(ToolTest):

    def check(self, status, positions, triangles):
        self.put("m.off", off(positions, triangles))
        result = self.run_tool("check", "m.off")
        as_json = self.run_tool("check", "m.off", "--json")
        self.assertEqual((result.returncode, as_json.returncode), (status, status),
                         result.stdout + result.stderr)
        return result.stdout, json.loads(as_json.stdout)

    def test_closed(self):
        text, numbers = self.check(0, *TETRAHEDRON)
        self.assertRegex(
            text,
            r"manifold +yes\n +oriented +yes\n +closed +yes\n +topology +1 component, genus 0, 0 "
            r"boundary loops")
        self.assertRegex(text, r"kinds +1 x \(genus 0, closed\)")
        self.assertEqual((numbers["schema"], numbers["edges"], numbers["closed"]),
                         ("isoatlas-check-1", 6, True))
        self.assertAlmostEqual(numbers["quality"]["aspect_ratio"]["minimum"], 1 / math.sqrt(2),
                               places=6)

    def test_extent(self):
        text, numbers = self.check(0, [(2 * x + 1, 3 * y, 4 * z) for x, y, z in TETRAHEDRON[0]],
                                   TETRAHEDRON[1])
        self.assertRegex(text, r"(?m)^  extent +2 x 3 x 4, from \(1, 0, 0\) to \(3, 3, 4\)$")
        self.assertRegex(text, r"(?m)^  area +20\.8102 square units\n  encloses +4 cubic units$")
        self.assertNotIn("component 0", text)
        extent = numbers["extent"]
        self.assertEqual((extent["low"], extent["high"], extent["volume"]), ([1, 0, 0], [3, 3, 4],
                                                                             4))
        self.assertAlmostEqual(extent["area"], 3 + 4 + 6 + math.sqrt(61))
        self.assertEqual(len(extent["largest"]), 1)

    def test_extent_of_components(self):
        positions, triangles = [], []
        for side in range(1, 9):  # one is open, one faces inwards
            n = len(positions)
            positions += [(side * x + 20 * side, side * y, side * z) for x, y, z in TETRAHEDRON[0]]
            these = [tuple(v + n for v in t) for t in TETRAHEDRON[1]]
            triangles += these[1:] if side == 5 else these
            if side == 2:
                triangles[-4:] = [(a, c, b) for a, b, c in triangles[-4:]]
        text, numbers = self.check(0, positions, triangles)
        cubes = sum(side**3 for side in range(1, 9)) - 5**3 - 2 * 2**3
        self.assertRegex(text, rf"encloses +{cubes / 6:.6g} cubic units in 7 closed components; "
                         "1 open component encloses nothing")
        shown = re.findall(r"(?m)^ +component (\d): (\d) x \d x \d, area \S+ square units, (.*)$",
                           text)
        self.assertEqual([int(size) for _, size, _ in shown], [8, 7, 6, 5, 4, 3])
        self.assertEqual(shown[0], ("7", "8", "encloses 85.3333 cubic units"))
        self.assertEqual(shown[3], ("4", "5", "open"))
        self.assertIn("and 2 smaller components", text)
        extent = numbers["extent"]
        self.assertAlmostEqual(extent["volume"], cubes / 6)
        self.assertEqual(extent["open_components"], 1)
        self.assertAlmostEqual(extent["largest"][6]["volume"], -8 / 6)
        self.assertEqual([c["component"] for c in extent["largest"]], [7, 6, 5, 4, 3, 2, 1, 0])

    def test_a_volume_that_faces_inwards_is_negative(self):
        text, inward = self.check(0, TETRAHEDRON[0], [(a, c, b) for a, b, c in TETRAHEDRON[1]])
        self.assertRegex(
            text, r"encloses +-0\.166667 cubic units \(negative: the triangles face inwards\)")
        self.assertAlmostEqual(inward["extent"]["volume"], -1 / 6)

    def test_a_list_of_components_has_a_limit(self):
        positions, triangles = [], []
        for i in range(1200):
            n = len(positions)
            positions += [(x + 2 * i, y, z) for x, y, z in TETRAHEDRON[0]]
            triangles += [tuple(v + n for v in t) for t in TETRAHEDRON[1]]
        text, numbers = self.check(0, positions, triangles)
        self.assertIn("and 1,194 smaller components", text)
        self.assertEqual(len(numbers["extent"]["largest"]), 1000)
        self.assertAlmostEqual(numbers["extent"]["volume"], 200)

    def test_extent_of_an_open_mesh(self):
        text, numbers = self.check(0, TETRAHEDRON[0], TETRAHEDRON[1][:3])
        self.assertRegex(text, r"encloses +nothing: the mesh is open")
        self.assertIsNone(numbers["extent"]["volume"])
        self.assertEqual(numbers["extent"]["largest"][0]["boundary_loops"], 1)

    def test_extent_in_the_unit_that_a_mesh_states(self):
        self.put("s.nrrd", nrrd(sphere((20, 20, 20)), (20, 20, 20), "float", "space dimension: 3",
                                'space units: "mm" "mm" "mm"',
                                "space directions: (0.5,0,0) (0,0.5,0) (0,0,0.5)"))
        self.succeed("extract", "s.nrrd", "--iso", "0", "--max-distance", "0.1vx", "-o", "s.3mf",
                     "--report", "s.json", "-q")
        text = self.succeed("check", "s.3mf")
        volume = 4 / 3 * math.pi * 3.5**3
        shown = re.search(r"encloses +(\S+) cubic mm\n", text)
        self.assertAlmostEqual(float(shown.group(1)) / volume, 1, delta=0.04)
        self.assertRegex(text, r"extent +\S+ x \S+ x \S+ mm, from")
        level = json.loads((self.folder / "s.json").read_text())["levels"][-1]
        self.assertAlmostEqual(level["extent"]["volume"] / volume, 1, delta=0.04)
        details = self.succeed("extract", "s.nrrd", "--iso", "0", "-o", "s.ply", "--space",
                               "voxel", "-v")
        self.assertRegex(details, r"extent +1\S+ x 1\S+ x 1\S+ samples, from")
        self.assertRegex(details, r"encloses +1\S+ cubic mm\n")

    def test_open(self):
        text, numbers = self.check(0, TETRAHEDRON[0], TETRAHEDRON[1][:3])
        self.assertRegex(text, r"closed +no: 3 boundary edges")
        self.assertEqual((numbers["boundary_loops"], numbers["closed"], numbers["genus"]),
                         (1, False, 0))

    def test_flipped_triangle(self):
        triangles = [(0, 1, 2)] + TETRAHEDRON[1][1:]
        text, numbers = self.check(1, TETRAHEDRON[0], triangles)
        self.assertRegex(text, r"oriented +no: 3 edges")
        self.assertEqual((numbers["oriented"], numbers["genus"], numbers["inconsistent_edges"]),
                         (False, None, 3))

    def test_edge_of_three_triangles(self):
        text, numbers = self.check(1, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, -1, 0)],
                                   [(0, 1, 2), (1, 0, 3), (0, 1, 4)])
        self.assertRegex(text, r"manifold +no: 1 edges in three or more triangles")
        self.assertFalse(numbers["manifold"])

    def test_two_fans_at_a_vertex(self):
        positions = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (-1, 0, 0), (-1, -1, 0)]
        text, _ = self.check(1, positions, [(0, 1, 2), (0, 3, 4)])
        self.assertRegex(text, r"manifold +no: 1 vertices with more than one fan")

    def test_repeated_corner(self):
        text, numbers = self.check(1, TETRAHEDRON[0], TETRAHEDRON[1] + [(0, 1, 1)])
        self.assertEqual(numbers["degenerate_triangles"], 1)
        self.assertIn("use a vertex twice", text)

    def test_self_intersections(self):
        positions, triangles = [(0, 0, 0), (4, 0, 0), (0, 4, 0), (1, 1, 1), (1, 1, -1),
                                (5, 5, 0)], [(0, 1, 2), (3, 4, 5)]
        text, numbers = self.check(0, positions, triangles)  # not requested
        self.assertNotIn("intersections", text)
        self.assertIsNone(numbers["self_intersections"])
        result = self.run_tool("check", "m.off", "--self-intersections")
        self.assertEqual((result.returncode, result.stderr), (1, ""))
        self.assertRegex(
            result.stdout,
            r"intersections +1 pair of triangles\n +triangles 0 and 1 near \(2.5, 2.5, 0\)\n")
        result = self.run_tool("check", "m.off", "--self-intersections", "--json")
        self.assertEqual(
            (result.returncode, json.loads(result.stdout)["self_intersections"]),
            (1, {"pairs": 1, "first": [{"triangles": [0, 1], "position": [2.5, 2.5, 0]}]}))

    def test_no_self_intersections(self):
        self.put("m.off", off(*TETRAHEDRON))
        self.assertRegex(self.succeed("check", "m.off", "--self-intersections"),
                         r"intersections +none\n")
        self.assertEqual(
            json.loads(self.succeed("check", "m.off", "--self-intersections",
                                    "--json"))["self_intersections"], {"pairs": 0, "first": []})

    def test_the_first_of_many_self_intersections_are_listed(self):
        ladder = [point for k in range(5) for point in ((0, 0, k), (9, 0, k), (0, 9, k))]
        nails = [
            point for k in range(3) for point in ((1, 1 + k, -1), (1, 1 + k, 9), (1, 1.5 + k, -1))
        ]
        self.put("m.off", off(ladder + nails, [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(8)]))
        result = self.run_tool("check", "m.off", "--self-intersections")
        self.assertEqual(result.returncode, 1)
        self.assertIn("15 pairs of triangles", result.stdout)
        self.assertEqual(result.stdout.count(" near "), 10)
        self.assertRegex(result.stdout, r"(?m)^ +and 5 more pairs$")
        numbers = json.loads(
            self.run_tool("check", "m.off", "--self-intersections",
                          "--json").stdout)["self_intersections"]
        self.assertEqual((numbers["pairs"], len(numbers["first"])), (15, 10))

    def test_bad_files(self):
        self.refuse("nowhere.ply", "check", "nowhere.ply")
        self.put("bad.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n")
        self.refuse("bad.off", "check", "bad.off")
        self.put("cut.off", off(*TETRAHEDRON)[:-20])
        self.refuse("cut.off", "check", "cut.off")
        self.put("m.xyz", b"0 0 0\n")
        self.refuse("m.xyz.*expected one of .ply .stl .obj .off .vtp .3mf .gii$", "check", "m.xyz")
        self.put("m.glb", b"glTF")
        self.refuse(
            "m.glb: is a file of levels of detail, expected one of .ply .stl .obj .off .vtp .3mf "
            ".gii; isoatlas levels", "check", "m.glb")

    def test_histogram_depends_on_the_locale(self):
        self.put("m.off", off(*TETRAHEDRON))
        self.assertRegex(self.succeed("check", "m.off", locale="C.UTF-8"), "█")
        self.assertTrue(self.succeed("check", "m.off", locale="POSIX").isascii())


class CheckDistance(ToolTest):
    """isoatlas check MESH --volume V --iso X."""

    def plane(self, name, height, size=(16, 16, 16), *header):
        """Samples that fall linearly upwards: inside is below `height`."""
        nx, ny, nz = size
        samples = array.array("f", (height - z for z in range(nz) for _ in range(nx * ny)))
        return self.put(name, nrrd(samples, size, "float", *header))

    def distance(self, *arguments):
        result = json.loads(self.succeed("check", *arguments, "--json"))
        self.assertEqual(result["schema"], "isoatlas-check-1")
        return result["distance"]

    def square(self, height, low=4.0, high=10.0):
        return [(low, low, height), (high, low, height), (high, high, height),
                (low, high, height)], [(0, 1, 2), (0, 2, 3)]

    def test_null_without_a_volume(self):
        self.put("m.off", off(*TETRAHEDRON))
        self.assertIsNone(json.loads(self.succeed("check", "m.off", "--json"))["distance"])

    def test_offset_plane(self):
        self.plane("p.nrrd", 7.25)
        self.put("m.off", off(*self.square(8.75)))
        found = self.distance("m.off", "--volume", "p.nrrd", "--iso", "0", "--samples", "500")
        self.assertEqual((found["volume"], found["isovalue"], found["inside"], found["topology"],
                          found["non_finite"], found["space"]),
                         ("p.nrrd", 0, "above", "trilinear", "refuse", "lps"))
        self.assertEqual((found["samples_wanted"], found["voxel"]), (500, 1))
        one = found["mesh_to_surface"]
        for number in ("maximum", "mean", "root_mean_square", "p50", "p99"):
            self.assertAlmostEqual(one["world"][number], 1.5, places=5)
            self.assertAlmostEqual(one["voxels"][number], 1.5, places=5)
        self.assertEqual(one["samples"], 500 + 2 + 5 + 4)
        self.assertAlmostEqual(one["samples_per_voxel_face"], 500 / 36)
        self.assertAlmostEqual(one["farthest"][2], 8.75, places=5)
        # The surface spans the volume, the mesh only a part of it.
        other = found["surface_to_mesh"]
        self.assertAlmostEqual(other["world"]["maximum"], math.sqrt(5 ** 2 + 5 ** 2 + 1.5 ** 2),
                               places=4)
        self.assertEqual(found["maximum"], other["world"]["maximum"])
        self.assertGreater(other["samples"], 500)
        self.assertLess(found["normal_degrees"]["maximum"], 0.001)
        self.assertAlmostEqual(found["surface_area"], 225, places=3)
        self.assertAlmostEqual(found["mesh_area"], 36, places=5)

    def test_text(self):
        self.plane("p.nrrd", 7.25, (16, 16, 16), "spacings: 2 2 2")
        self.put("m.off", off(*self.square(16.5, 8, 20)))
        text = self.succeed("check", "m.off", "--volume", "p.nrrd", "--iso", "0", "--samples",
                            "2000")
        self.assertRegex(text,
                         r"distance +to the isosurface at 0 of p\.nrrd, mesh in LPS, 1 vx = 2\n")
        self.assertRegex(
            text, r"to surface +mean 2 \(1 vx\), 99 % within 2 \(1 vx\), maximum 2 \(1 vx\) at \(")
        self.assertRegex(text, r"2,011 samples: 2,000 spread evenly, 55\.556 per square voxel")
        self.assertRegex(text, r"to mesh +mean ")
        self.assertRegex(text, r"normals +off by ")
        self.assertNotIn("distance", self.succeed("check", "m.off"))

    def test_inside_determines_the_expected_orientation(self):
        self.plane("p.nrrd", 7.25)
        self.put("m.off", off(*self.square(7.25)))
        for side, degrees in (("above", 0), ("below", 180)):
            found = self.distance("m.off", "--volume", "p.nrrd", "--iso", "0", "--inside", side,
                                  "--samples", "10")
            self.assertAlmostEqual(found["normal_degrees"]["mean"], degrees, places=3)

    def test_topology(self):
        # A grid cell with a wide tunnel: the tunnel and the two disks that close it differ in area.
        self.put("cell.nrrd",
                 nrrd(array.array("f", [9, -1, -1, -1, -1, -1, -1, 9]), (2, 2, 2), "float"))
        area = {}
        for rule in ("trilinear", "faces"):
            self.succeed("extract", "cell.nrrd", "--iso", "0", "--topology", rule, "--coarse", "-o",
                         f"{rule}.off", "-q")
            found = self.distance("trilinear.off", "--volume", "cell.nrrd", "--iso", "0",
                                  "--samples", "1000", "--topology", rule)
            self.assertEqual(found["topology"], rule)
            area[rule] = found["surface_area"]
        self.assertNotAlmostEqual(area["trilinear"], area["faces"], places=2)
        self.assertEqual(
            self.distance("trilinear.off", "--volume", "cell.nrrd", "--iso", "0", "--samples",
                          "1000")["surface_area"], area["trilinear"])

    def test_every_format_states_its_space(self):
        self.put(
            "s.nrrd",
            nrrd(sphere((20, 20, 20)), (20, 20, 20), "float", "space: left-posterior-superior",
                 "space directions: (2,0,0) (0,2,0) (0,0,2)", "space origin: (100,200,300)"))
        seen = set()
        for space in ("lps", "ras", "voxel"):
            for extension in MESH_EXTENSIONS:
                self.succeed("extract", "s.nrrd", "--iso", "0", "--max-radius", "2vx", "--space",
                             space, "-o", f"s.{extension}", "-q")
                found = self.distance(f"s.{extension}", "--volume", "s.nrrd", "--iso", "0",
                                      "--samples", "1000")
                self.assertEqual(found["space"], "ras" if
                                 (space, extension) == ("lps", "gii") else space, extension)
                self.assertEqual(found["voxel"], 2)
                self.assertLess(found["maximum"], 2)
                seen.add(round(found["maximum"], 3))
        self.assertEqual(len(seen), 1)
        # --space overrides the file: indices that are read as LPS are far from the surface.
        far = self.run_tool("check", "s.off", "--volume", "s.nrrd", "--iso", "0", "--space", "lps",
                            "--samples", "10", "--json")
        self.assertGreater(json.loads(far.stdout)["distance"]["mean"], 100)

    def test_a_mesh_far_from_its_volume(self):
        self.put(
            "s.nrrd",
            nrrd(sphere((20, 20, 20)), (20, 20, 20), "float", "space: left-posterior-superior",
                 "space directions: (2,0,0) (0,2,0) (0,0,2)", "space origin: (100,200,300)"))
        measure = ["--volume", "s.nrrd", "--iso", "0", "--samples", "10"]
        for written in ("lps", "ras", "voxel"):
            self.succeed("extract", "s.nrrd", "--iso", "0", "--space", written, "-o", "s.ply", "-q")
            for read in ("lps", "ras", "voxel"):
                result = self.run_tool("check", "s.ply", *measure, "--space", read)
                self.assertIn("distance", result.stdout)
                if read == written:
                    self.assertEqual((result.returncode, result.stderr), (0, ""))
                    continue
                self.assertEqual(result.returncode, 1)
                self.assertRegex(
                    result.stderr,
                    r"\Aisoatlas: s.ply: is nowhere near the volume: [^\n]+; they overlap with "
                    r"--space " + written + "\n\\Z")
                box = {
                    "lps": "100..138 200..238 300..338", "ras": "-138..-100 -238..-200 300..338",
                    "voxel": "0..19 0..19 0..19"
                }[read]
                self.assertIn(f"of the volume in {read} {box};", result.stderr)
        # No space overlaps: none is proposed. Then a mesh that overlaps, but is much too large.
        self.put("m.off", off([(x - 1e4, y, z) for x, y, z in TETRAHEDRON[0]], TETRAHEDRON[1]))
        result = self.run_tool("check", "m.off", *measure)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(
            result.stderr,
            r"-10000..-9999 0..1 0..1, .*; use --space to state the coordinates of the mesh\n\Z")
        self.put("m.off",
                 off([(1e4 * x, 1e4 * y, 1e4 * z) for x, y, z in TETRAHEDRON[0]], TETRAHEDRON[1]))
        self.assertIn("nowhere near", self.run_tool("check", "m.off", *measure).stderr)

    def test_lps_is_the_default_space(self):
        self.put_sphere()
        self.put("m.off", off(*TETRAHEDRON))
        self.assertEqual(
            self.distance("m.off", "--volume", "sphere.nrrd", "--iso", "0", "--samples",
                          "10")["space"], "lps")

    def test_raw_samples_and_nan(self):
        n = 12
        samples = sphere((n, n, n))
        samples[0] = math.nan
        self.put("s.raw", little(samples))
        raw = ["--raw-size", f"{n},{n},{n}", "--raw-type", "float32", "--raw-spacing", "3,3,3"]
        self.succeed("extract", "s.raw", *raw, "--iso", "0.01", "--nan", "below", "--max-radius",
                     "1vx", "-o", "s.ply", "-q")
        self.refuse("s.raw: .*NaN", "check", "s.ply", "--volume", "s.raw", *raw, "--iso", "0.01")
        found = self.distance("s.ply", "--volume", "s.raw", *raw, "--iso", "0.01", "--nan", "below",
                              "--samples", "100")
        self.assertEqual((found["voxel"], found["non_finite"]), (3, "below"))
        self.assertLess(found["maximum"], 3)

    def test_same_numbers_each_time(self):
        self.put_sphere()
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply", "-q")
        arguments = ["check", "s.ply", "--volume", "sphere.nrrd", "--iso", "0", "--json"]
        self.assertEqual(self.succeed(*arguments), self.succeed(*arguments))

    def test_distances_do_not_change_the_exit_status(self):
        self.put_sphere()
        self.put("m.off", off(TETRAHEDRON[0], [(0, 1, 2)] + TETRAHEDRON[1][1:]))
        result = self.run_tool("check", "m.off", "--volume", "sphere.nrrd", "--iso", "0",
                               "--samples", "10")
        self.assertEqual((result.returncode, result.stderr), (1, ""))
        self.assertIn("distance", result.stdout)

    def test_arguments(self):
        self.put_sphere()
        self.put("m.off", off(*TETRAHEDRON))
        self.refuse(r"--iso requires --volume.*see isoatlas check --help", "check", "m.off",
                    "--iso", "0")
        self.refuse(r"--volume requires --iso", "check", "m.off", "--volume", "sphere.nrrd")
        for option, value in (("--inside", "above"), ("--topology", "faces"), ("--nan", "below"),
                              ("--space", "ras"), ("--samples", "5")):
            self.refuse(f"{option} requires --volume", "check", "m.off", option, value)
        self.refuse("--raw-size requires --volume", "check", "m.off", "--raw-size", "8,8,8",
                    "--raw-type", "uint8")
        good = ["check", "m.off", "--volume", "sphere.nrrd"]
        for option, values in {
                "--samples": ["0", "-1", "1.5", "many", "", "99999999999"],
                "--iso": ["nan", "", "x"], "--space": ["LPI", "world"], "--inside": ["out"],
                "--topology": ["face", "both"], "--nan": ["refuse"],
        }.items():
            for value in values:
                rest = [] if option == "--iso" else ["--iso", "0"]
                self.refuse(option, *good, *rest, f"{option}={value}")
        self.refuse("nowhere.nrrd", "check", "m.off", "--volume", "nowhere.nrrd", "--iso", "0")
        self.refuse("sphere.nrrd: no surface at isovalue 1000: samples range", *good, "--iso",
                    "1000")
        self.put("far.off", off([(0, 0, 0), (1e30, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
        self.refuse("vertex 1 .*voxels away", "check", "far.off", "--volume", "sphere.nrrd",
                    "--iso", "0")


def read_glb(path):
    """The JSON and the binary chunk of a .glb, after checking its container."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    chunks, offset = [], 12
    while offset < length:
        size, kind = struct.unpack_from("<I4s", data, offset)
        assert size % 4 == 0 and offset + 8 + size <= length
        chunks.append((kind, data[offset + 8:offset + 8 + size]))
        offset += 8 + size
    assert [kind for kind, _ in chunks] == [b"JSON", b"BIN\0"]
    return json.loads(chunks[0][1]), chunks[1][1]


class Glb:
    """An independent reader of the .glb files of isoatlas, with struct and json."""

    COMPONENTS = {"SCALAR": 1, "VEC3": 3}
    TYPES = {5125: "I", 5126: "f"}

    def __init__(self, path):
        self.json, self.binary = read_glb(path)
        assert self.json["buffers"] == [{"byteLength": len(self.binary)}]
        nodes = self.json["nodes"]
        first = nodes[self.json["scenes"][self.json["scene"]]["nodes"][0]]
        ids = first.get("extensions", {}).get("MSFT_lod", {}).get("ids", [])
        assert bool(ids) == ("MSFT_lod" in self.json.get("extensionsUsed", []))
        assert len(set(ids)) == len(ids) and all(0 < i < len(nodes) for i in ids)
        if ids:
            coverage = first["extras"]["MSFT_screencoverage"]
            assert len(coverage) == 1 + len(ids) and coverage == sorted(coverage, reverse=True)
        self.nodes = [first] + [nodes[i] for i in ids]  # finest first
        self.meshes = [self.json["meshes"][node["mesh"]] for node in self.nodes]

    def accessor(self, index):
        a = self.json["accessors"][index]
        view = self.json["bufferViews"][a["bufferView"]]
        count, code = self.COMPONENTS[a["type"]], self.TYPES[a["componentType"]]
        stride = view.get("byteStride", 4 * count)
        assert view["byteOffset"] % 4 == 0
        assert view["byteOffset"] + view["byteLength"] <= len(self.binary)
        assert a.get("byteOffset", 0) + stride * (a["count"] - 1) + 4 * count <= view["byteLength"]
        start = view["byteOffset"] + a.get("byteOffset", 0)
        rows = [
            struct.unpack_from(f"<{count}{code}", self.binary, start + stride * i)
            for i in range(a["count"])
        ]
        if "min" in a:
            assert a["min"] == [min(c) for c in zip(*rows)]
            assert a["max"] == [max(c) for c in zip(*rows)]
        return rows

    def level(self, mesh):
        (primitive, ) = mesh["primitives"]
        assert primitive["mode"] == 4
        assert "min" in self.json["accessors"][primitive["attributes"]["POSITION"]]
        positions = self.accessor(primitive["attributes"]["POSITION"])
        normals = self.accessor(primitive["attributes"]["NORMAL"])
        indices = [i for i, in self.accessor(primitive["indices"])]
        assert len(normals) == len(positions) and len(indices) % 3 == 0
        assert max(indices) < len(positions)
        assert all(abs(math.hypot(*n) - 1) < 1e-5 for n in normals)
        return positions, normals, [tuple(indices[i:i + 3]) for i in range(0, len(indices), 3)]


class Levels(ToolTest):

    def extract(self, output, *options):
        """A run that may violate constraints and prints one line for each."""
        if not (self.folder / "torus.nrrd").exists():
            self.put("torus.nrrd", nrrd(torus(24), (24, 24, 24)))
        result = self.run_tool("extract", "torus.nrrd", "--iso", "0", "-o", output, *options)
        self.assertIn(result.returncode, (0, 1), result.stderr)
        lines = result.stderr.splitlines()
        self.assertEqual(result.returncode, 1 if lines else 0)
        for line in lines:
            self.assertRegex(
                line, r"\Aisoatlas: level \d+: [a-z-]+ [\d.,e+-]+( degrees)?: reached [\d.,e+-]+( "
                r"degrees)?(: .+)?\Z")
        return result.stdout

    def report(self):
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    TWO = ["--refine", "max-distance:2vx", "--refine", "max-distance:0.5vx"]

    def test_a_number_of_levels(self):
        self.put_sphere(n=60)
        out = self.succeed("extract", "sphere.nrrd", "--iso", "0", "--levels", "3", "-o", "s.glb",
                           "--max-distance", "0.2", "--max-edge", "15", "--report", "r.json",
                           "--glb-per-level")
        self.assertEqual(re.findall(r"(?m)^  level (\d)", out), ["0", "1", "2"])
        report = json.loads((self.folder / "r.json").read_text())
        self.assertEqual(report["parameters"]["levels"], 3)
        bounds = [[one["bound"] for one in goal] for goal in report["parameters"]["refine"]]
        self.assertEqual(bounds, [[0.8, 15], [0.4, 15], [0.2, 15]])
        self.assertEqual([level["constraints"][0]["bound"] for level in report["levels"]],
                         [0.8, 0.4, 0.2])
        triangles = [level["triangles"] for level in report["levels"]]
        self.assertGreater(triangles[0], 40)
        self.assertEqual(triangles, sorted(triangles))
        self.assertIn("s-2.glb", self.files())
        self.assertNotIn("s-3.glb", self.files())
        levels = json.loads(self.succeed("levels", "s.glb", "--json"))
        self.assertIs(levels["nested"], True)
        self.assertEqual([level["triangles"] for level in levels["levels"]], triangles)

    def test_a_number_of_levels_into_a_file_for_each(self):
        self.put_sphere()
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "--levels", "2", "-o", "s-{level}.ply",
                     "-q")
        self.assertEqual(self.files(), ["s-0.ply", "s-1.ply", "sphere.nrrd"])
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "--levels", "2", "-o", "b.glb", "-q",
                     "--placement", "balanced", "--html", "b.html")
        self.succeed("levels", "b.glb")

    def test_summary_has_a_line_for_each_level(self):
        printed = self.extract("t.ply", *self.TWO, "--report", "r.json")
        for k, level in enumerate(self.report()["levels"]):
            self.assertRegex(
                printed,
                rf"(?m)^  level {k} +{level['vertices']:,} vertices, {level['triangles']:,} "
                rf"triangles")

    def test_one_file_per_level(self):
        self.extract("t-{level}.off", *self.TWO, "--report", "r.json", "-q")
        report = self.report()
        self.assertEqual([f["path"] for f in report["files"]],
                         [f"t-{k}.off" for k in range(len(report["levels"]))])
        coarser = []
        for k, level in enumerate(report["levels"]):
            self.assertEqual(level["path"], f"t-{k}.off")
            checked = json.loads(self.succeed("check", f"t-{k}.off", "--json"))
            for key in ("vertices", "triangles", "genus", "boundary_loops", "components"):
                self.assertEqual(checked[key], level[key])
            positions = off_positions((self.folder / f"t-{k}.off").read_text())
            self.assertEqual(positions[:len(coarser)], coarser)
            coarser = positions
        self.extract("f.off", *self.TWO, "-q")
        self.assertEqual((self.folder / "f.off").read_bytes(),
                         (self.folder / f"t-{k}.off").read_bytes())

    def test_glb_conforms_to_gltf(self):
        for options in ([], ["--placement", "balanced"]):
            self.extract("t.glb", *self.TWO, "--report", "r.json", "-q", *options)
            report = self.report()
            glb = Glb(self.folder / "t.glb")
            self.assertEqual(glb.json["asset"]["version"], "2.0")
            self.assertRegex(glb.json["asset"]["generator"], r"isoatlas \d")
            self.assertEqual(len(glb.meshes), len(report["levels"]))
            finest = None
            for mesh, level in zip(glb.meshes, reversed(report["levels"]), strict=True):
                positions, normals, triangles = glb.level(mesh)
                self.assertEqual((len(positions), len(triangles)),
                                 (level["vertices"], level["triangles"]))
                self.assertEqual(mesh["name"], f"level {level['level']}")
                stated = mesh["extras"]["isoatlas"]
                self.assertEqual(
                    stated,
                    {k: v
                     for k, v in level.items() if k not in ("path", "rounding", "seconds")})
                if not options:
                    finest = finest or positions
                    self.assertEqual(positions, finest[:len(positions)])
                    views = {
                        glb.json["accessors"][m["primitives"][0]["attributes"]["POSITION"]]
                        ["bufferView"]
                        for m in glb.meshes
                    }
                    self.assertEqual(len(views), 1)
                # A torus about the z axis: normals point away from its middle circle.
                outward = 0
                for p, n in zip(positions, normals):
                    x, y, z = (c - 11.5 for c in p)
                    r = math.hypot(x, y) or 1
                    away = (x - 7.2 * x / r, y - 7.2 * y / r, z)
                    outward += sum(a * b for a, b in zip(away, n)) > 0
                self.assertGreater(outward, 0.7 * len(positions))
            (written, ) = report["files"]
            self.assertEqual((written["positions"], written["levels"]),
                             ("float32", list(range(len(report["levels"])))))
            self.assertTrue(0 < written["largest_rounding"] < 1e-5)

    def test_glb_far_from_the_origin_has_a_translation(self):
        self.put(
            "far.nrrd",
            nrrd(sphere((20, 20, 20)), (20, 20, 20), "float", "space: left-posterior-superior",
                 "space directions: (0.001,0,0) (0,0.001,0) (0,0,0.001)",
                 "space origin: (1000000,-2000000,3)"))
        arguments = ["extract", "far.nrrd", "--iso", "0", "--coarse", "-q", "--report", "r.json"]
        self.succeed(*arguments, "-o", "far.glb")
        glb = Glb(self.folder / "far.glb")
        translation = glb.nodes[0]["translation"]
        for found, wanted in zip(translation, (1e6, -2e6, 3), strict=True):
            self.assertAlmostEqual(found, wanted, delta=0.2)
        self.assertLess(self.report()["files"][0]["largest_rounding"], 2e-8)
        self.succeed("levels", "far.glb")
        # STL has no translation: floats are 1/16 or 1/8 apart, and the sphere would be a line.
        self.refuse(r": far\.stl: .*float coordinates", *arguments, "-o", "far.stl")
        self.refuse(r": far-0\.stl: .*float coordinates", *arguments, "-o", "far-{level}.stl")

    def test_one_glb_per_level(self):
        self.extract("t.glb", *self.TWO, "--glb-per-level", "--report", "r.json", "-q")
        report, listed = self.report(), json.loads((self.folder / "t.json").read_text())
        self.assertEqual(len(listed["levels"]), len(report["levels"]))
        for k, (entry, level) in enumerate(zip(listed["levels"], report["levels"], strict=True)):
            self.assertEqual(
                (entry["file"], level["path"] if len(report["levels"]) > 1 else f"t-{k}.glb"),
                (f"t-{k}.glb", ) * 2)
            for key in ("vertices", "triangles", "genus", "metrics", "constraints"):
                self.assertEqual(entry[key], level[key])
            glb = Glb(self.folder / entry["file"])
            self.assertEqual(len(glb.level(glb.meshes[0])[2]), level["triangles"])
            self.assertEqual((self.folder / entry["file"]).stat().st_size, entry["bytes"])
            self.assertEqual(len(glb.json["nodes"]), 1)

    def test_same_bytes_with_any_number_of_threads(self):
        for name in ("t.glb", "t.vtm"):
            seen = set()
            for threads in ("1", "2", "0"):
                self.extract(name, *self.TWO, "-q", "--threads", threads)
                files = [self.folder / name] + sorted(self.folder.glob("t/*"))
                seen.add(b"".join(f.read_bytes() for f in files))
            self.assertEqual(len(seen), 1)

    def test_vtm_and_its_folder(self):
        self.extract("t.vtm", *self.TWO, "--report", "r.json", "-q")
        count = len(self.report()["levels"])
        wanted = ["r.json", "t", "t.vtm", "torus.nrrd"] + [f"t/t_{k}.vtp" for k in range(count)]
        self.assertEqual(self.files(), sorted(wanted))
        self.assertEqual([f["path"] for f in self.report()["files"]],
                         ["t.vtm"] + [f"t/t_{k}.vtp" for k in range(count)])
        for k in range(count):
            checked = json.loads(self.succeed("check", f"t/t_{k}.vtp", "--json"))
            self.assertEqual(checked["triangles"], self.report()["levels"][k]["triangles"])
        # A second run into the same folder replaces its own files and no others.
        first = (self.folder / "t" / "t_0.vtp").read_bytes()
        self.put("t/t_0.vtp", b"old")
        self.put("t/t_99.vtp", b"older")
        self.put("t/notes.txt", b"keep me")
        self.extract("t.vtm", *self.TWO, "-q")
        self.assertEqual((self.folder / "t" / "t_0.vtp").read_bytes(), first)
        self.assertEqual((self.folder / "t" / "t_99.vtp").read_bytes(), b"older")
        self.assertEqual((self.folder / "t" / "notes.txt").read_bytes(), b"keep me")
        self.assertEqual(self.files(), sorted(wanted + ["t/t_99.vtp", "t/notes.txt"]))

    def test_vtk_reads_the_vtm(self):
        self.extract("t.vtm", *self.TWO, "--report", "r.json", "-q")
        script = """
import json, sys
try:
    from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataReader
    from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet
except ImportError:
    sys.exit(77)
reader = vtkXMLMultiBlockDataReader()
reader.SetFileName("t.vtm")
reader.Update()
blocks = reader.GetOutput()
for k in range(blocks.GetNumberOfBlocks()):
    data = blocks.GetBlock(k)
    name = blocks.GetMetaData(k).Get(vtkCompositeDataSet.NAME())
    level = json.loads(data.GetFieldData().GetAbstractArray("LEVEL").GetValue(0))
    print(json.dumps([name, data.GetNumberOfPoints(), data.GetNumberOfPolys(), level]))
"""
        python = "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable
        result = subprocess.run([python, "-c", script], cwd=self.folder, capture_output=True,
                                encoding="utf-8", timeout=50)
        if result.returncode == 77:
            self.skipTest("no VTK for Python")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        blocks = [json.loads(line) for line in result.stdout.splitlines()]
        self.assertEqual(len(blocks), len(self.report()["levels"]))
        for (name, points, polygons, stated), level in zip(blocks,
                                                           self.report()["levels"], strict=True):
            self.assertEqual((name, points, polygons),
                             (f"level {level['level']}", level["vertices"], level["triangles"]))
            self.assertEqual(
                stated,
                {k: v
                 for k, v in level.items() if k not in ("path", "rounding", "seconds")})

    def test_failed_writes_leave_nothing_and_lose_nothing(self):
        self.put("noise.raw", random.Random(3).randbytes(32 ** 3))
        arguments = [
            "extract", "noise.raw", "--raw-size", "32,32,32", "--raw-type", "uint8", "--iso",
            "127.5", "--coarse"
        ]
        (self.folder / "o").mkdir()
        for name in ("o.glb", "o.vtm", "o/o_0.vtp", "o-0.ply", "o.json", "r.json"):
            self.put(name, b"old " + name.encode())
        before = {
            name: (self.folder / name).read_bytes()
            for name in self.files() if (self.folder / name).is_file()
        }

        def small_disk():
            restore_signals()
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))

        for output in (["o.glb"], ["o.vtm"], ["o-{level}.ply"], ["o.glb", "--glb-per-level"]):
            result = subprocess.run([str(TOOL), *arguments, "-o", *output, "--report", "r.json"],
                                    cwd=self.folder, preexec_fn=small_disk, capture_output=True,
                                    encoding="utf-8", timeout=50)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertRegex(result.stderr,
                             r"\Aisoatlas: error: o[^\n]*cannot be written[^\n]*\n\Z")
            self.assertNotIn(".isoatlas", result.stderr)
            self.assertEqual(
                {
                    n: (self.folder / n).read_bytes()
                    for n in self.files() if (self.folder / n).is_file()
                }, before)

    def levels(self, status, *arguments):
        result = self.run_tool("levels", *arguments)
        self.assertEqual((result.returncode, result.stderr), (status, ""))
        return result.stdout

    def test_table(self):
        for output in ("t.glb", "t.vtm"):
            self.extract(output, *self.TWO, "--report", "r.json", "-q")
            report = self.report()
            as_json = json.loads(self.levels(0, output, "--json"))
            self.assertEqual(as_json["nested"], True)
            of_report = json.loads(self.levels(0, "r.json", "--json"))
            self.assertIsNone(of_report["nested"])
            for found, stated, level in zip(as_json["levels"], of_report["levels"],
                                            report["levels"], strict=True):
                for key in ("level", "vertices", "triangles", "components", "genus",
                            "boundary_loops", "euler_characteristic"):
                    self.assertEqual((found[key], stated[key]), (level[key], level[key]))
                for metric in METRICS:
                    wanted = level["metrics"] and {
                        k: level["metrics"][metric][k]
                        for k in ("maximum", "mean")
                    }
                    self.assertEqual((found["metrics"][metric], stated["metrics"][metric]),
                                     (wanted, wanted))
                self.assertAlmostEqual(found["aspect_ratio"]["median"],
                                       level["quality"]["aspect_ratio"]["median"], places=4)
            text = self.levels(0, output)
            for row in ("level", "vertices", "triangles", "max-distance, maximum",
                        "aspect ratio, minimum", "angle, minimum", "genus", "boundary loops",
                        "components"):
                self.assertRegex(text, rf"(?m)^  {row} ")
            self.assertRegex(text.splitlines()[-1], r"^  nested +yes")
            self.assertRegex(self.levels(0, "r.json").splitlines()[-1], r"^  nested +not known")
            self.assertRegex(self.levels(0, "r.json"), r"(?m)^  manifold +- +- +-$")
            self.assertEqual([level["manifold"] for level in of_report["levels"]], [None] * 3)
        self.extract("b.glb", "--glb-per-level", "--placement", "balanced", "-q")
        self.levels(0, "b.json")
        self.assertRegex(self.levels(0, "b.glb").splitlines()[-1], r"^  nested +by index only")

    def test_infinite_metrics(self):
        self.extract("t.glb", "--report", "r.json", "-q")
        report = self.report()
        report["levels"][1]["metrics"]["area-curvature"]["maximum"] = None
        self.put("r.json", json.dumps(report).encode())
        self.assertRegex(self.levels(0, "r.json"),
                         r"(?m)^  area-curvature, maximum +[\d.]+ +unbounded$")
        self.assertNotIn("inf", self.levels(0, "r.json"))
        self.assertIsNone(
            json.loads(self.levels(0, "r.json",
                                   "--json"))["levels"][1]["metrics"]["area-curvature"]["maximum"])

    def test_a_level_that_is_not_a_manifold(self):
        self.extract("t.glb", "--coarse", "-q")
        gltf, binary = read_glb(self.folder / "t.glb")
        indices = gltf["accessors"][gltf["meshes"][0]["primitives"][0]["indices"]]
        start = gltf["bufferViews"][indices["bufferView"]]["byteOffset"]
        binary = bytearray(binary)
        # Inverts the first triangle.
        binary[start:start + 8] = binary[start + 4:start + 8] + binary[start:start + 4]
        self.put_glb("inverted.glb", gltf, bytes(binary))
        text = self.levels(1, "inverted.glb")
        self.assertRegex(text, r"(?m)^  manifold +NO$")

    def put_glb(self, name, gltf, binary):
        text = json.dumps(gltf).encode()
        text += b" " * (-len(text) % 4)
        size = 28 + len(text) + len(binary)
        self.put(
            name,
            struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON") + text +
            struct.pack("<I4s", len(binary), b"BIN\0") + binary)

    def test_levels_that_are_not_nested(self):
        positions, triangles = TETRAHEDRON
        moved = [(0.5, 0, 0), *positions[1:]]
        floats = [struct.pack("<12f", *(c for p in ps for c in p)) for ps in (positions, moved)]
        indices = struct.pack("<12I", *(i for t in triangles for i in t))
        views = [{"buffer": 0, "byteOffset": 48 * i, "byteLength": 48} for i in range(3)]
        accessors = [{
            "bufferView": i, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0],
            "max": [1, 1, 1]
        } for i in (0, 1)]
        accessors.append({"bufferView": 2, "componentType": 5125, "count": 12, "type": "SCALAR"})
        gltf = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "buffers": [{
                "byteLength": 144
            }], "nodes": [{"mesh": 0, "extensions": {"MSFT_lod": {"ids": [1]}}},
                          {"mesh": 1}], "extensionsUsed": ["MSFT_lod"],
            "meshes": [{"primitives": [{"attributes": {"POSITION": i}, "indices": 2}]}
                       for i in (0, 1)], "accessors": accessors, "bufferViews": views,
        }
        self.put_glb("m.glb", gltf, floats[0] + floats[1] + indices)
        text = self.levels(0, "m.glb")
        self.assertRegex(text.splitlines()[-1], r"^  nested +NO: vertex 0 of level 0")
        self.assertRegex(text, r"(?m)^  max-distance, maximum +- +-$")

    def test_bad_files(self):
        self.refuse("nowhere.glb", "levels", "nowhere.glb")
        self.put("t.ply", b"ply\n")
        self.refuse(r"t\.ply.*expected \.glb, \.vtm or \.json", "levels", "t.ply")
        self.put("text.glb", b"this is no glTF file")
        self.refuse("text.glb", "levels", "text.glb")
        self.put("text.vtm", b"this is no VTK file")
        self.refuse("text.vtm", "levels", "text.vtm")
        self.put("text.json", b"{")
        self.refuse("text.json", "levels", "text.json")
        self.put("other.json", b'{"schema": "isoatlas-check-1"}')
        self.refuse("other.json.*isoatlas-report-3", "levels", "other.json")
        self.put("wrong.json", b'{"schema": "isoatlas-report-3", "levels": [{"vertices": "many"}]}')
        self.refuse("wrong.json", "levels", "wrong.json")
        self.put("negative.json", b'{"schema": "isoatlas-report-3", "levels": [{"vertices": -1}]}')
        self.refuse("negative.json: vertices is -1, expected a whole number", "levels",
                    "negative.json")
        self.extract("t.glb", "--coarse", "-q")
        self.extract("t.vtm", "--coarse", "-q")
        self.put("cut.glb", (self.folder / "t.glb").read_bytes()[:-100])
        self.refuse("cut.glb", "levels", "cut.glb")
        (self.folder / "t" / "t_0.vtp").unlink()
        self.refuse("t_0.vtp", "levels", "t.vtm")
        gltf, binary = read_glb(self.folder / "t.glb")
        huge = 10 ** 9
        for where, key, value in (("accessors", "count", huge), ("accessors", "byteOffset", huge),
                                  ("bufferViews", "byteOffset", huge),
                                  ("accessors", "bufferView", 99), ("bufferViews", "byteLength",
                                                                    huge), ("nodes", "mesh", 7)):
            changed = json.loads(json.dumps(gltf))
            changed[where][0][key] = value
            self.put_glb("bad.glb", changed, binary)
            self.refuse("bad.glb", "levels", "bad.glb")
        deep = dict(gltf, extras=None)
        self.put_glb("deep.glb", deep, binary)
        text = b'{"asset":{"version":"2.0"},"extras":' + b"[" * 10 ** 6 + b"]" * 10 ** 6 + b"}"
        text += b" " * (-len(text) % 4)
        self.put("deep.glb",
                 struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text), len(text), b"JSON") + text)
        self.refuse("nested too deeply", "levels", "deep.glb")


def png_size(data):
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", data[16:24])


@unittest.skipUnless(os.environ.get("DISPLAY") or shutil.which("Xvfb"), "no X display and no Xvfb")
class Picture(ToolTest):

    def make(self, *options):
        self.succeed("picture", "s.glb", "-o", "p.png", "-q", *options)
        return (self.folder / "p.png").read_bytes()

    def setUp(self):
        super().setUp()
        self.put_sphere()
        self.succeed("extract", "sphere.nrrd", "--iso", "0", "-o", "s.glb", "-q", "--refine",
                     "max-distance:2vx", "--refine", "max-distance:0.3vx")

    def test_styles_levels_and_views_differ(self):
        seen = [
            self.make("--size", "160,120", *options)
            for options in ([], ["--style", "hidden-line"], ["--level", "0"], ["--view", "1,0,0"],
                            ["--up", "1,0,0", "--level", "0"], ["--zoom", "2"])
        ]
        self.assertEqual(len(set(seen)), len(seen))
        self.assertEqual({png_size(data) for data in seen}, {(160, 120)})
        self.assertEqual(self.make("--size", "160,120"), seen[0], "the same again")
        self.assertEqual(self.make("--size", "160,120", "--level", "2"), seen[0],
                         "the finest is the default")

    def test_the_extension_determines_the_format(self):
        for name, mark in (("p.PNG", b"\x89PNG"), ("p.jpg", b"\xff\xd8\xff"), ("p.JPEG",
                                                                               b"\xff\xd8\xff")):
            self.succeed("picture", "s.glb", "-o", name, "-q", "--size", "64,48")
            self.assertTrue((self.folder / name).read_bytes().startswith(mark), name)

    def test_names_of_views(self):
        for name, view in (("front", "0,-1,0"), ("back", "0,2,0"), (" Left", "1,0,0"),
                           ("right", "-1,0,0"), ("top", "0,0,1"), ("bottom", "0,0,-1")):
            up = ["--up", "0,-1,0"] if name in ("top", "bottom") else []
            self.assertEqual(self.make("--size", "64,48", "--view", name),
                             self.make("--size", "64,48", "--view", view, *up), name)

    def test_names_of_views_follow_the_space_of_the_mesh(self):
        wedge = array.array("f", (6 - max(abs(x - 10), abs(y - 10),
                                          abs(z - 10) + 0.4 * (y - 10) + 0.2 * (x - 10))
                                  for z in range(21) for y in range(21) for x in range(21)))
        self.put("ct.nrrd", nrrd(wedge, (21, 21, 21)))
        for name, space in (("l.ply", "lps"), ("r.ply", "ras"), ("v.ply", "voxel"),
                            ("r.gii", "lps")):
            self.succeed("extract", "ct.nrrd", "--iso", "0.5", "-o", name, "--space", space, "-q")
        def picture(name, *options):
            self.succeed("picture", name, "-o", "p.png", "-q", "--size", "80,60", *options)
            return (self.folder / "p.png").read_bytes()
        for view in ([], ["--view", "front"], ["--view", "left"], ["--view", "top"],
                     ["--view", "bottom"]):
            seen = picture("l.ply", *view)
            self.assertEqual(picture("r.ply", *view), seen, view)
            self.assertEqual(picture("v.ply", *view), seen, view)
        for name in ("r.ply", "r.gii"):
            self.assertEqual(picture(name, "--view", "left"), picture(name, "--view", "-1,0,0"))
            self.assertEqual(picture(name, "--view", "top"),
                             picture(name, "--view", "0,0,1", "--up", "0,1,0"))
        self.assertEqual(picture("r.ply", "--view", "0,0,1"), picture("l.ply", "--view", "0,0,1"))
        self.assertNotEqual(picture("l.ply", "--view", "left"), picture("l.ply", "--view", "right"))

    def test_every_direction_is_a_view(self):
        for view in ("0,0,1", "0,0,-5", "1e-9,0,1", "1e-300,0,0", "1e300,1e300,0", "0,1e-5,1"):
            self.assertEqual(png_size(self.make("--size", "40,30", "--view", view)), (40, 30))

    def test_default_size_and_summary(self):
        self.assertRegex(self.succeed("picture", "s.glb", "-o", "p.png"),
                         r"\A  wrote +p.png: [\d,]+ triangles, [\d.]+ KiB\n\Z")
        self.assertEqual(png_size((self.folder / "p.png").read_bytes()), (1200, 900))

    def test_the_largest_sizes_are_drawn(self):
        for size in [(6000, 60), (8192, 16)]:
            data = self.make("--size", "{},{}".format(*size))
            self.assertEqual(png_size(data), size)
            start, row = 33, b""
            while start < len(data):
                length, kind = struct.unpack(">I4s", data[start:start + 8])
                row += data[start + 8:start + 8 + length] if kind == b"IDAT" else b""
                start += 12 + length
            self.assertIn(b"\xff\xff\xff", zlib.decompress(row)[:30], "a white corner")

    def test_one_mesh(self):
        self.put("t.off", off(*TETRAHEDRON))
        self.succeed("picture", "t.off", "--level", "0", "-o", "t.png", "-q")
        self.refuse("no level 1", "picture", "t.off", "--level", "1", "-o", "t1.png")

    def test_invalid_arguments(self):
        for pattern, options in [("levels 0 to 2", ["--level", "3"]), ("--size", ["--size", "100"]),
                                 ("16 to 8192", ["--size", "8,100"]),
                                 ("--up: expected .* not all 0", ["--up", "0,0,0"]),
                                 ("must not be zero or parallel",
                                  ["--view", "0,0,2", "--up", "0,0,1"]),
                                 ("--view: expected .* not all 0", ["--view", "0,0,0"]),
                                 ("front, back", ["--view", "above"]),
                                 ("--zoom: expected a number above 0, got '0'", ["--zoom", "0"]),
                                 ("--style", ["--style", "wire"]), ("--level", ["--level", "-1"])]:
            self.refuse(pattern, "picture", "s.glb", "-o", "q.png", *options)
        self.refuse("replace the mesh", "picture", "s.glb", "-o", "s.glb")
        self.refuse("nowhere", "picture", "s.glb", "-o", "nowhere/q.png")
        self.refuse("missing.glb", "picture", "missing.glb", "-o", "q.png")
        for command, output in (("picture", "q.png"), ("report", "q.html")):
            self.refuse(
                "expected one of .ply .stl .obj .off .vtp .3mf .gii, or .glb or .vtm.*isoatlas "
                "extract meshes it", command, "sphere.nrrd", "-o", output)
        for name in ("q.tif", "q.bmp", "q", "q.png.txt"):
            self.refuse(f"{name}: .*expected a name ending in .png, .jpg or .jpeg", "picture",
                        "s.glb", "-o", name)

    def test_without_a_display_or_xvfb_one_line_reports_it(self):
        self.refuse("X display", "picture", "s.glb", "-o", "q.png",
                    env={"DISPLAY": "", "PATH": "/nonexistent"})


class PictureLibrary(ToolTest):
    """The tool starts without VTK, X11 and OpenGL; a library next to it draws pictures."""

    def setUp(self):
        super().setUp()
        self.put("t.off", off(*TETRAHEDRON))
        (self.folder / "bin").mkdir()
        self.tool = self.folder / "bin" / "isoatlas"
        shutil.copy2(TOOL, self.tool)

    def run_copy(self, *arguments):
        return subprocess.run([self.tool, *arguments], cwd=self.folder, capture_output=True,
                              text=True)

    def refuse_picture(self, pattern):
        done = self.run_copy("picture", "t.off", "-o", "t.png")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, rf"\Aisoatlas: error: [^\n]*{pattern}[^\n]*\n\Z")
        self.assertFalse((self.folder / "t.png").exists())
        return done.stderr

    def test_other_commands_work_without_it(self):
        done = self.run_copy("check", "t.off")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("manifold      yes", done.stdout)

    def test_the_tool_needs_no_library_of_a_window_system(self):
        libraries = subprocess.run(["ldd", self.tool], capture_output=True, text=True).stdout
        self.assertIn("libc.so", libraries)
        for name in ("libvtk", "libX11", "libGL", "libOpenGL"):
            self.assertNotIn(name, libraries)

    def test_one_line_names_what_is_missing(self):
        line = self.refuse_picture(
            "this library draws pictures, and it is missing: install isoatlas as a whole")
        library = pathlib.Path(re.search(r"error: (/.*?/isoatlas_picture.so)", line)[1])
        library.parent.mkdir(parents=True)
        library.write_bytes(b"not a library")
        self.refuse_picture(r"OpenGL and X11.*isoatlas_picture.so: .*Debian: libopengl0")


def page_parts(path):
    """The data, the bytes of the geometry and the whole text of a page."""
    text = path.read_text(encoding="utf-8")
    part = lambda id: re.search(rf'(?s)<script type="[a-z/]+" id="isoatlas-{id}">(.*?)</script>',
                                text).group(1)
    return json.loads(part("data")), base64.b64decode(part("geometry"), validate=True), text


HAS_PAGES = "without pages" not in subprocess.run(
    [str(TOOL), "report", "missing.json", "-o", "/nonexistent/p.html"], capture_output=True,
    text=True).stderr


@unittest.skipUnless(HAS_PAGES, "built without pages (ISOATLAS_BUILD_PAGE)")
class Page(ToolTest):
    EXTRACT = [
        "extract", "sphere.nrrd", "--iso", "0", "--refine", "max-distance:1vx", "--refine",
        "max-distance:0.3vx", "-q"
    ]

    def setUp(self):
        super().setUp()
        self.put_sphere()

    def test_of_extract_has_everything(self):
        self.succeed(*self.EXTRACT, "-o", "s.glb", "--html", "s.html", "--report", "s.json")
        page, geometry, text = page_parts(self.folder / "s.html")
        self.assertTrue(text.startswith("<!doctype html>"))
        self.assertEqual(page["schema"], "isoatlas-page-2")
        result, = page["results"]
        report = json.loads((self.folder / "s.json").read_text())
        outputs = ["-o", "s.glb", "--html", "s.html", "--report", "s.json"]
        self.assertEqual(result["command"], " ".join(["isoatlas", *self.EXTRACT, *outputs]))
        for key in ["parameters", "input", "surface", "reference"]:
            self.assertEqual(result[key], report[key])
        self.assertEqual([l["triangles"] for l in result["levels"]],
                         [l["triangles"] for l in report["levels"]])
        self.assertEqual(sum(result["marching_cubes"]["histogram"]),
                         result["marching_cubes"]["triangles"])
        levels = result["geometry"]["levels"]
        self.assertEqual([l["triangles"]["count"] for l in levels],
                         [l["triangles"] for l in report["levels"]])
        self.assertEqual(
            max(r["offset"] + r["bytes"] for l in levels for r in (l["triangles"], l["distance"])),
            len(geometry))
        for level, stated in zip(levels, report["levels"]):
            self.assertAlmostEqual(
                level["distance"]["maximum"],
                stated["metrics"]["max-distance"]["maximum"] - stated["rounding"], places=6)

    def test_loads_nothing(self):
        self.succeed(*self.EXTRACT, "-o", "s.glb", "--html", "s.html")
        text = (self.folder / "s.html").read_text(encoding="utf-8")
        for pattern in [
                r"<link\b", r"<img\b", r"<script[^>]*\bsrc=", r"<iframe\b", r"@import",
                r"url\((?!['\"]?(?:data:|#))", r"\bimport\s*\("
        ]:
            self.assertIsNone(re.search(pattern, text), pattern)

    def test_same_bytes_again_and_with_any_number_of_threads(self):
        pages = []
        for threads in ["1", "2", "2"]:
            self.succeed(*self.EXTRACT, "-o", "s.glb", "--html", "s.html", "--threads", threads)
            pages.append(
                re.sub(r"--threads \d|\"threads\":\d", "",
                       (self.folder / "s.html").read_text(encoding="utf-8")))
        self.assertEqual(len(set(pages)), 1)

    def test_of_a_report_is_that_of_extract(self):
        self.succeed(*self.EXTRACT, "-o", "s.vtm", "--html", "a.html", "--report", "s.json")
        self.succeed("report", "s.json", "-o", "b.html", "-q")
        self.assertEqual((self.folder / "a.html").read_bytes(),
                         (self.folder / "b.html").read_bytes())
        (self.folder / "sphere.nrrd").unlink()
        self.succeed("report", "s.json", "-o", "c.html", "-q")
        self.assertIsNone(page_parts(self.folder / "c.html")[0]["results"][0]["marching_cubes"])

    def test_of_several_results(self):
        self.succeed(*self.EXTRACT, "-o", "s.glb", "--report", "s.json")
        self.put("t.off", off(*TETRAHEDRON))
        self.assertRegex(self.succeed("report", "s.json", "s.glb", "t.off", "-o", "p.html"),
                         r"\A  wrote +p.html: 3 results, [\d.]+ [KM]iB\n\Z")
        page, _, text = page_parts(self.folder / "p.html")
        self.assertEqual([r["title"] for r in page["results"]],
                         ["sphere.nrrd at 0", "s.glb", "t.off"])
        self.assertIn("<title>sphere.nrrd at 0, s.glb, t.off - isoatlas</title>", text)
        self.assertEqual([len(r["levels"]) for r in page["results"]], [3, 3, 1])
        self.assertEqual(page["results"][2]["levels"][0]["genus"], 0)

    def test_folders_are_left_out(self):
        (self.folder / "Jane Doe").mkdir()
        (self.folder / "sphere.nrrd").rename(self.folder / "Jane Doe" / "s.nrrd")
        folder = self.folder / "Jane Doe"
        self.succeed("extract", str(folder / "s.nrrd"), *self.EXTRACT[2:], "-o",
                     str(folder / "s.glb"), "--report", "s.json", "--html", str(folder / "a.html"))
        self.succeed("report", "s.json", "-o", "b.html")
        for page in (folder / "a.html", self.folder / "b.html"):
            result, = page_parts(page)[0]["results"]
            self.assertEqual(result["input"]["path"], "s.nrrd")
            self.assertEqual(
                result["command"],
                " ".join(["isoatlas", "extract", "s.nrrd", *self.EXTRACT[2:], "-o", "s.glb",
                          "--report", "s.json", "--html", "a.html"]))
            self.assertIsNotNone(result["marching_cubes"])
            text = page.read_text(encoding="utf-8")
            self.assertNotIn("Jane Doe", text)
            self.assertNotIn(str(self.folder), text)
        self.assertIn("Jane Doe", (self.folder / "s.json").read_text())

    def test_names_are_escaped_in_html(self):
        name = "</script><b>&amp; 'x'.nrrd".replace("/", "")
        (self.folder / "sphere.nrrd").rename(self.folder / name)
        self.succeed("extract", name, "--iso", "0", "--coarse", "-o", "s.ply", "-q", "--html",
                     "s.html")
        page, _, text = page_parts(self.folder / "s.html")
        self.assertEqual(page["results"][0]["input"]["path"], name)
        self.assertEqual(text.count("<b>"), (self.folder / "s.html").read_text().count("<b>"))
        self.assertIn("<title>&lt;script>&lt;b>&amp;amp; 'x'.nrrd at 0 - isoatlas</title>", text)
        self.assertEqual(shlex.split(page["results"][0]["command"])[2], name)

    def test_names_that_are_not_utf8(self):
        name = os.fsdecode(b"m\xff.off")
        (self.folder / name).write_bytes(off(*TETRAHEDRON))
        self.succeed("report", name, "-o", "p.html", "-q")
        self.assertEqual(
            page_parts(self.folder / "p.html")[0]["results"][0]["title"], "m\ufffd.off")

    def test_a_mesh_that_is_not_a_manifold(self):
        self.put(
            "m.off",
            off([(0, 0, 0), (4, 0, 0), (0, 4, 0), (0, 0, 4), (0, 0, -4)], [(0, 1, 2), (0, 1, 3),
                                                                           (0, 1, 4)]))
        self.succeed("report", "m.off", "-o", "p.html", "-q")
        level = page_parts(self.folder / "p.html")[0]["results"][0]["levels"][0]
        self.assertEqual((level["manifold"], level["genus"], level["components"]), (False, None, 1))

    def test_invalid_arguments(self):
        self.succeed(*self.EXTRACT, "-o", "s.glb", "--report", "s.json")
        self.put("bad.json", b"{}")
        self.refuse("is not a report", "report", "bad.json", "-o", "p.html")
        self.refuse("missing.glb", "report", "missing.glb", "-o", "p.html")
        self.refuse("would replace a result", "report", "s.glb", "-o", "s.glb")
        (self.folder / "mesh.html").symlink_to("s.glb")
        (self.folder / "volume.html").symlink_to("sphere.nrrd")
        self.refuse("would replace .*s.glb", "report", "s.json", "-o", "mesh.html")
        self.refuse("would replace .*sphere.nrrd", "report", "s.json", "-o", "volume.html")
        for name in ("p", "p.htm.txt", "p.pdf", "s.glb"):
            self.refuse(f"{name}: .*expected a name ending in .html", "report", "s.json", "-o",
                        name)
            if name != "s.glb":
                self.refuse(f"{name}: .*expected a name ending in .html", *self.EXTRACT, "-o",
                            "s.glb", "--html", name)
        self.refuse("p.html: a report is JSON.*--html writes a page", *self.EXTRACT, "-o", "s.glb",
                    "--report", "p.html")
        self.succeed("report", "s.json", "-o", "P.HTM", "-q")
        self.refuse("nowhere", "report", "s.glb", "-o", "nowhere/p.html")
        self.put("empty.off", off([(0, 0, 0), (1, 0, 0), (0, 1, 0)], []))
        self.refuse("no triangles", "report", "empty.off", "-o", "p.html")
        self.refuse("the page would replace the mesh", *self.EXTRACT, "-o", "s.glb", "--html",
                    "s.glb")
        self.refuse("the page would replace the report", *self.EXTRACT, "-o", "s.glb", "--report",
                    "x", "--html", "x")
        self.refuse("the page would replace the volume", *self.EXTRACT, "-o", "s.glb", "--html",
                    "sphere.nrrd")
        other = json.loads((self.folder / "s.json").read_text())
        other["levels"][0]["vertices"] += 1
        self.put("other.json", json.dumps(other).encode())
        self.refuse("about another mesh", "report", "other.json", "-o", "p.html")
        # The file was replaced since.
        for more in (["--coarse"], self.EXTRACT[4:-1] + ["--refine", "max-distance:0.2vx"]):
            self.succeed(*self.EXTRACT[:4], *more, "-q", "-o", "s.glb")
            self.refuse("about another mesh", "report", "s.json", "-o", "p.html")

    def test_snippets_of_the_page_about_it(self):
        (self.folder / "samples").symlink_to(DOCS.parents[1] / "samples")
        (self.folder / "isoatlas").symlink_to(TOOL)
        text = (DOCS.parent / "report.md").read_text(encoding="utf-8")
        blocks = re.findall(r"(?ms)^```sh\n(.*?)^```", text)
        self.assertGreaterEqual(len(blocks), 4)
        for block in blocks:
            done = subprocess.run(["bash", "-euc", block], cwd=self.folder,
                                  env={**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}"},
                                  capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), block)
        for page in re.findall(r"(?<=-o |ml )\w+\.html", "".join(blocks)):
            self.assertGreater(len(page_parts(self.folder / page)[1]), 1000, page)


class Terminal(ToolTest):

    def on_terminal(self, *arguments, term="xterm"):
        """The output of the tool on a stderr that is a terminal."""
        ours, theirs = pty.openpty()
        process = subprocess.Popen([str(TOOL), *arguments], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=theirs,
                                   env={**os.environ, "TERM": term, "LC_ALL": "C.UTF-8"})
        os.close(theirs)
        written = b""
        while select.select([ours], [], [], 20)[0]:
            try:
                chunk = os.read(ours, 4096)
            except OSError:  # Linux: the other end is closed
                break
            if not chunk:
                break
            written += chunk
        os.close(ours)
        self.assertEqual(process.wait(timeout=20), 0)
        return written.decode()

    def test_progress_is_drawn_and_erased(self):
        self.put_sphere()
        arguments = ["extract", "sphere.nrrd", "--iso", "0", "-o", "s.ply"]
        drawn = self.on_terminal(*arguments)
        self.assertIn("\rread", drawn)
        self.assertRegex(drawn, r"\rsurface +[ ▏▎▍▌▋▊▉█]+ +\d+ %")
        self.assertTrue(drawn.endswith("\r\x1b[K"))
        self.assertNotIn("\n", drawn)
        self.assertEqual(self.on_terminal(*arguments, "-q"), "")
        self.assertEqual(self.on_terminal(*arguments, term="dumb"), "")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
