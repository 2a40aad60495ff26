# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal, Sequence

import numpy.typing as npt

from . import _core
from ._arrays import Array, Matrix, Triple, as_direction, as_samples, as_triple
from ._core import VolumeSource
from .errors import BadArgumentError

Order = Literal["ijk", "xyz"]
UNIT: Triple = (1.0, 1.0, 1.0)
ZERO: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False, repr=False)
class Volume:
    """Samples on a grid: the result of `read`, and an input of `extract` and `check`.

    The sample ``array[z, y, x]`` is at ``origin + direction @ (spacing * (x, y, z))`` in world
    coordinates.

    Attributes
    ----------
    array : (NZ, NY, NX) ndarray
        The samples in the type of the file, indexed ``[z, y, x]``; x runs fastest in memory. You
        may change the samples.
    spacing : (x, y, z)
        Distance between samples along each axis, in ``unit``; in millimetres for medical formats.
    origin : (x, y, z)
        World position of the sample ``array[0, 0, 0]``.
    direction : 3 x 3, row by row
        The columns are the unit vectors of the x, y and z axes.
    path : str or None
        The file that the volume was read from.
    unit : str or None
        Unit of lengths in world coordinates: ``"nm"``, ``"um"``, ``"mm"``, ``"cm"``, ``"m"``,
        ``"A"`` or ``"in"``; None if it is unknown. A length with a unit, such as
        ``max_distance="0.5um"``, is converted to it.
    source : VolumeSource or None
        How the file was understood: ``format``, ``reader``, ``decisions``, ``choices`` and
        ``warnings``.
    """

    array: Array
    spacing: Triple = UNIT
    origin: Triple = ZERO
    direction: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    path: str | os.PathLike[str] | None = None
    unit: str | None = None
    source: VolumeSource | None = None

    def __post_init__(self) -> None:
        if self.unit is not None and not _core.length_unit(self.unit):
            raise BadArgumentError(
                f"unit: expected one of nm, um, mm, cm, m, A, in or None, got {self.unit!r}"
            )

    def __repr__(self) -> str:
        size = " x ".join(str(n) for n in reversed(self.array.shape))
        spacing = " x ".join(f"{s:g}" for s in self.spacing) + (
            f" {self.unit}" if self.unit else ""
        )
        where = "" if self.path is None else f", {os.fspath(self.path)!r}"
        return f"<isoatlas.Volume: {size} {self.array.dtype}, spacing {spacing}{where}>"


def core_volume(
    volume: Any,
    spacing: Sequence[float],
    origin: Sequence[float],
    direction: npt.ArrayLike | None,
    order: str | None,
) -> _core.ArrayVolume:
    """Convert an array with its geometry, or a `Volume`, to the form of the extension.

    Raises
    ------
    BadArgumentError
        Geometry with a `Volume`, which has its own; or geometry of a wrong shape.
    UnsupportedError
        The samples cannot be meshed, see `as_samples`.
    TypeError
        ``volume`` is a path.
    """
    if isinstance(volume, Volume):
        given = {
            "spacing": tuple(spacing) != UNIT,
            "origin": tuple(origin) != ZERO,
            "direction": direction is not None,
        }
        for name, is_given in given.items():
            if is_given:
                raise BadArgumentError(
                    f"{name}: the volume has its own, expected {name} with an array only"
                )
        if order not in (None, "xyz"):
            raise BadArgumentError(
                f"order: a Volume is 'xyz', got {order!r}; pass its array for another"
            )
        return _core.ArrayVolume(
            as_samples(volume.array),
            "xyz",
            as_triple(volume.spacing, "spacing"),
            as_triple(volume.origin, "origin"),
            as_direction(volume.direction),
            volume.path,
            volume.unit or "",
            volume.source,
        )
    if isinstance(volume, (str, bytes, os.PathLike)):
        raise TypeError("expected an array or a Volume, got a path: use isoatlas.read(path)")
    return _core.ArrayVolume(
        as_samples(volume),
        "ijk" if order is None else order,
        as_triple(spacing, "spacing"),
        as_triple(origin, "origin"),
        as_direction(direction),
        None,
        "",
        None,
    )
