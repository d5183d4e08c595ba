"""The node: topics, parameters and diagnostics around a `fathom.Stream`."""

from __future__ import annotations

import threading
import time
import traceback
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

from fathom.errors import FathomError
from fathom.messages.cameras import has_distortion
from fathom.messages.pairing import Pair
from fathom.ros.counts import BUSY, FAILED, NO_CAMERA, NO_POSE, Counts
from fathom.ros.description import list_enhancements, list_ignored
from fathom.ros.diagnostics import judge, list_values
from fathom.ros.frames import FrameRenderer, NoCamera, Rendered
from fathom.ros.parameters import Parameters
from fathom.ros.publications import Publications
from fathom.ros.settings import Settings
from fathom.ros.subscriptions import Subscriptions, name_topics
from fathom.ros.transforms import NoPose, Transforms
from fathom.ros.worker import NewestWorker
from fathom.stream import Stream

_REPORT_S = 1.0
"""Time between diagnostics."""
_REPEAT_S = 10.0
"""Time after which the same problem is logged again."""


def run(arguments: list[str]) -> None:
    """Run the node until ROS shuts down; raises `InvalidArgument` and `InvalidJob` for the parameters of its start."""
    rclpy.init(args=arguments)
    try:
        ros = rclpy.create_node(
            "fathom", allow_undeclared_parameters=True, automatically_declare_parameters_from_overrides=True
        )
        node = UnderwaterNode(ros)
        # One thread for a change of parameters, which opens a stream, and one for messages meanwhile.
        executor = MultiThreadedExecutor(num_threads=2)
        executor.add_node(ros)
        try:
            executor.spin()
        except (KeyboardInterrupt, ExternalShutdownException):
            pass
        finally:
            node.stop()
    finally:
        rclpy.try_shutdown()


class UnderwaterNode:
    """Receives pictures, renders them in a thread of its own and publishes the results."""

    def __init__(self, ros: Any) -> None:
        self._ros = ros
        self._log = ros.get_logger()
        self._logging = threading.Lock()
        self._logged: dict[str, float] = {}
        self._last: Rendered | None = None
        self._counts = Counts()
        self._reported = time.monotonic()
        transforms = Transforms()
        self._parameters = Parameters(ros)
        settings = self._parameters.settings
        self._topics = name_topics(ros, settings)
        self._renderer = FrameRenderer(settings, self._parameters.stream, self._topics, transforms)
        self._publications = Publications(ros, settings.qos)
        self._worker = NewestWorker(self._render)
        self._subscriptions = Subscriptions(
            ros, self._topics, self._counts, transforms, self._drop, self._take_pair, self._take_camera_info
        )
        self._diagnostics = ros.create_publisher(DiagnosticArray, "/diagnostics", 10)
        group = MutuallyExclusiveCallbackGroup()
        ros.create_timer(_REPORT_S, self._report, callback_group=group)
        for name in list_ignored(settings):
            self._log.warning(f"`{name}` of {settings.job} changes no picture of a topic and is not used")
        self._apply(settings, self._parameters.description, self._parameters.stream)
        self._parameters.follow(self._apply)

    def stop(self) -> None:
        """End the thread of frames."""
        self._worker.stop()

    def _apply(self, settings: Settings, description: dict[str, Any], stream: Stream) -> None:
        for warning in stream.warnings:
            self._log.warning(warning)
        self._publications.announce(list_enhancements(description, settings.mode))
        self._renderer.replace(settings, stream)
        self._subscriptions.follow(settings)

    def _take_camera_info(self, message: Any) -> None:
        self._renderer.camera_info = message

    def _take_pair(self, pair: Pair[Any, Any]) -> None:
        if self._worker.submit(pair):
            self._counts.drop(BUSY)

    def _render(self, pair: Pair[Any, Any]) -> None:
        settings = self._parameters.settings
        try:
            rendered = self._renderer.render(pair)
            published = self._publications.publish(
                rendered, settings.jpeg_quality, has_picture=settings.mode != "enhance"
            )
        except NoCamera as error:
            self._drop(NO_CAMERA, str(error))
        except NoPose as error:
            self._drop(NO_POSE, str(error))
        except FathomError as error:
            self._drop(FAILED, str(error))
        except Exception:
            # A defect of this node must not end it: the next frame may be fine.
            if rclpy.ok():
                self._drop(FAILED, traceback.format_exc())
        else:
            self._last = rendered
            age_ms = (self._ros.get_clock().now().nanoseconds - pair.stamp_ns) / 1e6
            self._counts.render(rendered.times_ms | published | {"age of the picture": age_ms})

    def _drop(self, reason: str, problem: str) -> None:
        self._counts.drop(reason, problem)
        # Other reasons name the stamp of the picture, which differs each time.
        self._log_sometimes(problem if reason == FAILED else reason, problem)

    def _log_sometimes(self, key: str, problem: str) -> None:
        now = time.monotonic()
        with self._logging:
            if now - self._logged.get(key, -_REPEAT_S) < _REPEAT_S:
                return
            self._logged = {other: at for other, at in self._logged.items() if now - at < _REPEAT_S} | {key: now}
        self._log.error(problem)

    def _report(self) -> None:
        now = time.monotonic()
        report = self._counts.report(now - self._reported)
        self._reported = now
        level, message = judge(report, self._topics)
        last, info, settings = self._last, self._renderer.camera_info, self._parameters.settings
        warnings = list(last.warnings if last else ())
        if info is not None and has_distortion(info) and not settings.rectified:
            warnings.append("camera_info has a distortion, which pictures must not have: rectify them")
        more = {"depths without picture": self._subscriptions.unused_depths, "mode": settings.mode}
        if warnings:
            more["warnings"] = "; ".join(warnings)
        frame = last.frame if last else None
        values = list_values(report, frame.record if frame else None, frame.error_bound if frame else None, more)
        status = DiagnosticStatus(
            level=bytes([level]),
            name=f"{self._ros.get_fully_qualified_name()[1:]}: stream",
            message=message,
            hardware_id=self._topics.image,
            values=[KeyValue(key=key, value=value) for key, value in values],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self._ros.get_clock().now().to_msg()
        self._diagnostics.publish(array)
