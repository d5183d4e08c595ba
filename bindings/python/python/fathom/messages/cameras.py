"""The camera of a picture from `sensor_msgs/CameraInfo`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.messages.errors import MessageError


def read_camera(message: Any, size: tuple[int, int], topic: str, *, rectified: bool) -> NDArray[np.float64]:
    """Return the matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] of pictures of this width and height.

    It is K of the message, P for `rectified` pictures, moved and scaled by its region of interest and binning. Raises
    `MessageError` if the message belongs to pictures of another size or has no focal length.
    """
    name, columns = ("p", 4) if rectified else ("k", 3)
    matrix: NDArray[np.float64] = np.array(_get(message, name), np.float64).reshape(3, columns)[:, :3].copy()
    focal = matrix[0, 0], matrix[1, 1]
    if not (np.isfinite(matrix).all() and min(focal) > 0):
        reason = f"`{name}` has the focal lengths {focal[0]:g} and {focal[1]:g} px; must be above 0"
        raise MessageError(topic, f"{reason}; calibrate the camera or do not use its camera_info", "camera")
    roi = message.roi
    binning = max(int(message.binning_x), 1), max(int(message.binning_y), 1)
    full = int(roi.width) or int(message.width), int(roi.height) or int(message.height)
    described = full[0] // binning[0], full[1] // binning[1]
    if described != size:
        reason = f"describes pictures of {described[0]}×{described[1]}, but they are {size[0]}×{size[1]}"
        raise MessageError(topic, f"{reason}; give the camera_info of the same camera", "camera")
    for row, (offset, step) in enumerate(zip((roi.x_offset, roi.y_offset), binning, strict=True)):
        # Centers of binned pixels: (x + 1/2) / step - 1/2.
        matrix[row, 2] = (matrix[row, 2] - offset + 0.5) / step - 0.5
        matrix[row, :2] /= step
    return matrix


def has_distortion(message: Any) -> bool:
    """Whether the lens of the message is distorted."""
    return any(float(coefficient) != 0 for coefficient in _get(message, "d"))


def _get(message: Any, name: str) -> Any:
    """Return a field, which ROS 1 writes as a capital letter."""
    return getattr(message, name) if hasattr(message, name) else getattr(message, name.upper())
