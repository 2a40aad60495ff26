# SPDX-License-Identifier: Apache-2.0
"""`python -m isoatlas` is the command-line tool."""

import sys

from _isoatlas_tool import main

sys.exit(main())
