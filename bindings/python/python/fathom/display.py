"""Small HTML and pictures for notebooks."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom import _native

LARGEST_PX = 480
"""Longer side of a picture in a notebook."""
LONGEST_TEXT = 400
"""Most characters of a cell."""


def html_table(title: str, rows: Mapping[str, object], *, png: bytes | None = None) -> str:
    """Return a table of names and values under a title, all escaped, below a picture if there is one."""
    shown = {name: str(value) for name, value in rows.items() if value not in (None, "")}
    cells = "".join(
        f'<tr><th style="text-align:left">{escape(name)}</th><td style="text-align:left">{_shorten(value)}</td></tr>'
        for name, value in shown.items()
    )
    picture = f'<img alt="" src="data:image/png;base64,{base64.b64encode(png).decode()}">' if png else ""
    return f"<div>{picture}<table><caption>{escape(title)}</caption>{cells}</table></div>"


def html_rows(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table of rows below the names of their columns and a title, all escaped."""
    head = "".join(f'<th style="text-align:left">{_shorten(name)}</th>' for name in columns)
    body = "".join(f"<tr>{''.join(_html_cell(value) for value in row)}</tr>" for row in rows)
    return f"<div><table><caption>{escape(title)}</caption><tr>{head}</tr>{body}</table></div>"


def encode_thumbnail(image: NDArray[Any]) -> bytes:
    """Return the PNG of a picture, averaged over blocks of pixels until it fits `LARGEST_PX`."""
    factor = -(-max(image.shape[:2]) // LARGEST_PX)
    if factor > 1:
        height, width = (side // factor * factor for side in image.shape[:2])
        if min(height, width) > 0:
            blocks = image[:height, :width].reshape(height // factor, factor, width // factor, factor, -1)
            image = blocks.mean(axis=(1, 3)).round().astype(image.dtype).squeeze()
    return _native.encode_png(np.ascontiguousarray(image))


def _html_cell(value: object) -> str:
    """Return the cell of a value: numbers at the right, absent values empty."""
    if isinstance(value, float):
        return f'<td style="text-align:right">{value:.4g}</td>'
    side = "right" if isinstance(value, int) and not isinstance(value, bool) else "left"
    return f'<td style="text-align:{side}">{"" if value is None else _shorten(str(value))}</td>'


def _shorten(text: str) -> str:
    return escape(text if len(text) <= LONGEST_TEXT else f"{text[: LONGEST_TEXT - 1]}…")
