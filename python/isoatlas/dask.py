# SPDX-License-Identifier: Apache-2.0
"""Meshes of arrays that do not fit into memory, block by block, with Dask.

    >>> import dask.array
    >>> import isoatlas.dask
    >>> array = dask.array.from_zarr("brain.zarr")
    >>> mesh = isoatlas.dask.extract(array, 120.5, spacing=(2.0, 0.5, 0.5), order="ijk")

Every block is one task. Blocks share a layer of samples, so a task needs a few more chunks than its
own; its result is the mesh of the block. The meshes fit exactly, and the merged mesh has the
topology of the isosurface of the whole array. See docs/scale.md.
"""

from __future__ import annotations

from typing import Any, Sequence

import dask
import dask.array
import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import as_direction, as_samples, as_triple
from ._extract import request_of
from ._mesh import Mesh
from ._progress import ProgressLike, progress_callback
from ._volume import Order, order_of, states_order
from ._words import Number
from .errors import BadArgumentError, BadFileError, Error

__all__ = ["extract"]


def extract(
    array: Any,
    iso: Number,
    *,
    blocks: int | Sequence[int] = 256,
    client: Any = None,
    spacing: Sequence[float] = (1.0, 1.0, 1.0),
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    direction: npt.ArrayLike | None = None,
    order: Order | None = None,
    unit: str | None = None,
    progress: ProgressLike = None,
    **options: Any,
) -> Mesh:
    """Mesh the isosurface of an array block by block.

    Parameters
    ----------
    array : (M, N, P) array of dask, zarr, h5py or numpy
        The samples. Arrays that are not of dask are read block by block; with workers on other
        machines, all must be able to read them.
    iso : float
        The isovalue.
    blocks : int or 3 ints
        Grid cells of a block along each axis of the array. Large blocks have fewer vertices on
        shared faces; a block of 256 needs about a gigabyte if the surface is dense. Chunks of the
        same size are read fewest times.
    client : dask.distributed.Client, optional
        Where the blocks are meshed. Default: the current client if there is one, else the threads
        of this process. A block whose worker is lost is meshed again.
    spacing, origin, direction, order, unit : optional
        As of `isoatlas.extract` and of `isoatlas.Volume`.
    progress : function of (stage: str, fraction: float), or bool, optional
        Called with the fraction of the blocks that are done. True shows a bar of tqdm.
    **options
        Those of `isoatlas.extract`, but for those that need the whole surface: ``supersample``,
        ``interpolation="tricubic"``, ``covering="halving"``, ``border="closed"``, a choice of
        components, ``levels``, ``max_vertices``, ``min_vertices``, ``measure`` and
        ``allow_self_intersections``. ``threads`` is that of each task; default: 1.

    Returns
    -------
    Mesh
        As of `isoatlas.extract`; ``report["blocks"]`` describes the blocks. The result does not
        depend on the number of workers or on their order.

    Raises
    ------
    BadArgumentError
        A ``ValueError``: an argument is out of its domain.
    UnsupportedError
        A ``ValueError``: an option that needs the whole surface, or samples that are not numbers.
    EmptySurfaceError
        A ``ValueError``: all samples are on one side of ``iso``.
    BadFileError
        An ``OSError``: a chunk of the array cannot be read; the message has its index.
    """
    cut = (int(blocks),) * 3 if isinstance(blocks, (int, np.integer)) else tuple(map(int, blocks))
    if len(cut) != 3 or min(cut) < 1:
        raise BadArgumentError(f"blocks: expected 1 or 3 numbers above 0, got {blocks!r}")
    lazy = array if isinstance(array, dask.array.Array) else None
    shape = tuple(int(n) for n in array.shape)
    if len(shape) != 3:
        raise BadArgumentError(f"array: expected 3 axes, got the shape {shape}")
    sample = as_samples(np.zeros((2, 2, 2), dtype=array.dtype))  # the type after conversion
    options.setdefault("threads", 1)
    geometry = {
        "shape": shape,
        "dtype": sample.dtype,
        "blocks": cut,
        "order": order_of(spacing, origin, direction, order),
        "spacing": as_triple(spacing, "spacing"),
        "origin": as_triple(origin, "origin"),
        "direction": as_direction(direction),
        "unit": unit or "",
    }
    plan = _plan(geometry, iso, options)
    task = dask.delayed(_mesh_block, pure=False)
    tasks = []
    boxes = [
        tuple(slice(first, end) for first, end in plan.slices(block)) for block in range(len(plan))
    ]
    for block, box in enumerate(boxes):
        part = lazy[box] if lazy is not None else dask.delayed(_part, pure=False)(array, box)
        tasks.append(task(geometry, iso, options, block, part))
    unfinished = dict(enumerate(boxes))
    client = client or _current_client()

    def samples_of(*ends: tuple[int, int]) -> npt.NDArray[Any]:
        """Those around a shared face, which the merge needs."""
        box = tuple(slice(first, end) for first, end in ends)
        unfinished[0] = box
        part = array[box] if lazy is None else lazy[box].compute(scheduler=client or "threads")
        return np.ascontiguousarray(as_samples(np.asarray(part)))

    with progress_callback(progress) as callback:
        try:
            meshes = _computed(tasks, client, callback, unfinished)
            levels = plan.merge(meshes, samples_of, None)
        except Error:
            raise
        except Exception as error:
            _name_unreadable_chunk(array, list(unfinished.values()), error)
            raise
    return Mesh(levels, states_order(None, order, spacing, origin, direction))


def _plan(geometry: dict[str, Any], iso: Number, options: dict[str, Any]) -> _core.BlockedArray:
    return _core.BlockedArray(**geometry, words=request_of(iso, **options))


def _current_client() -> Any:
    try:
        from distributed import get_client

        return get_client()
    except (ImportError, ValueError):
        return None


def _part(array: Any, box: tuple[slice, slice, slice]) -> npt.NDArray[Any]:
    return np.asarray(array[box])


def _mesh_block(
    geometry: dict[str, Any],
    iso: Number,
    options: dict[str, Any],
    block: int,
    samples: npt.ArrayLike,
) -> bytes:
    """One task: depends on nothing but its arguments, so that it can run anywhere and again."""
    plan = _plan(geometry, iso, options)
    return plan.mesh(block, np.ascontiguousarray(as_samples(samples)))


def _computed(
    tasks: list[Any], client: Any, progress: Any, unfinished: dict[int, Any]
) -> list[bytes]:
    """The results of all tasks, in their order. Those that are finished leave `unfinished`."""
    numbers = {task.key: block for block, task in enumerate(tasks)}

    def finish(key: Any) -> None:
        unfinished.pop(numbers[key], None)
        if progress is not None:
            progress("blocks", 1 - len(unfinished) / len(tasks))

    if client is None:
        from dask.callbacks import Callback

        def finished(key: Any, *_: Any) -> None:
            if key in numbers:
                finish(key)

        with Callback(posttask=finished):
            return list(dask.compute(*tasks, scheduler="threads"))
    from distributed import as_completed

    futures = client.compute(tasks)
    numbers = {future.key: block for block, future in enumerate(futures)}
    try:
        for future in as_completed(futures):
            if future.status != "finished":
                # Only chunks of its block can be damaged.
                box = unfinished[numbers[future.key]]
                unfinished.clear()
                unfinished[0] = box
                future.result()  # raises the error
            finish(future.key)
        return list(client.gather(futures))
    except Exception:
        client.cancel(futures)
        raise


def _name_unreadable_chunk(array: Any, boxes: list[tuple[slice, ...]], error: Exception) -> None:
    """Raises a BadFileError if a chunk of the array in one of the boxes cannot be read."""
    chunks = getattr(array, "chunks", None)
    if chunks is None:
        return
    if isinstance(chunks[0], int):
        chunks = tuple(
            tuple(min(step, n - first) for first in range(0, n, step))
            for n, step in zip(array.shape, chunks)
        )
    ends = [np.cumsum(sizes) for sizes in chunks]
    tried = set()
    for box in boxes:
        first = [int(np.searchsorted(e, b.start, "right")) for e, b in zip(ends, box)]
        last = [int(np.searchsorted(e, b.stop - 1, "right")) for e, b in zip(ends, box)]
        for index in np.ndindex(*(b - a + 1 for a, b in zip(first, last))):
            chunk = tuple(int(a + i) for a, i in zip(first, index))
            if chunk in tried:
                continue
            tried.add(chunk)
            samples = tuple(
                slice(int(e[i] - sizes[i]), int(e[i])) for e, sizes, i in zip(ends, chunks, chunk)
            )
            try:
                if isinstance(array, dask.array.Array):
                    array[samples].compute(scheduler="synchronous")
                else:
                    np.asarray(array[samples])
            except Exception as cause:
                where = ", ".join(f"{s.start}:{s.stop}" for s in samples)
                raise BadFileError(
                    f"chunk {chunk} of the array, samples [{where}], cannot be read: "
                    f"{type(cause).__name__}: {' '.join(str(cause).split())}"
                ) from error
