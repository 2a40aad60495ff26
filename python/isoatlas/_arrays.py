# SPDX-License-Identifier: Apache-2.0
"""Conversion of users' arrays to the forms that the extension accepts. Values are never rounded."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np
import numpy.typing as npt

from .errors import BadArgumentError, UnsupportedError

Array = npt.NDArray[Any]
Triple = tuple[float, float, float]
Matrix = tuple[Triple, Triple, Triple]


def _is_dense(array: Array) -> bool:
    """Whether the samples fill their memory without gaps, in some order of the axes."""
    expected = array.itemsize
    for axis in sorted((2, 1, 0), key=lambda axis: array.strides[axis]):
        if array.shape[axis] > 1 and array.strides[axis] != expected:
            return False
        expected *= array.shape[axis]
    return True


def _exactly(array: Array, dtype: type[np.generic], what: str) -> Array:
    """Convert the array to ``dtype``.

    Raises
    ------
    UnsupportedError
        ``dtype`` cannot hold a value of the array.
    """
    with np.errstate(over="ignore"):
        converted = array.astype(dtype)
    back = converted.astype(array.dtype)
    same = (back == array) | ((array != array) & (back != back))
    if not same.all():
        index = tuple(int(i) for i in np.argwhere(~same)[0])
        raise UnsupportedError(
            f"{what} has values of type {array.dtype} that {np.dtype(dtype)} cannot hold, "
            f"the first at index {index}"
        )
    return converted


def as_samples(volume: Any) -> Array:
    """Convert ``volume`` to a dense, aligned 3-D array of a sample type in native byte order.

    An array that already has this form is not copied.

    Raises
    ------
    UnsupportedError
        Masked samples, another number of dimensions, or a dtype without a matching sample type.
    """
    if isinstance(volume, np.ma.MaskedArray):
        masked = int(np.count_nonzero(volume.mask))
        if masked > 0:
            raise UnsupportedError(
                f"the array has {masked} masked samples, expected none: "
                "replace them with .filled(value)"
            )
        volume = volume.data
    array = np.asarray(volume)
    if array.ndim != 3:
        raise UnsupportedError(f"the array has {array.ndim} dimensions {array.shape}, expected 3")
    if array.dtype.kind not in "biuf":
        raise UnsupportedError(
            f"the array has samples of type {array.dtype}, "
            "expected bool, integers or floating-point numbers"
        )
    if array.dtype == np.bool_:
        array = array.view(np.uint8)
    elif array.dtype.kind == "f" and array.dtype.itemsize < 4:
        array = array.astype(np.float32)
    elif array.dtype.kind == "f" and array.dtype.itemsize > 8:
        array = _exactly(array, np.float64, "the array")
    if not array.dtype.isnative:
        array = array.astype(array.dtype.newbyteorder("="))
    if not array.flags.aligned or not _is_dense(array):
        array = np.array(array, order="C")
    return array


def as_vertices(vertices: Any) -> npt.NDArray[np.float64]:
    """Convert to a C-contiguous (V, 3) array.

    Raises
    ------
    BadArgumentError
        Another shape, values that are not real numbers, or a position that is not finite.
    UnsupportedError
        A value that float64 cannot hold.
    """
    array = np.asarray(vertices)
    if array.ndim != 2 or array.shape[1] != 3:
        raise BadArgumentError(f"vertices: expected an array of shape (V, 3), got {array.shape}")
    if array.dtype.kind not in "iuf":
        raise BadArgumentError(f"vertices: expected numbers, got {array.dtype}")
    if array.dtype.itemsize >= 8 and array.dtype != np.float64:
        array = _exactly(array, np.float64, "vertices")
    array = np.ascontiguousarray(array, np.float64)
    finite = np.isfinite(array).all(axis=1)
    if not finite.all():
        raise BadArgumentError(
            f"vertices: the position of vertex {int(np.argmin(finite))} is not finite"
        )
    return array


def as_faces(faces: Any, vertex_count: int) -> npt.NDArray[np.uint32]:
    """Convert to a C-contiguous (F, 3) array.

    Raises
    ------
    BadArgumentError
        Another shape, values that are not integers, or an index outside 0 to ``vertex_count - 1``.
    """
    array = np.asarray(faces)
    if array.ndim != 2 or array.shape[1] != 3:
        raise BadArgumentError(f"faces: expected an array of shape (F, 3), got {array.shape}")
    if array.dtype.kind not in "iu":
        if array.size > 0:
            raise BadArgumentError(f"faces: expected indices of vertices, got {array.dtype}")
        array = array.astype(np.uint32)
    outside = (array < 0) | (array >= vertex_count)
    if outside.any():
        face = int(np.argmax(outside.any(axis=1)))
        corner = int(array[face][np.argmax(outside[face])])
        raise BadArgumentError(
            f"faces: triangle {face} uses vertex {corner}, but there are only {vertex_count}"
        )
    return np.ascontiguousarray(array, np.uint32)


def as_triple(numbers: Sequence[float], name: str) -> Triple:
    """Convert to three floats; errors name the argument ``name``."""
    try:
        values = tuple(float(number) for number in numbers)
    except TypeError:
        raise TypeError(f"{name}: expected 3 numbers, got {numbers!r}") from None
    if len(values) != 3:
        raise BadArgumentError(f"{name}: expected 3 numbers, got {len(values)}")
    return (values[0], values[1], values[2])


def as_direction(direction: npt.ArrayLike | None) -> Matrix:
    """Convert to three rows of three floats; None is the identity."""
    if direction is None:
        return ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    matrix = np.asarray(direction)
    if matrix.size == 9 and matrix.ndim == 1:  # SimpleITK: row by row
        matrix = matrix.reshape(3, 3)
    if matrix.shape != (3, 3):
        raise BadArgumentError(f"direction: expected an array of shape (3, 3), got {matrix.shape}")
    rows = [as_triple(row, "direction") for row in matrix.tolist()]
    return (rows[0], rows[1], rows[2])
