"""Quality of service of topics."""

from __future__ import annotations

from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

_QUEUED = 10
"""Messages that wait while the process is busy."""


def make_quality(name: str) -> Any:
    """Return the quality of pictures and depths: `sensor_data`, which may lose messages, or `reliable`."""
    reliability = ReliabilityPolicy.RELIABLE if name == "reliable" else ReliabilityPolicy.BEST_EFFORT
    return QoSProfile(
        depth=_QUEUED, history=HistoryPolicy.KEEP_LAST, reliability=reliability, durability=DurabilityPolicy.VOLATILE
    )


def make_latched_quality() -> Any:
    """Return the quality of `/tf_static`: reliable, and kept for subscribers that come later."""
    return QoSProfile(
        depth=100,
        history=HistoryPolicy.KEEP_LAST,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )
