"""The matrix of a camera from `CameraInfo`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.messages.errors import MessageError


def read_camera(message: Any, topic: str, width: int, height: int) -> NDArray[np.float64]:
    """Return K as the `camera` of a `fathom.Stream`, for a picture of this size; raises `MessageError`."""
    if (message.width, message.height) != (width, height):
        size = f"{message.width}×{message.height}"
        raise MessageError(topic, f"the camera is {size} but the image {width}×{height}; both must be equal", "camera")
    for name in ("binning_x", "binning_y"):
        if getattr(message, name) > 1:
            reason = f"`{name}` is {getattr(message, name)}; must be 0 or 1, give the image without binning"
            raise MessageError(topic, reason, "camera")
    # ROS 1 writes the field as a capital letter.
    values = message.k if hasattr(message, "k") else message.K
    matrix = np.asarray(values, dtype=np.float64).reshape(3, 3)
    if not np.isfinite(matrix).all() or matrix[0, 0] <= 0:
        raise MessageError(topic, f"`k` has the focal length {matrix[0, 0]}; must be above 0", "camera")
    return matrix


def is_distorted(message: Any) -> bool:
    """Whether the picture is distorted, which a matrix alone does not describe."""
    return bool(np.any(message.d if hasattr(message, "d") else message.D))
