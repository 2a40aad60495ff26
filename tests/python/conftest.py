# SPDX-License-Identifier: Apache-2.0
import os
import pathlib
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
DATA = pathlib.Path(os.environ.get("ISOATLAS_TEST_DATA") or ROOT.parent / "shared" / "data")


@pytest.fixture(scope="session")
def tool():
    """A function that runs the command line tool and expects an exit status (None: any)."""
    path = os.environ.get("ISOATLAS_TOOL")
    if not path:
        pytest.skip("set ISOATLAS_TOOL to the path of the command line tool")

    def run(*arguments, status=0):
        done = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True)
        assert status is None or done.returncode == status, done.stderr
        return done

    return run


@pytest.fixture(scope="session")
def data():
    """The folder of the real volumes."""
    table = DATA / "TOPOLOGY.tsv"
    if not table.is_file():
        pytest.skip(f"no {table}; set ISOATLAS_TEST_DATA to the folder of volumes that has it")
    return DATA


def torus(shape=(26, 22, 14), dtype=np.float32):
    """Samples above 0 inside a torus around the last axis, without any symmetry of the grid."""
    i, j, k = np.indices(shape, dtype=np.float64)
    ring = np.hypot((i - 12.3) / 1.25, j - 10.6) - 6.2
    return (2.9 - np.hypot(ring, k - 6.4)).astype(dtype)


def enclosed_volume(vertices, faces):
    """The enclosed volume; negative if faces are clockwise seen from outside."""
    a, b, c = (vertices[faces[:, corner]].astype(np.float64) for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def topology(report):
    """The topological numbers of the report of a level."""
    return {
        key: report[key]
        for key in ("components", "euler_characteristic", "genus", "boundary_loops", "kinds")
    }
