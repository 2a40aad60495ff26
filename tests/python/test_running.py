# SPDX-License-Identifier: Apache-2.0
"""Long computations: other threads keep running, progress is reported, and Ctrl-C ends them."""

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import isoatlas
from conftest import torus

NOISE = np.random.default_rng(1).random((26, 26, 26)).astype(np.float32)
FAST = {"coarse": True, "allow_self_intersections": True}


def test_other_threads_keep_running():
    steps, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            steps[0] += 1
            time.sleep(0.002)

    thread = threading.Thread(target=count)
    thread.start()
    try:
        started, before, seconds = time.monotonic(), steps[0], 0
        while seconds < 1:
            isoatlas.extract(NOISE, 0.5, threads=1, **FAST)
            seconds = time.monotonic() - started
        counted = steps[0] - before
    finally:
        stop.set()
        thread.join()
    assert counted > 20 * seconds  # almost 0 if the interpreter's lock were kept


def test_several_at_once():
    results = {}
    threads = [
        threading.Thread(target=lambda k=k: results.update({k: isoatlas.extract(torus(), 0.1 * k)}))
        for k in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for k in range(4):
        expected = isoatlas.extract(torus(), 0.1 * k)
        assert results[k].vertices.tobytes() == expected.vertices.tobytes()


def test_progress_is_reported_on_the_calling_thread():
    seen = []
    isoatlas.extract(
        NOISE[:16, :16, :16],
        0.5,
        progress=lambda stage, fraction: seen.append((stage, fraction, threading.get_ident())),
        **FAST,
    )
    stages = list(dict.fromkeys(stage for stage, _, _ in seen))
    assert stages == ["surface", "components", "coarsen", "cover", "certify", "mesh", "check"]
    assert all(
        0 <= fraction <= 1 and thread == threading.get_ident() for _, fraction, thread in seen
    )
    fractions = [fraction for _, fraction, _ in seen]
    assert fractions == sorted(fractions)
    assert len(seen) < 2000  # far fewer calls than reports of the library


def test_progress_may_call_extract():
    inner = []

    def progress(stage, fraction):
        if not inner:
            inner.append(isoatlas.extract(torus(), 0.0, coarse=True))

    mesh = isoatlas.extract(NOISE[:16, :16, :16], 0.5, progress=progress, **FAST)
    assert inner[0].levels[0].report["genus"] == 1 and len(mesh.faces) > 500


def test_exception_of_progress_ends_the_work():
    class Enough(Exception):
        pass

    def progress(stage, fraction):
        raise Enough(stage)

    started = time.monotonic()
    with pytest.raises(Enough, match="surface"):
        isoatlas.extract(NOISE, 0.5, progress=progress)
    assert time.monotonic() - started < 1
    assert isoatlas.extract(torus(), 0.0).levels[0].report["genus"] == 1  # no effect on later calls


def test_tqdm(capsys):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    isoatlas.extract(NOISE[:16, :16, :16], 0.5, progress=True, **FAST)
    assert "surface" in capsys.readouterr().err
    isoatlas.check(torus()[0, :, :3] * 0, np.empty((0, 3), int), progress=False)


def test_no_tqdm(monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(ImportError, match="progress=True needs the package tqdm"):
        isoatlas.extract(torus(), 0.0, progress=True)


def interrupted(work, after, tail="", n=160):
    """Run `work` in a new Python process and send it SIGINT after `after` seconds.

    Returns
    -------
    Seconds until KeyboardInterrupt, the output after that, the exit status, and the seconds until
    the process ended.
    """
    code = textwrap.dedent(f"""
        import time
        import numpy as np
        import isoatlas
        noise = np.random.default_rng(1).random(({n}, {n}, {n})).astype(np.float32)
        print("ready", flush=True)
        try:
            {work}
            print("finished", flush=True)
        except KeyboardInterrupt:
            print(time.clock_gettime(time.CLOCK_MONOTONIC), flush=True)
        """) + textwrap.dedent(tail)
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(after)
        sent = time.clock_gettime(time.CLOCK_MONOTONIC)
        process.send_signal(signal.SIGINT)
        answer = process.stdout.readline()
        rest = process.stdout.read()
        status = process.wait(timeout=60)
        ended = time.clock_gettime(time.CLOCK_MONOTONIC)
    assert answer != "finished\n", "too fast to interrupt"
    return float(answer) - sent, rest, status, ended - sent


@pytest.mark.parametrize("after", [0.2, 0.8, 2.5])
def test_ctrl_c_within_a_second(after):
    latency, _, status, until_end = interrupted("isoatlas.extract(noise, 0.5)", after)
    print(f"KeyboardInterrupt after {latency:.3f} s, process ended after {until_end:.3f} s")
    assert latency < 1
    assert status == 0 and until_end < 2  # the process does not wait for abandoned work


def test_ctrl_c_while_files_are_written(tmp_path):
    """After KeyboardInterrupt no file appears, and no temporary file remains."""
    code = textwrap.dedent("""
        import os, threading, signal, time
        import numpy as np
        import isoatlas
        noise = np.random.default_rng(1).random((30, 30, 30)).astype(np.float32)
        mesh = isoatlas.extract(noise, 0.5, coarse=True, allow_self_intersections=True)
        threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT)).start()
        started = time.monotonic()
        try:
            for _ in range(100):
                mesh.save("m.obj")
                os.remove("m.obj")
        except KeyboardInterrupt:
            print(time.monotonic() - started)
        while isoatlas._core.abandoned_work_count():
            time.sleep(0.01)
        """)
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    assert float(run.stdout) < 1.05
    assert [name for name in os.listdir(tmp_path) if name != "m.obj"] == []  # no hidden folders


def test_process_that_ends_while_writing_leaves_no_files(tmp_path):
    code = textwrap.dedent("""
        import os, threading, signal
        import numpy as np
        import isoatlas
        n = 3 * 2**22  # a mesh that is made quickly, but takes long to write as text
        header = f"ply\\nformat binary_little_endian 1.0\\nelement vertex {n}\\n"
        header += "property double x\\nproperty double y\\nproperty double z\\n"
        header += f"element face {n // 3}\\nproperty list uchar int vertex_indices\\nend_header\\n"
        faces = np.empty(n // 3, dtype=[("count", "u1"), ("corners", "<i4", 3)])
        faces["count"], faces["corners"] = 3, np.arange(n).reshape(-1, 3)
        with open("big.ply", "wb") as file:
            file.write(header.encode())
            file.write(np.random.default_rng(1).random((n, 3)).tobytes() + faces.tobytes())
        mesh = isoatlas.read("big.ply")
        before = sorted(os.listdir("."))
        threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
        try:
            mesh.save("m.obj")
        except KeyboardInterrupt:
            visible = sorted(n for n in os.listdir(".") if not n.startswith(".isoatlas"))
            print(isoatlas._core.abandoned_work_count(), before == visible)
        """)
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert run.stdout == "1 True\n", run.stdout + run.stderr  # else no work was abandoned
    assert sorted(os.listdir(tmp_path)) == ["big.ply"]


def test_session_continues_after_ctrl_c():
    """The session stays usable, and memory is released."""
    tail = """
    import resource
    while isoatlas._core.abandoned_work_count():
        time.sleep(0.01)
    peaks = []
    import threading, os, signal
    for _ in range(4):
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        try:
            isoatlas.extract(noise, 0.5)
        except KeyboardInterrupt:
            pass
        while isoatlas._core.abandoned_work_count():
            time.sleep(0.01)
        with open("/proc/self/statm") as file:
            peaks.append(int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE"))
    mesh = isoatlas.extract(noise[:20, :20, :20], 0.5, coarse=True)
    print(max(peaks) - peaks[0] < 0.5 * 2**30, mesh.levels[0].report["level"], peaks)
    """
    latency, rest, status, _ = interrupted("isoatlas.extract(noise, 0.5)", 0.3, tail=tail, n=128)
    assert latency < 1 and status == 0
    assert rest.startswith("True 0"), rest


def test_exception_of_a_signal_handler_ends_the_work():
    class Stop(Exception):
        pass

    def handler(number, frame):
        raise Stop

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(Stop):
            isoatlas.extract(NOISE, 0.5)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_a_handler_that_returns_changes_nothing():
    calls = []
    before = signal.signal(signal.SIGALRM, lambda number, frame: calls.append(number))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)
        mesh = isoatlas.extract(NOISE, 0.5, **FAST)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    assert len(calls) > 2
    assert mesh.vertices.tobytes() == isoatlas.extract(NOISE, 0.5, **FAST).vertices.tobytes()


def test_not_on_the_main_thread():
    results = []
    thread = threading.Thread(
        target=lambda: results.append(isoatlas.extract(torus(), 0.0, progress=lambda *_: None))
    )
    thread.start()
    thread.join()
    assert results[0].levels[0].report["genus"] == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_in_a_process_of_a_pool():
    import multiprocessing

    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(count_faces) == len(isoatlas.extract(torus(), 0.0).faces)


def count_faces():
    return len(isoatlas.extract(torus(), 0.0).faces)
