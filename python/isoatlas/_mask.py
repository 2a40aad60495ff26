# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import operator
from typing import Literal, Sequence, overload

import numpy as np
import numpy.typing as npt

from . import _core
from ._progress import ProgressLike, progress_callback
from ._volume import Order, Volume, core_volume
from .errors import BadArgumentError


@overload
def mask_field(
    labels: Volume,
    label: int | Sequence[int],
    *,
    connectivity: Literal[18, 6, "field"] = 18,
    progress: ProgressLike = None,
    threads: int | None = None,
) -> Volume: ...
@overload
def mask_field(
    labels: npt.ArrayLike | Volume,
    label: int | Sequence[int],
    *,
    connectivity: Literal[18, 6, "field"] = 18,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    order: Order | None = None,
    progress: ProgressLike = None,
    threads: int | None = None,
) -> npt.NDArray[np.float32] | Volume: ...
def mask_field(
    labels: npt.ArrayLike | Volume,
    label: int | Sequence[int],
    *,
    connectivity: Literal[18, 6, "field"] = 18,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    order: Order | None = None,
    progress: ProgressLike = None,
    threads: int | None = None,
) -> npt.NDArray[np.float32] | Volume:
    """A smooth field whose zero set is the boundary of a segmentation.

    The field is positive at the samples with the label and negative at all others, and close to the
    signed distance in units of the smallest spacing. Meshed at 0 with ``topology="faces"``, it has
    the components, tunnels and cavities of the segmentation. ``extract(labels, label=3)`` does
    both.

    Parameters
    ----------
    labels : (M, N, P) array or Volume
        Integers, bools, or floating-point numbers that are all whole.
    label : int or sequence of int
        The label; several are one part.
    connectivity : {18, 6, "field"}
        Inside samples are connected across faces and edges (18), or across faces only (6); or as
        the field is between samples, whatever that gives.
    spacing, order
        As in `extract`, for an array.
    progress, threads
        As in `extract`.

    Returns
    -------
    (M, N, P) float32 array, or Volume
        As ``labels``.

    Raises
    ------
    BadArgumentError
        A ``ValueError``: an argument is out of its domain.
    EmptySurfaceError
        A ``ValueError``: no sample has the label, or all have it.
    UnsupportedError
        A ``ValueError``: floating-point numbers that are not whole.

    Notes
    -----
    After V. Lempitsky, "Surface extraction from binary volumes with higher-order smoothness", CVPR
    2010. See docs/theory/09-segmentations.md.
    """
    try:
        numbers = [operator.index(n) for n in np.atleast_1d(np.asarray(label)).tolist()]
    except TypeError:
        raise BadArgumentError(
            f"label: expected a whole number or several, got {label!r}"
        ) from None
    core = core_volume(labels, spacing, (0.0, 0.0, 0.0), None, order)
    with progress_callback(progress) as callback:
        field = _core.mask_field(core, numbers, str(connectivity), threads or 0, callback)
    return labels.replace(array=field) if isinstance(labels, Volume) else field
