"""Poses as numbers: the translation x, y, z and the quaternion x, y, z, w."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = tuple[float, ...]


def read_numbers(translation: Any, rotation: Any) -> Numbers:
    """Return the seven numbers of two messages."""
    return (translation.x, translation.y, translation.z, rotation.x, rotation.y, rotation.z, rotation.w)


def interpolate(first: Numbers, second: Numbers, share: float) -> Numbers:
    """Interpolate translations linearly and rotations on the sphere, from `share` 0 for the first to 1."""
    begin, end = np.array(first), np.array(second)
    moved = begin[:3] + share * (end[:3] - begin[:3])
    cosine = float(begin[3:] @ end[3:])
    if cosine < 0:
        end[3:], cosine = -end[3:], -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-6:
        turned = begin[3:] + share * (end[3:] - begin[3:])
    else:
        turned = (np.sin((1 - share) * angle) * begin[3:] + np.sin(share * angle) * end[3:]) / np.sin(angle)
    return (*moved.tolist(), *turned.tolist())


def make_matrix(numbers: Numbers) -> NDArray[np.float64]:
    """Return the 4×4 matrix; the quaternion may have any length above 0."""
    x, y, z, w = np.array(numbers[3:]) / (np.linalg.norm(numbers[3:]) or 1.0)
    matrix: NDArray[np.float64] = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = numbers[:3]
    return matrix
