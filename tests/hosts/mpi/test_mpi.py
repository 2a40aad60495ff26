# SPDX-License-Identifier: Apache-2.0
"""isoatlas-mpi on 1, 2 and 4 ranks: the same bytes as one run of the tool."""

import os
import pathlib
import signal
import subprocess
import time

import pytest

TOOL = os.environ["ISOATLAS_TOOL"]
MPI_TOOL = os.environ["ISOATLAS_MPI_TOOL"]
SAMPLE = pathlib.Path(__file__).resolve().parents[3] / "samples" / "embryo.nrrd"
EXTRACT = [SAMPLE, "--iso", "90.5", "--coarse", "--block-size", "40"]


def mpirun(ranks, *words):
    return ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), MPI_TOOL, *words]


def run(*words, **options):
    return subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=300,
                          **options)


@pytest.fixture(scope="module")
def wanted(tmp_path_factory):
    mesh = tmp_path_factory.mktemp("whole") / "mesh.ply"
    done = run(TOOL, "extract", *EXTRACT, "-o", mesh, "-q")
    assert done.returncode == 0, done.stderr
    return mesh.read_bytes()


@pytest.fixture
def folder(tmp_path):
    done = run(TOOL, "blocks", "plan", *EXTRACT, "-o", "mesh.ply", "--parts", "parts", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    return tmp_path


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_any_number_of_ranks_gives_the_same_bytes(folder, wanted, ranks):
    done = run(*mpirun(ranks, "parts"), cwd=folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("certificate   passed") == 1
    assert (folder / "mesh.ply").read_bytes() == wanted


def test_a_killed_rank_ends_the_run_and_the_next_one_continues(folder, wanted):
    job = subprocess.Popen(mpirun(2, "parts"), cwd=folder, stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE)
    parts = folder / "parts"
    deadline = time.monotonic() + 60
    while len(list(parts.glob("*.mesh"))) < 3 and time.monotonic() < deadline:
        time.sleep(0.001)
    ranks = run("pgrep", "-P", str(job.pid)).stdout.split()
    os.kill(int(ranks[-1]), signal.SIGKILL)
    job.communicate(timeout=60)
    assert job.returncode != 0
    made = len(list(parts.glob("*.mesh")))
    assert made >= 3
    done = run(*mpirun(2, "parts"), cwd=folder)
    assert done.returncode == 0, done.stderr
    assert (folder / "mesh.ply").read_bytes() == wanted


def test_bad_input_is_one_line(folder):
    for words, message in [(["nowhere"], "nowhere: has no plan.json"),
                           (["parts", "--frobnicate"], "'--frobnicate' is not expected")]:
        for ranks in (1, 3):
            done = run(*mpirun(ranks, *words), cwd=folder)
            assert done.returncode == 2
            assert message in done.stderr
            assert done.stderr.count("isoatlas-mpi: error: ") == 1
    assert not (folder / "mesh.ply").exists()
