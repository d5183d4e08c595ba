"""Enhancement and measurement of user pictures."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.arguments import list_names

USUAL_METRICS = ("entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe")
"""Default metrics."""


def enhance(image: NDArray[Any], method: str, *, mask: bool = True) -> NDArray[np.uint8]:
    """Enhance a picture.

    `image` holds sRGB codes, uint8 or uint16, of shape (H, W) or (H, W, 3). `method` is one of hscm, clahe, grey_world,
    ulap, suir, ibla, ibla_guided, rd, rghs; `mask=False` leaves out the circular mask of hscm. Returns
    uint8 of the same H and W. A picture on which the method is known to fail comes with a warning.
    """
    result, messages = _native.enhance(image, method, mask)
    for message in messages:
        warnings.warn(f"{method}: {message}", stacklevel=2)
    return result


def measure(
    image: NDArray[Any], metrics: Sequence[str] = USUAL_METRICS, *, clean: NDArray[Any] | None = None
) -> dict[str, float]:
    """Measure the quality of a picture.

    `image` holds sRGB codes, uint8 or uint16, of shape (H, W) or (H, W, 3); `metrics` are names such as uiqm or
    uiqm@table1; `clean` is the picture that psnr and ssim compare with. Returns the values by name.
    """
    return dict(_native.measure(image, list(list_names("metrics", metrics)), clean))
