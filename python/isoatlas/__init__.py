# SPDX-License-Identifier: Apache-2.0
"""Isosurface meshes with guaranteed topology, from numpy arrays and volume files.

    >>> import isoatlas
    >>> volume = isoatlas.read("scan.nii.gz")
    >>> mesh = isoatlas.extract(volume, 300.5, max_distance=0.4)
    >>> mesh.save("bone.ply")

`extract` meshes an array or a `Volume`, or a label of a segmentation, `read` reads volumes and
meshes, `check` validates any triangle mesh, and `marching_cubes` replaces the function of
scikit-image. ``mesh.show()`` shows a mesh in 3-D. `isoatlas.examples` has volumes to try. See
docs/python.md.
"""

from __future__ import annotations

import sys as _sys

from . import examples
from ._check import check
from ._core import VolumeSource, __version__
from ._extract import extract
from ._marching_cubes import marching_cubes
from ._mask import mask_field
from ._mesh import Component, Level, Mesh
from ._read import read, read_mesh, read_volume
from ._volume import XYZ, Volume
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
    "Component",
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
    "XYZ",
    "__version__",
    "check",
    "examples",
    "extract",
    "marching_cubes",
    "mask_field",
    "read",
    "read_mesh",
    "read_volume",
]

# Adds `grid.isoatlas` to PyVista's ImageData. If PyVista is imported later, PyVista 0.48 and later
# finds it by itself; with earlier versions, import isoatlas.pyvista.
if hasattr(_sys.modules.get("pyvista"), "ImageData"):
    from . import pyvista as _pyvista  # noqa: F401
