# SPDX-License-Identifier: Apache-2.0
"""What isoatlas raises. The text of an error is the line that the command line prints after ``isoatlas: error:``, with the names of
arguments as Python has them.

Every class is also the built-in exception that one would expect, so ``except ValueError`` works as well as ``except isoatlas.Error``.
A wrong type of an argument is a plain ``TypeError``.
"""

from __future__ import annotations

__all__ = [
    "BadArgumentError",
    "BadFileError",
    "EmptySurfaceError",
    "Error",
    "FileWarning",
    "InternalError",
    "OutOfMemoryError",
    "UnsupportedError",
]


class Error(Exception):
    """The base of them all. ``code`` is the name of the library's ``ErrorCode``."""

    code: str = "internal"


class BadArgumentError(Error, ValueError):
    """An argument is out of its domain."""

    code = "bad_argument"


class BadFileError(Error, OSError):
    """A file is missing, truncated, malformed or cannot be written."""

    code = "bad_file"


class UnsupportedError(Error, ValueError):
    """An array or a file is well formed, but not what isoatlas meshes: NaN without ``nan=``, a 2-D image, complex samples."""

    code = "unsupported"


class EmptySurfaceError(Error, ValueError):
    """There is no isosurface at this isovalue; the text gives the range of the samples."""

    code = "empty_surface"


class OutOfMemoryError(Error, MemoryError):
    """An allocation failed."""

    code = "out_of_memory"


class InternalError(Error, RuntimeError):
    """A check of isoatlas on its own result failed: a bug, please report it. No mesh that failed a check is ever returned."""

    code = "internal"


class FileWarning(UserWarning):
    """Something about a file had to be assumed when it was read, or is not as promised when it is written; the text says what."""
