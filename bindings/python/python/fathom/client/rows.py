"""Rows of a query."""

from __future__ import annotations

import importlib
from typing import Any, SupportsIndex, overload

from fathom.display import html_rows
from fathom.errors import MissingPackage

USUAL_COLUMNS = ("dataset", "frame", "site", "scene.family", "water.optics", "water.style", "alpha", "uiqm", "uciqe")
"""Columns of images that a notebook shows, as far as the rows have them."""
MOST_ROWS = 20
"""Rows that a notebook shows."""
MOST_COLUMNS = 12
"""Columns that a notebook shows of rows that are no images."""
MOST_NAMED = 6
"""Columns that a `repr` names."""


class Rows(list[dict[str, Any]]):
    """Images, one dictionary of columns each; also datasets, statistics and other rows of a service."""

    def __repr__(self) -> str:
        columns = self.columns
        more = f" and {len(columns) - MOST_NAMED} more" if len(columns) > MOST_NAMED else ""
        names = f" with {', '.join(columns[:MOST_NAMED])}{more}" if columns else ""
        return f"<fathom.Rows: {len(self)} row{'' if len(self) == 1 else 's'}{names}>"

    def _repr_html_(self) -> str:
        columns = self.columns
        usual = [name for name in USUAL_COLUMNS if name in columns]
        shown = usual if "frame" in columns and len(columns) > MOST_COLUMNS else columns[:MOST_COLUMNS]
        title = f"{len(self)} row{'' if len(self) == 1 else 's'}"
        if len(self) > MOST_ROWS:
            title += f", the first {MOST_ROWS} shown"
        if len(shown) < len(columns):
            title += f"; {len(shown)} of {len(columns)} columns"
        return html_rows(title, shown, [[row.get(name) for name in shown] for row in self[:MOST_ROWS]])

    @overload
    def __getitem__(self, index: SupportsIndex) -> dict[str, Any]: ...

    @overload
    def __getitem__(self, index: slice) -> Rows: ...

    def __getitem__(self, index: SupportsIndex | slice) -> dict[str, Any] | Rows:
        if isinstance(index, slice):
            return Rows(super().__getitem__(index))
        return super().__getitem__(index)

    @property
    def columns(self) -> list[str]:
        """The columns that any row has, the identifying and usual ones first."""
        there = dict.fromkeys(name for row in self for name in row)
        first = [name for name in ("job", *USUAL_COLUMNS) if name in there]
        return first + [name for name in there if name not in first]

    def to_pandas(self) -> Any:
        """Return a `pandas.DataFrame`; needs pandas."""
        return _import("pandas").DataFrame(list(self))

    def to_arrow(self) -> Any:
        """Return a `pyarrow.Table`; needs pyarrow."""
        return _import("pyarrow").Table.from_pylist(list(self))


def _import(name: str) -> Any:
    """Return a package. Raises `MissingPackage`."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        raise MissingPackage(f"the table needs {name}, which is not installed; run: pip install {name}") from error
