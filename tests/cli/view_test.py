#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs `isoatlas view` and talks to it as its page does: view_test.py TOOL. Needs only the
standard library; tests/page tests the page itself."""

import array
import http.client
import json
import math
import os
import pathlib
import re
import shlex
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

TOOL = pathlib.Path(sys.argv[1]).resolve()


def write_nrrd(path, size, sample):
    """Writes float samples sample(x, y, z)."""
    nx, ny, nz = size
    samples = array.array(
        "f", (sample(x, y, z) for z in range(nz) for y in range(ny) for x in range(nx)))
    header = (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {nx} {ny} {nz}\nspacings: 1 1 2\n"
              "units: \"mm\" \"mm\" \"mm\"\nencoding: raw\nendian: little\n\n")
    path.write_bytes(header.encode() + samples.tobytes())


def two_balls(x, y, z):
    return max(9 - math.dist((x, y, z), (12.2, 15.1, 14.9)),
               4 - math.dist((x, y, z), (28.3, 15.2, 15.1)))


class Events:
    """The messages of GET events, in the order in which they arrive."""

    def __init__(self, view, last=None):
        """last: the id of the last message before the connection broke."""
        self.connection = http.client.HTTPConnection("127.0.0.1", view.port, timeout=60)
        headers = {"Host": view.host, **({} if last is None else {"Last-Event-ID": last})}
        self.connection.request("GET", view.base + "events", headers=headers)
        self.last = last
        self.response = self.connection.getresponse()
        assert self.response.status == 200, self.response.read()

    def next(self, request, *types):
        """The next message about a request that has one of the types."""
        while True:
            line = self.response.readline().decode()
            assert line, "the stream of events has ended"
            if line.startswith("id: "):
                self.last = line[4:].strip()
            if not line.startswith("data: "):
                continue
            message = json.loads(line[6:])
            if message.get("request") == request and message["type"] in types:
                return message

    def close(self):
        self.response.close()
        self.connection.close()


class View:
    """A running tool."""

    def __init__(self, folder, *arguments):
        self.process = subprocess.Popen(
            [str(TOOL), "view", *map(str, arguments), "--no-browser"], cwd=folder,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
            env={**os.environ, "TMPDIR": str(folder)})
        address = self.process.stdout.readline().strip()
        match = re.fullmatch(r"http://(127\.0\.0\.1:(\d+))(/[0-9a-f]{32}/)", address)
        assert match, (address, self.process.stderr.read())
        self.host, self.base = match[1], match[3]
        self.port = int(match[2])

    def request(self, method, path, body=None, headers=None, base=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        given = {"Host": self.host, **(headers or {})}
        if body is not None and "Content-Type" not in given:
            given["Content-Type"] = "application/json"
        text = json.dumps(body) if isinstance(body, (dict, list)) else body
        connection.putrequest(method, (self.base if base is None else base) + path, skip_host=True)
        for name, value in given.items():
            if value is not None:
                connection.putheader(name, value)
        connection.putheader("Content-Length", str(len(text or "")))
        connection.endheaders((text or "").encode())
        response = connection.getresponse()
        result = response.status, response.read(), response.headers
        connection.close()
        return result

    def get(self, path):
        status, content, _ = self.request("GET", path)
        assert status == 200, (path, status, content)
        return content

    def post(self, path, body):
        status, content, _ = self.request("POST", path, body)
        return status, json.loads(content)

    def mesh(self, identifier):
        content = self.get(f"meshes/{identifier}")
        length, = struct.unpack_from("<I", content)
        facts = json.loads(content[4:4 + length])
        at = 4 + length
        positions = struct.unpack_from(f"<{3 * facts['vertices']}f", content, at)
        at += 12 * facts["vertices"]
        triangles = struct.unpack_from(f"<{3 * facts['triangles']}I", content, at)
        assert len(content) == at + 12 * facts["triangles"]
        return facts, positions, triangles

    def end(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.communicate()


class ViewTest(unittest.TestCase):

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="isoatlas-view-test-")
        cls.folder = pathlib.Path(cls.temporary.name)
        write_nrrd(cls.folder / "two balls.nrrd", (36, 30, 30), two_balls)
        cls.view = View(cls.folder, "two balls.nrrd")
        cls.events = Events(cls.view)

    @classmethod
    def tearDownClass(cls):
        cls.events.close()
        cls.view.end()
        cls.temporary.cleanup()

    def coarse(self, request, *options):
        self.assertEqual(self.view.post("mesh", {"request": request, "options": options}),
                         (200, {}))
        while True:
            message = self.events.next(request, "mesh", "failed")
            if message["type"] == "failed" or message["final"]:
                return message

    def test_page_and_volume(self):
        status, page, headers = self.view.request("GET", "")
        self.assertEqual(status, 200)
        self.assertIn(b"<!doctype html>", page)
        self.assertNotIn(b"http://", page.replace(b"http://www.w3.org", b""))
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertEqual(headers["Cache-Control"], "no-store")
        self.assertEqual(headers["Referrer-Policy"], "no-referrer")
        volume = json.loads(self.view.get("volume"))
        self.assertEqual(volume["schema"], "isoatlas-view-1")
        self.assertEqual(volume["size"], [36, 30, 30])
        self.assertEqual(volume["path"], "two balls.nrrd")
        self.assertEqual(volume["unit"], "mm")
        self.assertEqual(volume["index_to_world"], [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 2, 0]])
        self.assertEqual(sum(volume["histogram"]["counts"]), 36 * 30 * 30)
        self.assertLessEqual(len(volume["histogram"]["counts"]), 512)

    def test_slices(self):
        samples = array.array("f", self.view.get("slices/2/15"))
        self.assertEqual(len(samples), 36 * 30)
        self.assertAlmostEqual(samples[12 + 36 * 15], two_balls(12, 15, 15), places=5)
        across_x = array.array("f", self.view.get("slices/0/12"))
        self.assertAlmostEqual(across_x[7 + 30 * 20], two_balls(12, 7, 20), places=5)
        for path in ("slices/3/0", "slices/2/30", "slices/0/999999999", "slices/0/-1",
                     "slices/0/../../etc/passwd", "slices/0/0x1"):
            status, content, _ = self.view.request("GET", path)
            self.assertIn(status, (400, 404), path)
            self.assertIn("error", json.loads(content))

    def test_meshes(self):
        message = self.coarse(11, ["iso", "0.5"])
        facts, positions, triangles = self.view.mesh(message["id"])
        self.assertEqual((message["reduction"], facts["reduction"]), (1, 1))
        self.assertEqual(facts["facts"]["components"], 2)
        self.assertTrue(facts["facts"]["certificate"]["passed"])
        self.assertEqual(facts["facts"]["euler_characteristic"], 4)
        self.assertEqual(facts["isovalue"], 0.5)
        self.assertLess(max(triangles), len(positions) // 3)
        # Around the large ball: 12.2 +- 8.5 in x, 2 * (14.9 +- 8.5) in z.
        low = [facts["centre"][a] - facts["half"][a] for a in range(3)]
        high = [facts["centre"][a] + facts["half"][a] for a in range(3)]
        self.assertAlmostEqual(low[0], 12.2 - 8.5, delta=1)
        self.assertAlmostEqual(high[2], 2 * (14.9 + 8.5), delta=1.5)
        self.assertLessEqual(max(abs(p) for p in positions), max(facts["half"]) + 1e-3)

        one = self.coarse(12, ["iso", "0.5"], ["keep-components", "1"])
        facts, _, _ = self.view.mesh(one["id"])
        self.assertEqual((facts["kept"], facts["dropped"]), (1, 1))
        self.assertEqual(len(facts["dropped_components"]), 1)
        near = facts["dropped_components"][0]["position"]
        other = self.coarse(13, ["iso", "0.5"], ["keep-near", ",".join(map(str, near))])
        facts, _, _ = self.view.mesh(other["id"])
        self.assertGreater(facts["centre"][0], 25)
        region = self.coarse(14, ["iso", "0.5"], ["roi", "23:35,:,:"])
        self.assertEqual(self.view.mesh(region["id"])[0]["facts"]["components"], 1)

    def test_bad_options(self):
        for options, expected in (
            ([], "--iso"),
            ([["iso", "high"]], "--iso: expected"),
            ([["iso", "nan"]], "--iso: expected"),
            ([["iso", "0"], ["max-distance", "-1"]], "--max-distance"),
            ([["iso", "0"], ["iso", "1"]], "twice"),
            ([["iso", "0"], ["roi", "9:3,:,:"]], "roi"),
            ([["iso", "0"], ["output", "x.ply"]], "not an option that a page can set"),
            ([["iso", "0"], ["report", "x.json"]], "not an option that a page can set"),
            ([["iso", "0"], ["html", "/etc/x.html"]], "not an option that a page can set"),
        ):
            for path in ("mesh", "command", "save"):
                status, answer = self.view.post(
                    path, {"request": 20, "format": "ply", "options": options})
                self.assertEqual(status, 400, (path, options, answer))
                self.assertIn(expected, answer["error"])
                self.assertNotIn("\n", answer["error"])
        failed = self.coarse(21, ["iso", "1e9"])
        self.assertEqual(failed["type"], "failed")
        self.assertIn("no surface at isovalue", failed["message"])

    def test_bad_bodies(self):
        for body in (b"", b"{", b"[]", b"null", b'{"request":"1","options":[]}',
                     b'{"request":1,"options":{}}', b'{"request":1,"options":[["iso"]]}',
                     b'{"request":1,"options":[["iso",1]]}', b"[" * 100000):
            status, content, _ = self.view.request("POST", "mesh", body.decode())
            self.assertEqual(status, 400, body[:50])
            self.assertIn("error", json.loads(content))
        form = {"Content-Type": "application/x-www-form-urlencoded"}
        status, _, _ = self.view.request("POST", "mesh", '{"request":1,"options":[]}', form)
        self.assertEqual(status, 400)
        status, content, _ = self.view.request("POST", "mesh", " " * (2 << 20))
        self.assertEqual((status, json.loads(content)["error"]),
                         (413, "the body of the request: expected at most 1 MiB"))

    def test_compressed_bodies_are_refused(self):
        """Small ones could need gigabytes."""
        status, _, _ = self.view.request("POST", "mesh", "{}", {"Content-Encoding": "gzip",
                                                                "Content-Type": "application/json"})
        self.assertEqual(status, 415)

    def test_saved_without_all_bounds(self):
        options = [["iso", "0.5"], ["max-distance", "0.01vx"], ["max-vertices", "20"]]
        self.view.post("save", {"request": 45, "options": options, "format": "ply"})
        saved = self.events.next(45, "saved", "failed")
        self.assertIs(saved["satisfied"], False)
        self.assertIn("violated", saved["summary"])
        self.assertNotIn(str(self.folder), saved["summary"], "a path that the user cannot use")
        self.view.post("save", {"request": 46, "options": [["iso", "0.5"], ["coarse", ""]],
                                "format": "ply"})
        self.assertIs(self.events.next(46, "saved")["satisfied"], True)

    def test_messages_while_the_connection_is_broken(self):
        first = Events(self.view)
        self.coarse(47, ["iso", "0.5"])
        first.next(47, "mesh")
        first.close()
        self.coarse(48, ["iso", "0.25"])
        again = Events(self.view, first.last)
        self.addCleanup(again.close)
        again.next(48, "mesh")

    def test_few_pages(self):
        """Browsers open six connections to a server; others are needed for meshes and slices."""
        pages = [Events(self.view) for _ in range(3)]
        status, content, _ = self.view.request("GET", "events")
        for page in pages:
            page.close()
        self.assertEqual(status, 503)
        self.assertIn("too many pages", json.loads(content)["error"])

    def test_only_the_page_is_answered(self):
        for headers, base in (
            ({"Host": "evil.example"}, None),
            ({"Host": f"evil.example:{self.view.port}"}, None),
            ({"Host": None}, None),
            ({"Origin": "http://evil.example"}, None),
            ({"Origin": "null"}, None),
            ({"Sec-Fetch-Site": "cross-site"}, None),
            ({}, "/"),
            ({}, "/" + "0" * 32 + "/"),
            ({}, "/" + self.view.base[1:-1].upper() + "x/"),
        ):
            for method, path in (("GET", "volume"), ("GET", ""), ("POST", "mesh"),
                                 ("GET", "events")):
                body = "{}" if method == "POST" else None
                status, content, _ = self.view.request(method, path, body, headers, base)
                self.assertIn(status, (400, 403), (headers, base, path))
                self.assertNotIn(b"two balls", content)
        own = {"Origin": f"http://{self.view.host}"}
        self.assertEqual(self.view.request("GET", "volume", None, own)[0], 200)
        for path in ("../../../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "files/0/../../x",
                     "files/99", "files//etc/passwd", "two balls.nrrd".replace(" ", "%20")):
            self.assertIn(self.view.request("GET", path)[0], (403, 404), path)
        for method in ("PUT", "DELETE", "PATCH", "OPTIONS"):
            self.assertGreaterEqual(self.view.request(method, "volume")[0], 400)

    def test_saves_what_the_command_writes(self):
        for number, (format_, options) in enumerate((
            ("ply", [["iso", "0.5"], ["max-distance", "0.3vx"]]),
            ("glb", [["iso", "0.5"], ["levels", "2"], ["keep-components", "1"]]),
            ("stl", [["iso", "-1.25"], ["coarse", ""], ["border", "closed"]]),
        )):
            body = {"request": 30 + number, "options": options, "format": format_}
            self.assertEqual(self.view.post("save", body), (200, {}))
            saved = self.events.next(30 + number, "saved", "failed")
            self.assertEqual((saved["type"], saved["name"]), ("saved", f"two balls.{format_}"))
            self.assertIn("triangles", saved["summary"])
            status, content, headers = self.view.request("GET", f"files/{saved['id']}")
            self.assertEqual((status, len(content)), (200, saved["bytes"]))
            self.assertEqual(headers["Content-Disposition"],
                             f'attachment; filename="two balls.{format_}"')
            status, answer = self.view.post("command", body)
            self.assertEqual(status, 200)
            words = shlex.split(answer["command"])
            self.assertEqual((words[0], words[-2:]), ("isoatlas", ["-o", f"two balls.{format_}"]))
            subprocess.run([str(TOOL), *words[1:]], cwd=self.folder, check=True,
                           stdout=subprocess.DEVNULL)
            written = self.folder / f"two balls.{format_}"
            self.assertEqual(written.read_bytes(), content)
            written.unlink()

    def test_save_refuses(self):
        self.assertEqual(
            self.view.post("save", {"request": 40, "options": [["iso", "0"]], "format": "exe"})[0],
            400)
        self.view.post("save", {"request": 41, "options": [["iso", "1e9"]], "format": "ply"})
        failed = self.events.next(41, "saved", "failed")
        self.assertEqual(failed["type"], "failed")
        self.assertIn("no surface at isovalue", failed["message"])
        self.assertNotIn("isoatlas: error", failed["message"])


class LongWork(unittest.TestCase):
    """Cancelling, and the end of the tool, while meshes take long."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="isoatlas-view-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        n = 128
        (self.folder / "noise.raw").write_bytes(os.urandom(n ** 3))
        self.view = View(self.folder, "noise.raw", "--raw-size", f"{n},{n},{n}", "--raw-type",
                         "uint8")
        self.addCleanup(self.view.end)
        self.events = Events(self.view)
        self.addCleanup(self.events.close)

    def start_mesh(self, request, iso="127.5"):
        body = {"request": request, "options": [["iso", iso]], "format": "ply"}
        self.assertEqual(self.view.post("mesh", body), (200, {}))
        return body

    def test_a_preview_comes_first_and_later_requests_replace_earlier_ones(self):
        self.start_mesh(1)
        preview = self.events.next(1, "mesh")
        self.assertGreater(preview["reduction"], 1)
        self.assertFalse(preview["final"])
        facts, _, _ = self.view.mesh(preview["id"])
        self.assertTrue(facts["facts"]["certificate"]["passed"])
        self.events.next(1, "progress")
        self.start_mesh(2, "300")  # above all samples
        # Another page may have requested it.
        self.events.next(1, "cancelled")
        self.assertIn("no surface at isovalue", self.events.next(2, "failed")["message"])

    def test_cancel(self):
        body = self.start_mesh(1)
        self.events.next(1, "progress")
        self.view.post("cancel", {"request": 1})
        self.events.next(1, "cancelled")
        self.view.post("save", {**body, "request": 2})
        self.events.next(2, "progress")
        status, answer = self.view.post("save", {**body, "request": 3})
        self.assertEqual(status, 400)
        self.assertIn("another mesh is being saved", answer["error"])
        self.view.post("cancel", {"request": 2})
        self.events.next(2, "cancelled")
        self.view.post("cancel", {"request": 2})  # no effect

    def end(self, act):
        body = self.start_mesh(1)
        self.view.post("save", {**body, "request": 2})
        self.events.next(2, "progress")
        act()
        self.assertEqual(self.view.process.wait(timeout=20), 0)
        time.sleep(0.2)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["noise.raw"])
        processes = subprocess.run(["ps", "-eo", "args"], stdout=subprocess.PIPE, encoding="utf-8",
                                   check=True).stdout
        self.assertNotIn(str(self.folder), processes)

    def test_ends_when_the_page_is_closed(self):
        other = tempfile.TemporaryDirectory(prefix="isoatlas-view-test-")
        self.addCleanup(other.cleanup)
        write_nrrd(pathlib.Path(other.name) / "v.nrrd", (8, 8, 8), two_balls)
        without_page = View(other.name, "v.nrrd")
        self.addCleanup(without_page.end)
        without_page.request("HEAD", "events")
        self.end(self.events.close)
        self.assertIsNone(without_page.process.poll(), "HEAD is not a page that was closed")

    def test_ends_while_a_connection_stays_open(self):
        """Any program of this computer can open one, and send a byte now and then."""
        slow = socket.create_connection(("127.0.0.1", self.view.port))
        self.addCleanup(slow.close)
        slow.sendall(b"GET / HTTP/1.1\r\nX: ")
        stops = threading.Event()

        def send():
            while not stops.wait(0.2):
                try:
                    slow.sendall(b"a")
                except OSError:
                    return

        thread = threading.Thread(target=send)
        thread.start()
        self.addCleanup(thread.join)
        self.addCleanup(stops.set)
        self.end(lambda: self.view.process.send_signal(signal.SIGINT))

    def test_ends_with_ctrl_c(self):
        idle = http.client.HTTPConnection("127.0.0.1", self.view.port)
        idle.request("GET", self.view.base + "volume", headers={"Connection": "keep-alive"})
        idle.getresponse().read()
        self.addCleanup(idle.close)
        self.end(lambda: self.view.process.send_signal(signal.SIGINT))
        self.assertEqual(self.view.process.stderr.read().count("\n"), 1, "what is printed at first")


class Start(unittest.TestCase):

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="isoatlas-view-test-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def test_region_of_the_command_line(self):
        write_nrrd(self.folder / "v.nrrd", (36, 30, 30), two_balls)
        view = View(self.folder, "v.nrrd", "--roi", "20:35,2:,:", "--iso", "0.5", "--inside",
                    "below")
        self.addCleanup(view.end)
        volume = json.loads(view.get("volume"))
        self.assertEqual((volume["size"], volume["isovalue"], volume["inside"]),
                         ([16, 28, 30], 0.5, "below"))
        body = {"options": [["iso", "0.5"], ["roi", "1:9,0:,3:4"]], "format": "ply"}
        self.assertEqual(
            view.post("command", body)[1]["command"],
            "isoatlas extract v.nrrd --iso 0.5 --roi 21:29,2:,3:4 -o v.ply")

    def test_first_isovalue_of_distances(self):
        # As many samples at each distance of the band: a threshold of the histogram is lower.
        write_nrrd(self.folder / "v.nrrd", (40, 20, 20),
                   lambda x, y, z: min(max(12 - x / 1.5 + 0.01 * y, -8), 8))
        view = View(self.folder, "v.nrrd")
        self.addCleanup(view.end)
        volume = json.loads(view.get("volume"))
        self.assertGreater(len(volume["suggested"]), 1)
        self.assertEqual((volume["isovalue"], volume["inside"]), (0, "below"))

    def test_no_folder_for_temporary_files(self):
        write_nrrd(self.folder / "v.nrrd", (8, 8, 8), two_balls)
        result = subprocess.run(
            [str(TOOL), "view", "v.nrrd", "--no-browser"], cwd=self.folder, timeout=20,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
            env={**os.environ, "TMPDIR": "/nonexistent"})
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertRegex(result.stderr, "^isoatlas: error: /nonexistent: no folder for temporary "
                                        r"files .*\n$")

    def test_port_in_use(self):
        write_nrrd(self.folder / "v.nrrd", (8, 8, 8), two_balls)
        view = View(self.folder, "v.nrrd")
        self.addCleanup(view.end)
        result = subprocess.run(
            [str(TOOL), "view", "v.nrrd", "--no-browser", "--port", str(view.port)],
            cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
            timeout=20)
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertRegex(result.stderr, r"isoatlas: error: --port: \d+ is in use")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
