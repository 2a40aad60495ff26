# SPDX-License-Identifier: Apache-2.0
"""The isosurfaces that bench/compare.py measures, by name.

Volumes that are not files of the development data are generated at their first use and kept.
"""

import csv
import fnmatch
import subprocess
import sys

import numpy

CT_FACTORS = (1, 2, 4)
CT_ISOVALUE = "482"
NOISE_SIZES = (32, 48, 64, 96, 128, 160)


class Surface:
    """An isosurface: its name "volume@isovalue", the isovalue as text, and the volume's path."""

    def __init__(self, stem, isovalue, path, make=None):
        self.name = f"{stem}@{isovalue}"
        self.isovalue = isovalue
        self._path, self._make = path, make

    def path(self):
        """The path of the volume. Generates the file if it does not exist."""
        if self._make and not self._path.exists():
            self._path.parent.mkdir(parents=True, exist_ok=True)
            print(f"making {self._path.name}", flush=True)
            temporary = self._path.with_name("unfinished-" + self._path.name)
            self._make(temporary)
            temporary.replace(self._path)
        return self._path


def write_noise(path, size):
    """Write white noise in [0, 1). The same numpy gives the same bytes."""
    samples = numpy.random.default_rng(size).random((size, size, size)).astype("<f4")
    header = (
        f"NRRD0004\ntype: float\ndimension: 3\nsizes: {size} {size} {size}\nspacings: 1 1 1\n"
        "encoding: raw\nendian: little\n\n"
    )
    path.write_bytes(header.encode() + samples.tobytes())


def clinical_ct(shared, cache, factor):
    def make(path):
        subprocess.run(
            [sys.executable, shared / "tools" / "make_bigct.py", path, str(factor)],
            check=True,
            stdout=subprocess.DEVNULL,
        )

    return Surface(f"clinical_ct_{factor}", CT_ISOVALUE, cache / f"clinical_ct_{factor}.nrrd", make)


def noise(cache, size):
    return Surface(
        f"noise_{size}", "0.5", cache / f"noise_{size}.nrrd", lambda path: write_noise(path, size)
    )


def stem(file_name):
    return file_name.split(".")[0]


class Catalogue:
    """All isosurfaces, and the lists that sections measure by default."""

    def __init__(self, shared, cache):
        with open(shared / "data" / "TOPOLOGY.tsv") as table:
            real = [
                Surface(stem(row["file"]), row["isovalue"], shared / "data" / row["file"])
                for row in csv.DictReader(table, delimiter="\t")
            ]
        cts = [clinical_ct(shared, cache, factor) for factor in CT_FACTORS]
        noises = [noise(cache, size) for size in NOISE_SIZES]
        self.by_name = {s.name: s for s in [*real, *cts, *noises]}
        self.growth = [s.name for s in [*cts, *noises]]
        self.standard = [s.name for s in real] + [
            f"clinical_ct_2@{CT_ISOVALUE}",
            "noise_64@0.5",
            "noise_128@0.5",
        ]

    def select(self, names, patterns, candidates=None):
        """The names to measure: `names`, or with patterns the matching `candidates` (default: all).

        A pattern is the start of a name or a shell pattern.
        """
        if not patterns:
            return names
        return [
            name
            for name in (candidates or self.by_name)
            if any(name.startswith(p) or fnmatch.fnmatchcase(name, p) for p in patterns)
        ]
