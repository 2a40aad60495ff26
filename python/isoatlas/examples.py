# SPDX-License-Identifier: Apache-2.0
"""Volumes that come with isoatlas, to try it.

    >>> from isoatlas import examples, extract
    >>> extract(examples.load_protein(), 100).show()

They are the sample volumes of the repository, from the VTK data collection (BSD 3-Clause, see
``LICENSE-samples.txt`` in `folder`).
"""

from __future__ import annotations

import pathlib

from ._read import read_volume
from ._volume import Volume

__all__ = ["folder", "load_embryo", "load_protein"]


def folder() -> pathlib.Path:
    """The folder with the files, for programs that read files.

    It contains ``protein_iron.nhdr`` with ``protein_iron.raw``, ``embryo.nrrd`` and the licence.
    """
    return pathlib.Path(__file__).with_name("samples")


def load_protein() -> Volume:
    """The electron density of a protein around iron: 68 x 68 x 68 samples, uint8, 0.3 MB.

    At the isovalue 100 it has 35 components; the default mesh has 3,000 triangles and takes a
    fraction of a second.
    """
    return read_volume(folder() / "protein_iron.nhdr")


def load_embryo() -> Volume:
    """A scan of an embryo: 256 x 256 x 256 samples, uint8, 17 MB in memory.

    It is noisy: thousands of specks at the isovalue 90.5. ``keep_components=1`` keeps the embryo.
    """
    return read_volume(folder() / "embryo.nrrd")
