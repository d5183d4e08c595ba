"""Files of one JSON object a line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np


class Lines:
    """The lines of a file, found by their places so that not all of them are in memory."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with path.open("rb") as file:
            self.ends = np.cumsum([len(line) for line in file if line.endswith(b"\n")], dtype=np.int64)

    def __len__(self) -> int:
        return len(self.ends)

    def __getitem__(self, index: int) -> dict[str, Any]:
        begin = int(self.ends[index - 1]) if index > 0 else 0
        with self.path.open("rb") as file:
            file.seek(begin)
            line: dict[str, Any] = json.loads(file.read(int(self.ends[index]) - begin))
        return line
