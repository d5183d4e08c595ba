"""The options of commands with recordings."""

from __future__ import annotations

import argparse
from pathlib import Path

from fathom.bag.errors import BagError
from fathom.bag.frames import Frames
from fathom.bag.poses import Poses, TopicPoses, TransformPoses
from fathom.bag.recording import Recording
from fathom.bag.report import Report
from fathom.bag.topics import Topics
from fathom.messages.pairing import SLOP_NS

_MOST_SLOP_S = 1.0


def add_camera_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that select frames."""
    parser.add_argument("--image", metavar="TOPIC", required=True, help="pictures: Image or CompressedImage")
    parser.add_argument(
        "--depth", metavar="TOPIC", help="depths along the optical axis: 32FC1 meters, 16UC1 millimeters"
    )
    parser.add_argument("--camera-info", metavar="TOPIC", help="camera of the pictures [default: that of the job]")
    parser.add_argument("--rectified", action="store_true", help="use P of the camera info, not K")
    parser.add_argument(
        "--slop-s",
        type=float,
        default=SLOP_NS / 1e9,
        metavar="SECONDS",
        help="longest time between a picture and its depth [default: %(default)g]",
    )
    parser.add_argument(
        "--stamps",
        choices=("header", "recorded"),
        default="header",
        help="times of the frames: those of the headers, or of the recording if headers have none [default: header]",
    )
    poses = parser.add_mutually_exclusive_group()
    poses.add_argument(
        "--world", metavar="FRAME", help="poses from /tf: the fixed frame, such as map; its z axis points up"
    )
    poses.add_argument(
        "--pose-topic", metavar="TOPIC", help="poses: PoseStamped, PoseWithCovarianceStamped or Odometry"
    )
    parser.add_argument(
        "--pose-axes",
        choices=("optical", "body"),
        help="axes of --pose-topic: right, down, ahead; or ahead, left, up",
    )


def check_camera_options(options: argparse.Namespace) -> None:
    """Raise `BagError` for values out of range."""
    if not 0 <= options.slop_s <= _MOST_SLOP_S:
        raise BagError(f"--slop-s is {options.slop_s:g}; must be 0 to {_MOST_SLOP_S:g}")
    if (options.pose_topic is None) != (options.pose_axes is None):
        raise BagError("--pose-topic needs --pose-axes optical or body, and --pose-axes a --pose-topic")


def open_frames(options: argparse.Namespace, recording: Recording, report: Report) -> tuple[Topics, Frames]:
    """Return the checked topics and their frames; raises `BagError`."""
    topics = Topics(options.image, options.depth, options.camera_info, options.rectified)
    topics.check(recording)
    for topic in topics.list_unused_camera_info(recording):
        report.note(f"note: {topic} is not used; give --camera-info {topic} for its focal length")
    poses: Poses | None = None
    if options.world is not None:
        poses = TransformPoses(recording, options.world)
    elif options.pose_topic is not None:
        poses = TopicPoses(recording, options.pose_topic, options.pose_axes)
    slop_ns = round(options.slop_s * 1e9)
    return topics, Frames(recording, topics, poses, report, slop_ns, options.stamps)


def read_path(text: str) -> Path:
    """Return the path of an argument."""
    if not text:
        raise argparse.ArgumentTypeError("must be a path")
    return Path(text)
