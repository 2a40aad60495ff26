# SPDX-License-Identifier: Apache-2.0
"""The tool, and samples to compare with what it reads.

These tests do not load the module of the build, which is for another version of NumPy. The tool
prints the digest of the samples that it read.
"""

import hashlib
import json
import os
import subprocess

import numpy as np

TOOL = os.environ["ISOATLAS_TOOL"]
Z, Y, X = np.mgrid[:40, :48, :60]
SAMPLES = (1000 * np.exp(-((Z - 20) ** 2 + (Y - 25) ** 2 + (X - 30) ** 2) / 200)).astype("u2")
ISO = ["--iso", "300"]


def run(*words, status=0):
    done = subprocess.run([TOOL, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout if status == 0 else done.stderr


def info(path, *options):
    return json.loads(run("info", path, "--json", *options))["volume"]


def digest(samples):
    return hashlib.sha256(np.ascontiguousarray(samples).tobytes()).hexdigest()


def expect_samples(path, samples, *options):
    assert info(path, *options)["sha256"] == digest(samples)
