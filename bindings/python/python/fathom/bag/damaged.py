"""Readers of damaged recordings: every message before the first damage."""

from __future__ import annotations

from pathlib import Path

from fathom.bag.damaged_mcap import DamagedMcap
from fathom.bag.damaged_ros1 import DamagedRos1
from fathom.bag.damaged_sqlite import DamagedSqlite
from fathom.bag.errors import BagError


def open_damaged(path: Path) -> DamagedMcap | DamagedSqlite | DamagedRos1:
    """Open what is left of a file; raises `BagError` for one that is compressed as a whole."""
    if path.name.endswith(".zstd"):
        raise BagError(f"{path} is compressed and its recording damaged; unpack it with `unzstd` first")
    if path.suffix == ".mcap":
        return DamagedMcap(path)
    return DamagedSqlite(path) if path.suffix == ".db3" else DamagedRos1(path)
