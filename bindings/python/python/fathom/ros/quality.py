"""Quality of service of topics."""

from __future__ import annotations

from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

_QUEUED = {"sensor_data": 5, "reliable": 10}
"""Messages that wait while the process is busy, as in the profiles of ROS with these names.

The middleware keeps the memory of the largest queue of each topic there ever was.
"""
_QUEUED_TRANSFORMS = 100
"""As tf2 has it: many small messages."""


def make_quality(name: str) -> Any:
    """Return the quality of pictures and depths: `sensor_data`, which may lose messages, or `reliable`."""
    reliability = ReliabilityPolicy.RELIABLE if name == "reliable" else ReliabilityPolicy.BEST_EFFORT
    return _make_profile(_QUEUED[name], reliability, DurabilityPolicy.VOLATILE)


def make_transform_quality() -> Any:
    """Return the quality of `/tf`."""
    return _make_profile(_QUEUED_TRANSFORMS, ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)


def make_latched_quality() -> Any:
    """Return the quality of `/tf_static`: reliable, and kept for subscribers that come later."""
    return _make_profile(_QUEUED_TRANSFORMS, ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL)


def _make_profile(depth: int, reliability: Any, durability: Any) -> Any:
    return QoSProfile(depth=depth, history=HistoryPolicy.KEEP_LAST, reliability=reliability, durability=durability)
