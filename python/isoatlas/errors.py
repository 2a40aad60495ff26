# SPDX-License-Identifier: Apache-2.0
"""Exceptions of isoatlas.

The text of an error is the line that the command line prints after ``isoatlas: error:``, with the
names that the arguments have in Python.

Each class also derives from the matching built-in exception, so ``except ValueError`` works as well
as ``except isoatlas.Error``. An argument of a wrong type raises a plain ``TypeError``.
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
    """Base class of all errors. ``code`` is the name of the library's ``ErrorCode``."""

    code: str = "internal"


class BadArgumentError(Error, ValueError):
    """An argument is out of its domain."""

    code = "bad_argument"


class BadFileError(Error, OSError):
    """A file is missing, truncated, malformed or cannot be written."""

    code = "bad_file"


class UnsupportedError(Error, ValueError):
    """A well-formed array or file that isoatlas cannot mesh.

    Examples: NaN without ``nan=``, a 2-D image, complex samples.
    """

    code = "unsupported"


class EmptySurfaceError(Error, ValueError):
    """There is no isosurface at this isovalue. The text states the range of the samples."""

    code = "empty_surface"


class OutOfMemoryError(Error, MemoryError):
    """An allocation failed."""

    code = "out_of_memory"


class InternalError(Error, RuntimeError):
    """A check of isoatlas on its own result failed. This is a bug; please report it.

    A mesh that fails a check is never returned.
    """

    code = "internal"


class FileWarning(UserWarning):
    """A reader had to assume something about a file, or a written file differs from the guarantees.

    The text gives the details.
    """
