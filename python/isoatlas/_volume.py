# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import dataclasses
import os
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, Sequence

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import Array, Matrix, Triple, as_direction, as_samples, as_triple
from ._core import VolumeSource
from .errors import BadArgumentError

Order = Literal["ijk", "xyz"]
UNIT: Triple = (1.0, 1.0, 1.0)
ZERO: Triple = (0.0, 0.0, 0.0)


class XYZ(NamedTuple):
    """Three numbers in the order x, y, z: the type of ``Volume.spacing`` and ``Volume.origin``.

    It is a tuple that knows its order. `extract` and `check` take an array with such a ``spacing``
    or ``origin`` as indexed ``[z, y, x]``, so
    ``extract(volume.array > 200, 0.5, spacing=volume.spacing)`` has the right proportions.
    """

    x: float
    y: float
    z: float


class Direction(tuple[Triple, Triple, Triple]):
    """The rows of a 3 x 3 matrix for coordinates in the order x, y, z."""

    __slots__ = ()


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Volume:
    """Samples on a grid: the result of `read`, and an input of `extract` and `check`.

    The sample ``array[z, y, x]`` is at ``origin + direction @ (spacing * (x, y, z))`` in world
    coordinates. A volume can be pickled and copied.

    Attributes
    ----------
    array : (NZ, NY, NX) ndarray
        The samples in the type of the file, indexed ``[z, y, x]``; x runs fastest in memory. You
        may change the samples; `replace` gives a volume with another array.
    spacing : XYZ
        Distance between samples along x, y and z, in ``unit``; in millimetres for medical formats.
    origin : XYZ
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
    spacing: XYZ
    origin: XYZ
    direction: Matrix
    path: str | os.PathLike[str] | None
    unit: str | None
    source: VolumeSource | None

    def __init__(
        self,
        array: npt.ArrayLike,
        spacing: Sequence[float] = UNIT,
        origin: Sequence[float] = ZERO,
        direction: npt.ArrayLike | None = None,
        path: str | os.PathLike[str] | None = None,
        unit: str | None = None,
        source: VolumeSource | None = None,
    ) -> None:
        if unit is not None and not _core.length_unit(unit):
            raise BadArgumentError(
                f"unit: expected one of nm, um, mm, cm, m, A, in or None, got {unit!r}"
            )
        fields = {
            "array": np.asanyarray(array),
            "spacing": XYZ(*as_triple(spacing, "spacing")),
            "origin": XYZ(*as_triple(origin, "origin")),
            "direction": Direction(as_direction(direction)),
            "path": path,
            "unit": unit,
            "source": source,
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)  # the class is frozen

    def replace(
        self,
        *,
        array: npt.ArrayLike | None = None,
        spacing: Sequence[float] | None = None,
        origin: Sequence[float] | None = None,
        direction: npt.ArrayLike | None = None,
        unit: str | None = None,
    ) -> Volume:
        """A volume with another array or geometry; everything else is that of this volume.

        ``volume.replace(array=mask)`` is the way to mesh a mask, a smoothed array or a distance
        field that was computed from ``volume.array``: its mesh is where the volume is.

        Parameters
        ----------
        array : (NZ, NY, NX) array, optional
            The samples, indexed ``[z, y, x]``. A part of the array, or a padded array, starts at
            another position and therefore needs ``origin``. The new volume has no ``path`` and no
            ``source``, because its samples are not those of the file.
        spacing, origin, direction, unit : optional
            As the attributes.

        Raises
        ------
        BadArgumentError
            A ``ValueError``: an array of another shape without ``origin`` or ``spacing``; geometry
            of a wrong shape; an unknown unit.
        """
        changes: dict[str, Any] = {
            "spacing": spacing,
            "origin": origin,
            "direction": direction,
            "unit": unit,
        }
        changes = {name: value for name, value in changes.items() if value is not None}
        if array is not None:
            samples = np.asanyarray(array)
            if samples.shape != self.array.shape and not {"spacing", "origin"} & changes.keys():
                raise BadArgumentError(
                    f"array: expected the shape {self.array.shape} of the volume, got "
                    f"{samples.shape}; another shape needs the origin or spacing of its samples"
                )
            changes.update(array=samples, path=None, source=None)
        return dataclasses.replace(self, **changes)

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
        Geometry with a `Volume`, which has its own; geometry of a wrong shape; or geometry that
        needs an ``order``.
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
            volume.spacing,
            volume.origin,
            volume.direction,
            volume.path,
            volume.unit or "",
            volume.source,
        )
    if isinstance(volume, (str, bytes, os.PathLike)):
        raise TypeError("expected an array or a Volume, got a path: use isoatlas.read(path)")
    return _core.ArrayVolume(
        as_samples(volume),
        order_of(spacing, origin, direction, order),
        as_triple(spacing, "spacing"),
        as_triple(origin, "origin"),
        as_direction(direction),
        None,
        "",
        None,
    )


def states_order(volume: Any, order: str | None, *geometry: Any) -> bool:
    """Whether a caller stated which axis of the array is x."""
    return (
        isinstance(volume, Volume)
        or order is not None
        or any(isinstance(it, (XYZ, Direction)) for it in geometry)
    )


def order_of(
    spacing: Sequence[float],
    origin: Sequence[float],
    direction: npt.ArrayLike | None,
    order: str | None,
) -> str:
    """The order of the coordinates of an array.

    Raises
    ------
    BadArgumentError
        No order is stated, and the two orders give different surfaces; or the stated order is not
        that of the geometry.
    """
    geometry = {"spacing": spacing, "origin": origin, "direction": direction}
    tagged = [name for name, it in geometry.items() if isinstance(it, (XYZ, Direction))]
    if tagged and order == "ijk":
        raise BadArgumentError(
            f"order: the {tagged[0]} is that of a Volume, in the order x, y, z: "
            "expected order='xyz' or no order, got 'ijk'"
        )
    if order is not None:
        return order
    if tagged:
        return "xyz"
    matrix = as_direction(direction)
    forms = {
        "spacing": (as_triple(spacing, "spacing"), as_triple(spacing, "spacing")[::-1]),
        "origin": (as_triple(origin, "origin"), as_triple(origin, "origin")[::-1]),
        "direction": (matrix, tuple(row[::-1] for row in matrix[::-1])),
    }
    for name, (one, other) in forms.items():
        if one != other:
            raise BadArgumentError(
                f"order: expected it with this {name}: order='ijk' if {name} is in the order of "
                "the array's axes, order='xyz' if the array is indexed [z, y, x] "
                f"and {name} is in the order x, y, z"
            )
    return "ijk"
