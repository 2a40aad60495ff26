# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
from typing import Sequence

from . import _core
from ._mesh import Mesh
from ._volume import Volume
from .errors import BadArgumentError

_MESHES = (".ply", ".stl", ".obj", ".off", ".vtp", ".glb", ".vtm")


def read(
    path: str | os.PathLike[str],
    *,
    raw_size: Sequence[int] | None = None,
    raw_type: str | None = None,
    raw_spacing: Sequence[float] | None = None,
    raw_endian: str | None = None,
) -> Volume | Mesh:
    """Read a volume, or a mesh with its levels, by the extension of the name: `read_mesh` for ``.ply``, ``.stl``, ``.obj``, ``.off``, ``.vtp``, ``.glb`` and
    ``.vtm``, else `read_volume`. Those two are the better choice where types are checked.
    """
    raw = (raw_size, raw_type, raw_spacing, raw_endian)
    if os.fsdecode(path).lower().endswith(_MESHES) and all(option is None for option in raw):
        return read_mesh(path)
    return read_volume(path, raw_size=raw_size, raw_type=raw_type, raw_spacing=raw_spacing, raw_endian=raw_endian)


def read_volume(
    path: str | os.PathLike[str],
    *,
    raw_size: Sequence[int] | None = None,
    raw_type: str | None = None,
    raw_spacing: Sequence[float] | None = None,
    raw_endian: str | None = None,
) -> Volume:
    """Read a 3-D scalar volume in its native sample type.

    Parameters
    ----------
    path : str or path
        ``.nrrd .nhdr .nii .nii.gz .hdr .img .mha .mhd .tif .tiff .vtk .vti``; a folder is read as a DICOM series.
    raw_size : (NX, NY, NZ), optional
        The file has no header: samples along x, y and z, x running fastest. With ``raw_type``.
    raw_type : str, optional
        ``"int8"`` ... ``"uint64"``, ``"float32"``, ``"float64"``.
    raw_spacing : 3 floats, optional
        Distance between headerless samples. Default: 1.
    raw_endian : {"little", "big"}, optional
        Their byte order. Default: ``"little"``.

    Returns
    -------
    Volume
        ``array`` is indexed ``[z, y, x]``, the rest is in the order x, y, z; the world is LPS in millimetres for medical formats.

    Raises
    ------
    BadFileError
        An ``OSError``: missing, truncated, malformed.
    UnsupportedError
        A ``ValueError``: a vector or 2-D image, an unknown extension.
    """
    if (raw_size is None) != (raw_type is None):
        raise BadArgumentError("raw_size and raw_type: expected both or none of them")
    raw: list[tuple[str, str]] = []
    if raw_size is not None and raw_type is not None:
        raw += [("raw-size", ",".join(str(int(n)) for n in raw_size)), ("raw-type", str(raw_type))]
        if raw_spacing is not None:
            raw.append(("raw-spacing", ",".join(repr(float(s)) for s in raw_spacing)))
        if raw_endian is not None:
            raw.append(("raw-endian", raw_endian))
    elif raw_spacing is not None or raw_endian is not None:
        raise BadArgumentError("raw_spacing and raw_endian: expected raw_size and raw_type with them")
    array, spacing, origin, direction = _core.read_volume(path, raw)
    return Volume(array, spacing, origin, direction, path)


def read_mesh(path: str | os.PathLike[str]) -> Mesh:
    """Read a mesh, or the levels of a ``.glb`` or ``.vtm``.

    Polygons are cut into triangles; corners of an STL file at equal positions are one vertex.

    Raises
    ------
    BadFileError
        An ``OSError``: missing, truncated, malformed.
    UnsupportedError
        A ``ValueError``: an unknown extension.
    """
    return Mesh(_core.read_levels(path))
