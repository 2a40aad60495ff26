# SPDX-License-Identifier: Apache-2.0
"""Isosurface meshes with guaranteed topology, from numpy arrays and volume files.

    >>> import isoatlas
    >>> volume = isoatlas.read("scan.nii.gz")
    >>> mesh = isoatlas.extract(volume, 300.5, max_distance=0.4)
    >>> mesh.save("bone.ply")

`extract` meshes an array or a `Volume`, `read` reads volumes and meshes, `check` validates any
triangle mesh, and `marching_cubes` replaces the function of scikit-image. See docs/python.md.
"""

from __future__ import annotations

from . import _own_libraries  # isort: skip  # loads _core, so it comes first
from ._check import check
from ._core import VolumeSource, __version__
from ._extract import extract
from ._marching_cubes import marching_cubes
from ._mesh import Level, Mesh
from ._read import read, read_mesh, read_volume
from ._volume import Volume
from .errors import (
    BadArgumentError,
    BadFileError,
    EmptySurfaceError,
    Error,
    FileWarning,
    InternalError,
    OutOfMemoryError,
    UnsupportedError,
)

__all__ = [
    "BadArgumentError",
    "BadFileError",
    "EmptySurfaceError",
    "Error",
    "FileWarning",
    "InternalError",
    "Level",
    "Mesh",
    "OutOfMemoryError",
    "UnsupportedError",
    "Volume",
    "VolumeSource",
    "__version__",
    "check",
    "extract",
    "marching_cubes",
    "read",
    "read_mesh",
    "read_volume",
]
