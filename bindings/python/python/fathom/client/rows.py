"""Rows of a query."""

from __future__ import annotations

from typing import Any


class Rows(list[dict[str, Any]]):
    """Images, one dictionary of columns each."""

    def to_pandas(self) -> Any:
        """Return a `pandas.DataFrame`; needs pandas."""
        import pandas

        return pandas.DataFrame(list(self))

    def to_arrow(self) -> Any:
        """Return a `pyarrow.Table`; needs pyarrow."""
        import pyarrow

        return pyarrow.Table.from_pylist(list(self))
