# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import contextlib
from typing import Any, Callable, Iterator, Union

Progress = Callable[[str, float], Any]
ProgressLike = Union[Progress, bool, None]


class _Bar:
    """A progress bar of tqdm with the remaining time."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            raise ImportError(
                "progress=True needs the package tqdm; "
                "or pass a function: progress(stage, fraction)"
            ) from None
        self._bar = tqdm(
            total=1.0,
            bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}",
            leave=False,
        )

    def __call__(self, stage: str, fraction: float) -> None:
        self._bar.set_description_str(stage, refresh=False)
        self._bar.n = fraction
        self._bar.refresh()

    def close(self) -> None:
        self._bar.close()


@contextlib.contextmanager
def progress_callback(progress: ProgressLike) -> Iterator[Progress | None]:
    """The function that the extension calls with the progress; None without progress.

    Raises
    ------
    TypeError
        ``progress`` is neither a function nor a bool nor None.
    ImportError
        ``progress`` is True and tqdm is not installed.
    """
    if progress is None or progress is False:
        yield None
    elif progress is True:
        bar = _Bar()
        try:
            yield bar
        finally:
            bar.close()
    elif callable(progress):
        yield progress
    else:
        raise TypeError(
            f"progress: expected a function of (stage, fraction), True or None, got {progress!r}"
        )
