"""The command `fathom bag`, and the unpacking that `fathom upload` starts."""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Sequence

from fathom.bag import status, unpack
from fathom.bag.arguments import add_camera_options, check_camera_options, open_frames, read_path
from fathom.bag.convert import convert
from fathom.bag.errors import BagError
from fathom.bag.recording import Recording
from fathom.bag.report import Report
from fathom.errors import FathomError
from fathom.stream import Stream

_UNPACK = "--unpack"


def main(arguments: Sequence[str]) -> int:
    """Run the command and return its exit status."""
    if arguments[:1] == [_UNPACK]:
        return status.run(unpack.run, arguments[1:])
    return status.run(run, arguments)


def run(arguments: Sequence[str]) -> int:
    """Convert a recording and return the exit status."""
    options = _read_arguments(arguments)
    check_camera_options(options)
    report = Report()
    stream = _open_stream(options, report)
    with Recording(options.recording) as recording:
        topics, frames = open_frames(options, recording, report)
        if not convert(recording, options.out, stream, topics, frames, report, options.range):
            report.summarize()
            raise BagError(f"no frame of {options.image} could be converted; nothing was written")
        return status.end(recording, report)


def _open_stream(options: argparse.Namespace, report: Report) -> Stream:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            stream = Stream(options.job, vary=options.vary, styles=options.styles, onnxruntime=options.onnxruntime)
        except OSError as error:
            raise BagError(f"{options.job}: {error.strerror}") from None
        except FathomError:
            raise
        except ValueError as error:
            raise BagError(str(error)) from None
    for warning in caught:
        report.note(f"warning: {warning.message}")
    return stream


def _read_arguments(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="fathom bag",
        description="Put the images of a recording into water. Other topics are copied.",
        epilog="Exit status: 1 if frames were left out or the recording is cut off, 2 for bad input, 4 without rosbags",
    )
    parser.add_argument("recording", type=read_path, metavar="IN", help=".bag, .mcap, .db3, or a folder of ROS 2")
    parser.add_argument("out", type=read_path, metavar="OUT", help="recording to write; its name states its kind")
    parser.add_argument("--job", type=read_path, metavar="FILE", required=True, help="job as JSON; it needs no scene")
    add_camera_options(parser)
    parser.add_argument("--range", action="store_true", help="also add the range along the ray, as DEPTH/underwater")
    parser.add_argument(
        "--vary",
        choices=("stream", "frame"),
        default="stream",
        help="draw random values of the job once, or for each frame [default: stream]",
    )
    parser.add_argument("--styles", metavar="FOLDER", help="styles of the job")
    parser.add_argument("--onnxruntime", metavar="FILE", help="library file of ONNX Runtime for networks")
    return parser.parse_args(arguments)
