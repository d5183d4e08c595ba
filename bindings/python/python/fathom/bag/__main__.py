"""`python -m fathom.bag`: puts the images of a recording into water."""

from __future__ import annotations

import importlib.util
import sys

_MISSING = "recordings need the Python library rosbags; install it with: pip install 'fathom-datasets[bag]'"
_RUNTIME_MISSING = 4


def main() -> int:
    """Run the command and return its exit status."""
    if importlib.util.find_spec("rosbags") is None:
        print(f"fathom: {_MISSING}", file=sys.stderr)
        return _RUNTIME_MISSING
    from fathom.bag import command

    return command.main(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
