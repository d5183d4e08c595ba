"""`python -m fathom.cluster`: the commands of the `fathom-cluster` binary, which those of `fathom` start for sets."""

import sys

from fathom import _native
from fathom.__main__ import enter

if __name__ == "__main__":
    sys.exit(enter(_native.run_cluster))
