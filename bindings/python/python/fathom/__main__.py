"""`python -m fathom`: the commands of the `fathom` binary."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from fathom import _native


def main() -> int:
    """Run the command that the process was given and return its exit status."""
    # What a command starts are commands again; the script runs them with this interpreter.
    os.environ["FATHOM_PYTHON"] = sys.executable
    os.environ["FATHOM_PROGRAM"] = str(Path(__file__).with_name("program.sh"))
    # Python would only note the signal until the command returns.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _native.run(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
