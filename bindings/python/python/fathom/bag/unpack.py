"""The frames of a recording as a folder that `fathom upload` reads.

The folder has the layout of nerfstudio: pictures and depths by stamp, and `transforms.json` with cameras and poses.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.bag.arguments import add_camera_options, check_camera_options, open_frames, read_path
from fathom.bag.errors import BagError
from fathom.bag.frames import Frame
from fathom.bag.recording import Recording
from fathom.bag.report import Report
from fathom.bag.status import end
from fathom.messages.images import Picture

_OPTICAL_FROM_VIEW = np.diag([1.0, -1.0, -1.0, 1.0])
"""From axes right, up, back, as `transforms.json` has them, to right, down, ahead."""
_HALF_PIXEL = 0.5
"""Position of the middle of the first pixel in `transforms.json`."""


def run(arguments: Sequence[str]) -> int:
    """Write the folder and return the exit status."""
    options = _read_arguments(arguments)
    check_camera_options(options)
    if options.every < 1:
        raise BagError(f"--every is {options.every}; must be 1 or more")
    report, listed = Report(), list[dict[str, Any]]()
    with Recording(options.recording) as recording:
        _, frames = open_frames(options, recording, report)
        options.folder.mkdir(parents=True, exist_ok=True)
        count = 0
        for connection, recorded_ns, data in recording.messages():
            for frame in frames.add(connection, recorded_ns, data):
                count = _write_some(frame, options, count, listed, report)
        for frame in frames.finish():
            count = _write_some(frame, options, count, listed, report)
        if not listed:
            report.summarize()
            raise BagError(f"no frame of {options.image} could be read; nothing was uploaded")
        (options.folder / "transforms.json").write_text(json.dumps({"frames": listed}))
        return end(recording, report)


def _write_some(
    frame: Frame, options: argparse.Namespace, count: int, listed: list[dict[str, Any]], report: Report
) -> int:
    """Write every n-th frame; return the count of all."""
    if count % options.every == 0:
        listed.append(_write_frame(frame, options.folder))
        report.advance()
    return count + 1


def _write_frame(frame: Frame, folder: Path) -> dict[str, Any]:
    """Write a picture with its depth and return its entry."""
    name = _name_frame(frame.stamp_ns)
    rgb = _order_channels(frame.picture)
    entry: dict[str, Any] = {"file_path": f"{name}.png"}
    (folder / entry["file_path"]).write_bytes(_native.encode_png(rgb))
    if frame.z_depth is not None:
        entry["depth_file_path"] = f"{name}.depth.npy"
        np.save(folder / entry["depth_file_path"], _to_millimeters(frame.z_depth))
    if frame.camera is not None:
        (fx, _, cx), (_, fy, cy) = frame.camera[:2].tolist()
        entry |= {"fl_x": fx, "fl_y": fy, "cx": cx + _HALF_PIXEL, "cy": cy + _HALF_PIXEL}
        entry |= {"w": rgb.shape[1], "h": rgb.shape[0]}
    if frame.pose is not None:
        entry["transform_matrix"] = (frame.pose @ _OPTICAL_FROM_VIEW).tolist()
    return entry


def _name_frame(stamp_ns: int) -> str:
    """Return the time in seconds with as many digits for each time, so that names sort by time."""
    return f"{stamp_ns // 1_000_000_000:010d}.{stamp_ns % 1_000_000_000:09d}"


def _order_channels(picture: Picture) -> NDArray[np.uint8]:
    """Return the picture as red, green and blue, or gray."""
    if picture.channels == "mono":
        return np.ascontiguousarray(picture.rgb)
    order = [0, 1, 2] if picture.channels.startswith("rgb") else [2, 1, 0]
    return np.ascontiguousarray(picture.rgb[:, :, order])


def _to_millimeters(depth: NDArray[Any]) -> NDArray[Any]:
    """Return millimeters, 0 without a distance."""
    if depth.dtype == np.uint16:
        return np.ascontiguousarray(depth)
    with np.errstate(invalid="ignore"):
        millimeters: NDArray[Any] = np.where(np.isfinite(depth) & (depth > 0), depth * np.float32(1000), np.float32(0))
    return millimeters


def _read_arguments(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="fathom upload", description="Write the frames of a recording into a folder.")
    parser.add_argument("recording", type=read_path)
    parser.add_argument("folder", type=read_path)
    parser.add_argument("--every", type=int, default=1, metavar="COUNT", help="use one of so many frames")
    add_camera_options(parser)
    return parser.parse_args(arguments)
