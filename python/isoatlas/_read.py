# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
import warnings
from typing import Any, Sequence

from . import _core
from ._mesh import Mesh
from ._volume import Volume
from .errors import BadArgumentError, FileWarning

_MESHES = (".ply", ".stl", ".obj", ".off", ".vtp", ".glb", ".vtm", ".3mf", ".gii")


def read(path: str | os.PathLike[str], **options: Any) -> Volume | Mesh:
    """Read a volume, or a mesh with its levels, by the extension of the name: `read_mesh` for ``.ply``, ``.stl``, ``.obj``, ``.off``, ``.vtp``, ``.glb``,
    ``.vtm``, ``.3mf`` and ``.gii``, else `read_volume`, whose options it takes. Those two are the better choice where types are checked.
    """
    if os.fsdecode(path).lower().endswith(_MESHES) and all(option is None for option in options.values()):
        return read_mesh(path)
    return read_volume(path, **options)


def read_volume(
    path: str | os.PathLike[str],
    *,
    channel: int | None = None,
    time: int | None = None,
    layer: int | str | None = None,
    array: str | None = None,
    series: int | str | None = None,
    spacing: Sequence[float] | str | None = None,
    roi: str | Sequence[tuple[int, int]] | None = None,
    max_memory: int | str | None = None,
    raw_size: Sequence[int] | None = None,
    raw_type: str | None = None,
    raw_spacing: Sequence[float] | None = None,
    raw_endian: str | None = None,
    raw_offset: int | None = None,
) -> Volume:
    """Read a 3-D scalar volume in its native sample type. What had to be assumed is warned of (`FileWarning`).

    Parameters
    ----------
    path : str or path
        A file of one of the formats in docs/reference/formats.md, whatever its name, or a folder: a DICOM series, or slices.
    channel, time : int, optional
        Which of several channels (or values per sample) and time points to read, from 0.
    layer : int or str, optional
        Which of several layers of a segmentation to read: its number from 0, or its name.
    array : str, optional
        Which of several named arrays of a VTK file to read.
    series : int or str, optional
        Which of several DICOM series, or images of a file, to read: its number from 0, or its UID.
    spacing : (SX, SY, SZ) or str, optional
        World length of one step along x, y and z, in place of the file's; ``"0.2,0.2,1um"`` gives the unit as well.
    roi : three (first, last) pairs, or str, optional
        Keep only these samples along x, y and z, both ends included: ``((10, 99), (0, 63), (0, 40))`` or ``"10:99,0:63,:"``, where nothing
        stands for the border.
    max_memory : int or str, optional
        Refuse a volume whose samples take more: bytes, or ``"8GiB"``. Default: three quarters of the machine's memory.
    raw_size : (NX, NY, NZ), optional
        The file has no header: samples along x, y and z, x running fastest. With ``raw_type``.
    raw_type : str, optional
        ``"int8"`` ... ``"uint64"``, ``"float32"``, ``"float64"``.
    raw_spacing : 3 floats, optional
        Distance between headerless samples. Default: 1.
    raw_endian : {"little", "big"}, optional
        Their byte order. Default: ``"little"``.
    raw_offset : int, optional
        Bytes before the first headerless sample. Default: 0.

    Returns
    -------
    Volume
        ``array`` is indexed ``[z, y, x]``, the rest is in the order x, y, z; the world is LPS in millimetres for medical formats.

    Raises
    ------
    BadFileError
        An ``OSError``: missing, truncated, malformed.
    UnsupportedError
        A ``ValueError``: a 2-D image, an unknown format, or several volumes in the file and no choice of one; the text lists them.
    OutOfMemoryError
        A ``MemoryError``: more samples than ``max_memory``.
    """
    if (raw_size is None) != (raw_type is None):
        raise BadArgumentError("raw_size and raw_type: expected both or none of them")
    if raw_size is None and any(it is not None for it in (raw_spacing, raw_endian, raw_offset)):
        raise BadArgumentError("raw_spacing, raw_endian and raw_offset: expected raw_size and raw_type with them")
    given: dict[str, str | None] = {
        "channel": _whole(channel, "channel"),
        "time": _whole(time, "time"),
        "layer": None if layer is None else str(layer),
        "array": array,
        "series": None if series is None else str(series),
        "spacing": _lengths(spacing),
        "roi": roi if roi is None or isinstance(roi, str) else ",".join(f"{first}:{last}" for first, last in roi),
        "max-memory": None if max_memory is None else str(max_memory),
        "raw-size": None if raw_size is None else ",".join(str(int(n)) for n in raw_size),
        "raw-type": raw_type,
        "raw-spacing": _lengths(raw_spacing),
        "raw-endian": raw_endian,
        "raw-offset": _whole(raw_offset, "raw_offset"),
    }
    words = [(name, text) for name, text in given.items() if text is not None]
    samples, steps, origin, direction, unit, source = _core.read_volume(path, words)
    for warning in source.warnings:
        warnings.warn(f"{os.fsdecode(path)}: {warning}", FileWarning, stacklevel=2)
    return Volume(samples, steps, origin, direction, path, unit or None, source)


def _whole(number: int | None, name: str) -> str | None:
    if number is None:
        return None
    if isinstance(number, bool) or int(number) != number:
        raise BadArgumentError(f"{name}: expected a whole number, got {number!r}")
    return str(int(number))


def _lengths(lengths: Sequence[float] | str | None) -> str | None:
    if lengths is None or isinstance(lengths, str):
        return lengths
    return ",".join(repr(float(s)) for s in lengths)


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
