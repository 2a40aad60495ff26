# SPDX-License-Identifier: Apache-2.0
"""Converts values of options to the texts that the command line accepts.

Python and the command line therefore share domains, defaults and messages.
"""

from __future__ import annotations

import numbers
from typing import Any, Mapping, Sequence, Union

import numpy as np

from .errors import BadArgumentError

Number = Union[float, "np.floating[Any]", "np.integer[Any]"]
Length = Union[float, str]
Words = list[tuple[str, str]]
LevelSpec = Union[str, Mapping[str, Length]]
Refine = Union[LevelSpec, Sequence[LevelSpec]]


def word(name: str, value: object) -> str:
    """The exact value as text.

    Raises
    ------
    TypeError
        ``value`` is neither a real number nor a text; the message names the argument ``name``.
    """
    if isinstance(value, str):
        return value
    if isinstance(value, numbers.Integral) and not isinstance(value, bool):
        return str(int(value))
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        number = float(value)
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    raise TypeError(f"{name}: expected a number or a text, got {value!r}")


def words(options: Mapping[str, object]) -> Words:
    """The options that are not None, under their names on the command line."""
    return [
        (name.replace("_", "-"), word(name, value))
        for name, value in options.items()
        if value is not None
    ]


def points(name: str, value: object) -> Words:
    """One option per point, with a text like ``"1.5,2,3"``.

    Raises
    ------
    BadArgumentError
        ``value`` is not one point or a sequence of points.
    """
    if value is None:
        return []
    option = name.replace("_", "-")
    if isinstance(value, str):
        return [(option, value)]
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim == 1:
        array = array[np.newaxis]
    if array.ndim != 2 or array.shape[1] != 3:
        raise BadArgumentError(
            f"{name}: expected a point (x, y, z) or a sequence of points, got {value!r}"
        )
    return [(option, ",".join(word(name, number) for number in point)) for point in array]


def isovalue(name: str, value: object) -> str:
    """The isovalue as text.

    Raises
    ------
    BadArgumentError
        An integer that float64 cannot hold: the rounded value would have another isosurface.
    """
    if (
        isinstance(value, numbers.Integral)
        and not isinstance(value, bool)
        and int(float(int(value))) != int(value)
    ):
        raise BadArgumentError(f"{name}: expected a number that is a float64, got {int(value)}")
    return word(name, value)


def levels(refine: Refine | None) -> list[str | Words]:
    """The constraints of each refined level: a text of ``--refine``, or options."""
    if refine is None:
        return []
    if isinstance(refine, (str, Mapping)):
        refine = [refine]
    specs: list[str | Words] = []
    for spec in refine:
        if isinstance(spec, str):
            specs.append(spec)
        elif isinstance(spec, Mapping):
            if not spec:
                raise BadArgumentError("refine: expected at least one bound for a level, got {}")
            specs.append(
                [
                    (name.replace("_", "-"), word(f"refine: {name}", bound))
                    for name, bound in spec.items()
                ]
            )
        else:
            raise TypeError(
                "refine: expected a text like 'max-distance:0.5vx', "
                f"a dict like {{'max-distance': 0.5}}, or a list of them, got {spec!r}"
            )
    return specs
