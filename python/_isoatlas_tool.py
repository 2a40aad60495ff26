# SPDX-License-Identifier: Apache-2.0
"""The console script `isoatlas`: runs the command-line tool of the package in place of Python.

It is not in the package, because `import isoatlas` also imports numpy, which takes longer than most
commands.
"""

import os
import signal
import sys

TOOL = os.path.join(os.path.dirname(os.path.abspath(__file__)), "isoatlas/_tool/bin/isoatlas")


def main() -> int:
    """Run the tool. If it is missing, return the exit status for an invalid argument."""
    if not os.path.isfile(TOOL):
        print(
            f"isoatlas: error: {TOOL}: there is no such file: this Python module was built without "
            "the command-line tool (ISOATLAS_BUILD_TOOL)",
            file=sys.stderr,
        )
        return 2
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # Python ignores it, and the tool would, too
    os.execv(TOOL, ["isoatlas", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
