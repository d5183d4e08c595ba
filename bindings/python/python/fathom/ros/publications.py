"""The published topics of the node."""

from __future__ import annotations

import array
import io
import time
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from fathom.messages.images import write_fields
from fathom.ros.frames import Rendered
from fathom.ros.quality import make_quality


class Publications:
    """Publishes rendered pictures. Arrays are only converted for topics with subscribers."""

    def __init__(self, node: Any, quality: str) -> None:
        self._node = node
        self._quality = make_quality(quality)
        self._image = self._create(Image, "~/image")
        self._compressed = self._create(CompressedImage, "~/image/compressed")
        self._range = self._create(Image, "~/range")
        self._camera_info = self._create(CameraInfo, "~/camera_info")
        self._enhanced: dict[str, Any] = {}

    def _create(self, kind: Any, topic: str) -> Any:
        return self._node.create_publisher(kind, topic, self._quality)

    def announce(self, enhancements: Iterable[str]) -> None:
        """Create the topics of enhancements before their first picture, and remove those of other ones."""
        names = set(enhancements)
        for name in names - self._enhanced.keys():
            self._enhanced[name] = self._create(Image, f"~/enhanced/{_name_topic(name)}")
        for name in self._enhanced.keys() - names:
            self._node.destroy_publisher(self._enhanced.pop(name))

    def publish(self, rendered: Rendered, jpeg_quality: int, *, has_picture: bool) -> dict[str, float]:
        """Publish a picture and return the times of conversion and transport in ms.

        `has_picture`: whether the picture itself is published, not only its enhancements.
        """
        frame, header = rendered.frame, rendered.header
        arrays: list[tuple[Any, NDArray[Any]]] = [(self._image, frame.rgb)] if has_picture else []
        if frame.range_m is not None:
            arrays.append((self._range, frame.range_m))
        for name, picture in frame.enhanced.items():
            if name not in self._enhanced:
                self._enhanced[name] = self._create(Image, f"~/enhanced/{_name_topic(name)}")
            arrays.append((self._enhanced[name], picture))
        begun, worked = time.perf_counter(), time.thread_time()
        messages = [(topic, _make_image(header, pixels)) for topic, pixels in arrays if _has_subscribers(topic)]
        if has_picture and _has_subscribers(self._compressed):
            messages.append((self._compressed, _make_compressed(header, frame.rgb, jpeg_quality)))
        if rendered.camera_info is not None:
            messages.append((self._camera_info, _move_stamp(header, rendered.camera_info)))
        converted, convert_cpu = time.perf_counter(), time.thread_time() - worked
        worked = time.thread_time()
        for topic, message in messages:
            topic.publish(message)
        return {
            "writing": 1e3 * (converted - begun),
            "writing CPU": 1e3 * convert_cpu,
            "publication": 1e3 * (time.perf_counter() - converted),
            "publication CPU": 1e3 * (time.thread_time() - worked),
        }


def _has_subscribers(topic: Any) -> bool:
    return bool(topic.get_subscription_count() > 0)


def _name_topic(name: str) -> str:
    """Return the name of an enhancement as ROS allows it in topics."""
    return name.replace("-", "_")


def _make_image(header: Any, pixels: NDArray[Any]) -> Any:
    fields = write_fields(pixels)
    data = array.array("B")
    data.frombytes(fields.pop("data"))
    return Image(header=header, data=data, **fields)


def _make_compressed(header: Any, rgb: NDArray[Any], quality: int) -> Any:
    codes = rgb if rgb.dtype == np.uint8 else (rgb >> 8).astype(np.uint8)
    file = io.BytesIO()
    PillowImage.fromarray(codes).save(file, "JPEG", quality=quality)
    data = array.array("B")
    data.frombytes(file.getvalue())
    return CompressedImage(header=header, format="rgb8; jpeg compressed bgr8", data=data)


def _move_stamp(header: Any, info: Any) -> Any:
    """Return the camera_info with the stamp of the picture."""
    fields = {name: getattr(info, name) for name in info.get_fields_and_field_types()}
    return CameraInfo(**(fields | {"header": header}))
