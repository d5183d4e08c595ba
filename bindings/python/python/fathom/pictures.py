"""Enhancement and measurement of user pictures."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.arguments import list_names, list_paths

USUAL_METRICS = ("entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe")
"""Default metrics."""


def enhance(
    image: NDArray[Any],
    method: str | Mapping[str, Any],
    *,
    styles: str | os.PathLike[str] | None = None,
    onnxruntime: str | os.PathLike[str] | None = None,
) -> NDArray[np.uint8]:
    """Enhance a picture.

    `image` holds sRGB codes, uint8 or uint16, of shape (H, W) or (H, W, 3). `method` is an enhancement as in a job: the
    name of a method such as "hscm" (`fathom list enhancements` describes all), one with parameters such as
    "hscm:cutoff=16,mask=paper" or {"method": "hscm", "cutoff": 16}, or a chain,
    {"name": "mine", "steps": [{"gray_world": {}}, {"clahe": {"clip": 3}}]}. Returns uint8 of the same H and W. A
    picture on which a method is known to fail comes with a warning.

    {"method": "onnx", "model": NAME} runs NAME.onnx of the folder `styles`, whose NAME.card.json has the role
    "enhancer"; `onnxruntime` is the library file of ONNX Runtime. The networks of the last folder stay loaded.
    """
    text = method if isinstance(method, str) else json.dumps(method)
    result, messages = _native.enhance(image, text, *list_paths(styles, onnxruntime))
    for message in messages:
        warnings.warn(f"{text}: {message}", stacklevel=2)
    return result


def measure(
    image: NDArray[Any],
    metrics: Sequence[str] = USUAL_METRICS,
    *,
    clean: NDArray[Any] | None = None,
    styles: str | os.PathLike[str] | None = None,
    onnxruntime: str | os.PathLike[str] | None = None,
) -> dict[str, float]:
    """Measure the quality of a picture.

    `image` holds sRGB codes, uint8 or uint16, of shape (H, W) or (H, W, 3); `metrics` are names such as uiqm or
    uiqm@table1; `clean` is the picture that psnr and ssim compare with. net.NAME is the network NAME.onnx of the
    folder `styles`, whose NAME.card.json has the role "metric"; `onnxruntime` is the library file of ONNX Runtime.
    Returns the values by name.
    """
    names = list(list_names("metrics", metrics))
    return dict(_native.measure(image, names, clean, *list_paths(styles, onnxruntime)))
