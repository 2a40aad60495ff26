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
    """Read a volume, or a mesh with its levels; the extension of the name decides.

    ``.ply``, ``.stl``, ``.obj``, ``.off``, ``.vtp``, ``.glb``, ``.vtm``, ``.3mf`` and ``.gii`` are
    read by `read_mesh`, everything else by `read_volume` with its ``options``. Code with checked
    types should call these two functions, because the type of their result is known.
    """
    if os.fsdecode(path).lower().endswith(_MESHES) and all(
        option is None for option in options.values()
    ):
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
    """Read a 3-D scalar volume in its own sample type.

    Every assumption of the reader is issued as a `FileWarning`.

    Parameters
    ----------
    path : str or path
        A file in one of the formats of docs/reference/formats.md (its content decides the format,
        not its name), or a folder with a DICOM series or image slices.
    channel, time : int, optional
        Channel (or component of vector samples) and time point to read, counted from 0. Required
        if the file has several.
    layer : int or str, optional
        Layer of a segmentation file to read: its number from 0, or its name.
    array : str, optional
        Named array of a VTK file to read.
    series : int or str, optional
        DICOM series, or image of a file with several, to read: its number from 0, or its UID.
    spacing : (SX, SY, SZ) or str, optional
        Distance between samples along x, y and z; overrides that of the file. The text
        ``"0.2,0.2,1um"`` sets the unit as well.
    roi : three (first, last) pairs, or str, optional
        Region of interest. Read only these samples along x, y and z, both ends included:
        ``((10, 99), (0, 63), (0, 40))`` or ``"10:99,0:63,:"``. A missing number in the text stands
        for the end of the volume.
    max_memory : int or str, optional
        Refuse a volume whose samples need more memory: a number of bytes, or ``"8GiB"``. Default:
        three quarters of the machine's memory.
    raw_size : (NX, NY, NZ), optional
        Number of samples along x, y and z of a file without a header, x running fastest. Requires
        ``raw_type``.
    raw_type : str, optional
        Sample type of a file without a header: ``"int8"`` to ``"int64"``, ``"uint8"`` to
        ``"uint64"``, ``"float32"`` or ``"float64"``.
    raw_spacing : 3 floats, optional
        Distance between samples of a file without a header. Default: 1.
    raw_endian : {"little", "big"}, optional
        Byte order of a file without a header. Default: ``"little"``.
    raw_offset : int, optional
        Number of bytes before the first sample of a file without a header. Default: 0.

    Returns
    -------
    Volume
        ``array`` is indexed ``[z, y, x]``; all other attributes are in the order x, y, z. World
        coordinates are LPS in millimetres for medical formats.

    Raises
    ------
    BadFileError
        An ``OSError``: a file that is missing, truncated or malformed.
    UnsupportedError
        A ``ValueError``: a 2-D image, an unknown format, or a file with several volumes if none is
        chosen; the text lists them.
    OutOfMemoryError
        A ``MemoryError``: the samples need more than ``max_memory``.
    """
    if (raw_size is None) != (raw_type is None):
        raise BadArgumentError("raw_size and raw_type: expected both or none of them")
    if raw_size is None and any(it is not None for it in (raw_spacing, raw_endian, raw_offset)):
        raise BadArgumentError(
            "raw_spacing, raw_endian and raw_offset: expected raw_size and raw_type with them"
        )
    given: dict[str, str | None] = {
        "channel": _whole(channel, "channel"),
        "time": _whole(time, "time"),
        "layer": None if layer is None else str(layer),
        "array": array,
        "series": None if series is None else str(series),
        "spacing": _lengths(spacing),
        "roi": (
            roi
            if roi is None or isinstance(roi, str)
            else ",".join(f"{first}:{last}" for first, last in roi)
        ),
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
    """Read a mesh, or all levels of a ``.glb`` or ``.vtm``.

    Polygons are split into triangles. Corners of an STL file at equal positions become one vertex.

    Raises
    ------
    BadFileError
        An ``OSError``: a file that is missing, truncated or malformed.
    UnsupportedError
        A ``ValueError``: an unknown extension.
    """
    return Mesh(_core.read_levels(path))
