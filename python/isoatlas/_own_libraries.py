# SPDX-License-Identifier: Apache-2.0
"""Loads the extension so that it uses its own VTK in the process of ParaView.

ParaView's VTK has the same symbols as the VTK that isoatlas links, and is loaded first with global
symbols. Without RTLD_DEEPBIND, isoatlas' VTK would call functions of the other, and the process
would crash.
"""

from __future__ import annotations

import os
import sys

if "paraview" in sys.modules and hasattr(os, "RTLD_DEEPBIND"):
    _flags = sys.getdlopenflags()
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_DEEPBIND)
    try:
        from . import _core
    finally:
        sys.setdlopenflags(_flags)
else:
    from . import _core

__all__ = ["_core"]
