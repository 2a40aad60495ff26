# SPDX-License-Identifier: Apache-2.0
# The extension (python/src/module.cpp). Private: its functions expect checked arguments.
import os
from typing import Any, Callable, Sequence

import numpy as np
import numpy.typing as npt

__version__: str

_Words = Sequence[tuple[str, str]]
_Triple = tuple[float, float, float]
_Matrix = tuple[_Triple, _Triple, _Triple]
_Path = str | bytes | os.PathLike[str]

class VolumeSource:
    @property
    def format(self) -> str: ...
    @property
    def reader(self) -> str: ...
    @property
    def decisions(self) -> dict[str, str]: ...
    @property
    def choices(self) -> dict[str, tuple[str, ...]]: ...
    @property
    def warnings(self) -> tuple[str, ...]: ...

class ArrayVolume:
    def __init__(
        self,
        array: npt.NDArray[Any],
        order: str,
        spacing: _Triple,
        origin: _Triple,
        direction: _Matrix,
        path: _Path | None,
        unit: str,
        source: VolumeSource | None,
    ) -> None: ...

class ExtractWords:
    def __init__(
        self,
        settings: _Words,
        constraints: _Words,
        refine: Sequence[str | _Words],
        coarse: bool,
        allow_self_intersections: bool,
    ) -> None: ...

class Levels:
    def __len__(self) -> int: ...
    def vertices(self, level: int) -> npt.NDArray[np.float64]: ...
    def faces(self, level: int) -> npt.NDArray[np.uint32]: ...
    def distance(self, level: int) -> npt.NDArray[np.float32] | None: ...
    def triangle_counts(self) -> list[int]: ...
    def components(
        self, level: int
    ) -> list[
        tuple[int, int, int, int | None, int | None, float, float, _Triple, _Triple]
    ]: ...
    def page(self, level_count: int) -> str: ...
    def report(self) -> str: ...
    def level_reports(self) -> list[str]: ...
    @property
    def space(self) -> str: ...
    @property
    def placement(self) -> str: ...
    def save(self, path: _Path, report: _Path | None, glb_per_level: bool) -> str: ...
    def save_neuroglancer(self, folder: _Path) -> None: ...

class BlockedArray:
    def __init__(
        self,
        shape: tuple[int, int, int],
        dtype: np.dtype[Any],
        blocks: tuple[int, int, int],
        order: str,
        spacing: _Triple,
        origin: _Triple,
        direction: _Matrix,
        unit: str,
        words: ExtractWords,
    ) -> None: ...
    def __len__(self) -> int: ...
    def slices(
        self, block: int
    ) -> tuple[tuple[int, int], tuple[int, int], tuple[int, int]]: ...
    def mesh(self, block: int, samples: npt.NDArray[Any]) -> bytes: ...
    def merge(
        self,
        meshes: Sequence[bytes],
        samples: Callable[..., npt.NDArray[Any]],
        progress: Callable[[str, float], Any] | None,
    ) -> Levels: ...

def extract(
    volume: ArrayVolume, words: ExtractWords, progress: Callable[[str, float], Any] | None
) -> Levels: ...
def mask_field(
    labels: ArrayVolume,
    wanted: Sequence[int],
    connectivity: str,
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> npt.NDArray[np.float32]: ...
def length_unit(name: str) -> str: ...
def read_volume(
    path: _Path, options: _Words
) -> tuple[npt.NDArray[Any], _Triple, _Triple, _Matrix, str, VolumeSource]: ...
def read_levels(path: _Path) -> Levels: ...
def check(
    vertices: npt.NDArray[np.float64],
    faces: npt.NDArray[np.uint32],
    self_intersections: bool,
    volume: ArrayVolume | None,
    measure: _Words,
    threads: int,
    progress: Callable[[str, float], Any] | None,
) -> str: ...
def abandoned_work_count() -> int: ...
