"""The subscribed topics of the node, and the pairs of their messages."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import Any

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from fathom.errors import InvalidArgument
from fathom.messages.errors import MessageError
from fathom.messages.images import read_stamp
from fathom.messages.pairing import Pair, Pairing
from fathom.ros.counts import FAILED, NO_DEPTH, Counts
from fathom.ros.diagnostics import Topics
from fathom.ros.quality import make_latched_quality, make_quality, make_transform_quality
from fathom.ros.settings import Settings
from fathom.ros.transforms import Transforms

_SUFFIXES = {"image": "/compressed", "depth": "/compressedDepth"}


def name_topics(node: Any, settings: Settings) -> Topics:
    """Return the full names of the topics after remapping, with the suffixes of the transports."""
    names = {name: str(node.resolve_topic_name(name)) for name in ("image", "depth", "camera_info")}
    for name, transport in (("image", settings.image_transport), ("depth", settings.depth_transport)):
        if transport == "compressed":
            names[name] += _SUFFIXES[name]
    return Topics(**names)


class Subscriptions:
    """Receives messages in one thread at a time and passes on complete pairs."""

    def __init__(
        self,
        node: Any,
        topics: Topics,
        counts: Counts,
        transforms: Transforms,
        drop: Callable[[str, str], None],
        take_pair: Callable[[Pair[Any, Any]], None],
        take_camera_info: Callable[[Any], None],
    ) -> None:
        self._node, self._topics, self._counts, self._transforms = node, topics, counts, transforms
        self._drop, self._take_pair, self._take_camera_info = drop, take_pair, take_camera_info
        self._lock = threading.Lock()
        self._group = MutuallyExclusiveCallbackGroup()
        self._settings: Settings | None = None
        self._pairing: Pairing[Any, Any] = Pairing()
        self._subscribed: dict[str, list[Any]] = {}

    @property
    def unused_depths(self) -> int:
        """Number of depths without a picture since the pairing began."""
        return self._pairing.unused_depths

    def follow(self, settings: Settings) -> None:
        """Subscribe the topics that the settings need, and no others."""
        before, self._settings = self._settings, settings
        if before is None or (before.slop_s, before.depth_wait_s) != (settings.slop_s, settings.depth_wait_s):
            fresh: Pairing[Any, Any] = Pairing(round(settings.slop_s * 1e9), round(settings.depth_wait_s * 1e9))
            with self._lock:
                pairs, self._pairing = self._pairing.flush(), fresh
            self._pass_on(pairs)
        needed = {
            "image": self._subscribe_image,
            "depth": self._subscribe_depth if settings.needs_depth else None,
            "camera_info": self._subscribe_camera_info if settings.use_camera_info else None,
            "tf": self._subscribe_transforms if settings.world_frame else None,
        }
        for name, subscribe in needed.items():
            if subscribe and name not in self._subscribed:
                self._subscribed[name] = list(subscribe(settings))
            elif not subscribe and name in self._subscribed:
                for subscription in self._subscribed.pop(name):
                    self._node.destroy_subscription(subscription)

    def _subscribe(self, kind: Any, topic: str, take: Callable[[Any], None], quality: Any) -> Any:
        return self._node.create_subscription(kind, topic, take, quality, callback_group=self._group)

    def _subscribe_image(self, settings: Settings) -> Iterable[Any]:
        kind = Image if settings.image_transport == "raw" else CompressedImage
        yield self._subscribe(kind, self._topics.image, self._take_image, make_quality(settings.qos))

    def _subscribe_depth(self, settings: Settings) -> Iterable[Any]:
        kind = Image if settings.depth_transport == "raw" else CompressedImage
        yield self._subscribe(kind, self._topics.depth, self._take_depth, make_quality(settings.qos))

    def _subscribe_camera_info(self, settings: Settings) -> Iterable[Any]:
        quality = make_quality(settings.qos)
        yield self._subscribe(CameraInfo, self._topics.camera_info, self._take_camera_info, quality)

    def _subscribe_transforms(self, _: Settings) -> Iterable[Any]:
        kind = import_transforms()
        yield self._subscribe(kind, "/tf", self._transforms.add, make_transform_quality())
        yield self._subscribe(kind, "/tf_static", self._transforms.add_static, make_latched_quality())

    def _take_image(self, message: Any) -> None:
        assert self._settings is not None
        self._counts.receive()
        stamp_ns = self._read_stamp(message, self._topics.image)
        if stamp_ns is None:
            return
        if not self._settings.needs_depth:
            self._take_pair(Pair(stamp_ns, message, None, None))
            return
        with self._lock:
            pairs = self._pairing.add_image(stamp_ns, message)
        self._pass_on(pairs)

    def _take_depth(self, message: Any) -> None:
        stamp_ns = self._read_stamp(message, self._topics.depth)
        if stamp_ns is None:
            return
        with self._lock:
            before = self._pairing.late_depths
            pairs = self._pairing.add_depth(stamp_ns, message)
            is_late = self._pairing.late_depths > before
        if is_late:
            self._counts.add_late_depth()
        self._pass_on(pairs)

    def _read_stamp(self, message: Any, topic: str) -> int | None:
        try:
            return read_stamp(message, topic)
        except MessageError as error:
            self._drop(FAILED, str(error))
            return None

    def _pass_on(self, pairs: list[Pair[Any, Any]]) -> None:
        for pair in pairs:
            if pair.depth is not None:
                self._take_pair(pair)
                continue
            self._drop(NO_DEPTH, f"no depth for the picture at {pair.stamp_ns / 1e9:.3f} s{_describe(pair.offset_ns)}")


def _describe(offset_ns: int | None) -> str:
    """Return how far the nearest depth is from a picture."""
    if offset_ns is None:
        return ""
    return f"; the nearest depth is {abs(offset_ns) / 1e9:.3f} s {'later' if offset_ns > 0 else 'earlier'}"


def import_transforms() -> Any:
    """Return the type of the messages on `/tf`; raises `InvalidArgument` without its package."""
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError:
        raise InvalidArgument(
            "`world_frame` needs the package tf2_msgs of ROS; install it or leave out the frame"
        ) from None
    return TFMessage
