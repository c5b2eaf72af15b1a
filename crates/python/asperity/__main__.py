"""The program ``asperity``, as ``python -m asperity`` and as a command."""

from __future__ import annotations

import signal
import sys

from asperity import _core


def main() -> int:
    """Runs the program with the arguments of the process, and returns its exit code."""
    # Interrupts are the program's own to handle
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _core.main(["asperity", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
