"""`python -m fathom.bag.imu`: adds the inertial measurements of a recording to an exported sequence of EuRoC."""

from __future__ import annotations

import argparse
import csv
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.bag import status
from fathom.bag.arguments import read_path
from fathom.bag.errors import BagError
from fathom.bag.poses import find_fixed_transform
from fathom.bag.recording import Recording
from fathom.bag.report import Report
from fathom.bag.topics import require_type
from fathom.messages.errors import MessageError
from fathom.messages.images import read_stamp

IMU = "sensor_msgs/msg/Imu"
_HEAD = (
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]"
)
_NOT_MEASURED = -1
"""First number of the covariance of a quantity that an `Imu` does not have."""


@dataclass(frozen=True)
class Measurements:
    """Angular velocity in rad/s and proper acceleration in m/s² by time, in the axes of a frame."""

    frame_id: str
    samples: dict[int, tuple[float, ...]]

    @property
    def stamps(self) -> list[int]:
        """Times in nanoseconds, ascending."""
        return sorted(self.samples)

    @property
    def rate_hz(self) -> float:
        """Rate of the median time between two samples; 0 for one sample."""
        steps = np.diff(self.stamps)
        return 1e9 / float(np.median(steps)) if steps.size else 0.0


def main(arguments: Sequence[str]) -> int:
    """Run the command and return its exit status."""
    return status.run(run, arguments)


def run(arguments: Sequence[str]) -> int:
    """Write `mav0/imu0` of the sequence and return the exit status."""
    options = _read_arguments(arguments)
    frames = _read_frame_stamps(options.sequence)
    folder = options.sequence / "mav0" / "imu0"
    if folder.exists():
        raise BagError(f"{folder} exists; remove it first")
    report = Report("sample")
    with Recording(options.recording) as recording:
        measured = read_measurements(recording, options.imu, report)
        _check_times(measured, frames, options)
        pose = None
        if options.camera_frame is not None:
            pose = find_fixed_transform(recording, measured.frame_id, options.camera_frame)
        else:
            report.note("note: sensor.yaml has no T_BS; give --camera-frame FRAME to take it from /tf_static")
        _write_sensor(folder, measured, describe_sensor(measured, options.imu, pose))
        report.done = len(measured.samples)
        return status.end(recording, report)


def read_measurements(recording: Recording, topic: str, report: Report) -> Measurements:
    """Return the samples of a topic; those without a use are left out and reported. Raises `BagError`."""
    samples: dict[int, tuple[float, ...]] = {}
    frames: set[str] = set()
    for connection, recorded_ns, data in recording.messages(require_type(recording, "--imu", topic, (IMU,))):
        try:
            message = recording.deserialize(connection, data)
            stamp_ns = read_stamp(message, topic)
        except MessageError as error:
            report.leave_out(recorded_ns, f"{topic}: {error.kind}", str(error))
            continue
        numbers = _read_sample(message, topic)
        if not np.isfinite(numbers).all():
            report.leave_out(stamp_ns, f"{topic}: not finite", f"{topic}: the values are {_list_numbers(numbers)}")
        elif stamp_ns in samples:
            report.leave_out(stamp_ns, f"{topic}: repeated stamp", f"{topic}: `header.stamp` is that of another sample")
        else:
            samples[stamp_ns] = numbers
            frames.add(message.header.frame_id)
    if not samples:
        raise BagError(f"{topic} has no sample; nothing was written")
    if len(frames) > 1:
        raise BagError(f"{topic} has samples of the frames {', '.join(sorted(frames))}; must be one sensor")
    return Measurements(frames.pop(), samples)


def describe_sensor(measured: Measurements, topic: str, pose: NDArray[np.float64] | None) -> str:
    """Return `sensor.yaml`; `pose` is the matrix from the axes of the sensor to those of the camera, the body."""
    lines = [
        f"# {topic}: angular velocity in rad/s and acceleration, with that against gravity, in m/s^2.",
        f"# Axes of the frame {measured.frame_id}. The noise is not known.",
        "sensor_type: imu",
    ]
    if pose is not None:
        listed = ", ".join(repr(float(number)) for number in pose.reshape(-1))
        lines += ["T_BS:", "  cols: 4", "  rows: 4", f"  data: [{listed}]"]
    return "\n".join([*lines, f"rate_hz: {measured.rate_hz!r}", ""])


def _read_sample(message: Any, topic: str) -> tuple[float, ...]:
    for name in ("angular_velocity", "linear_acceleration"):
        if getattr(message, f"{name}_covariance")[0] == _NOT_MEASURED:
            raise BagError(
                f"{topic} has no `{name}`: its covariance begins with -1; give the topic of an IMU with both"
            )
    turn, push = message.angular_velocity, message.linear_acceleration
    return (turn.x, turn.y, turn.z, push.x, push.y, push.z)


def _list_numbers(numbers: Sequence[float]) -> str:
    return ", ".join(f"{number:g}" for number in numbers)


def _read_frame_stamps(sequence: Path) -> list[int]:
    """Return the times of the pictures of a sequence."""
    listed = sequence / "mav0" / "cam0" / "data.csv"
    if not listed.exists():
        raise BagError(f"{listed} does not exist; give a sequence of `fathom export --format euroc`")
    with listed.open() as file:
        return [int(row[0]) for row in csv.reader(file) if row and not row[0].startswith("#")]


def _check_times(measured: Measurements, frames: list[int], options: argparse.Namespace) -> None:
    """Raise `BagError` for pictures of another time: an export without the times of a recording begins at 1 s."""
    first_ns, last_ns = measured.stamps[0], measured.stamps[-1]
    outside = [stamp_ns for stamp_ns in frames if not first_ns <= stamp_ns <= last_ns]
    if len(outside) == len(frames):
        pictures = f"{min(frames, default=0)} to {max(frames, default=0)} ns in {options.sequence}"
        raise BagError(
            f"{options.imu} has samples from {first_ns} to {last_ns} ns, but pictures are from {pictures}; "
            "give the recording that was uploaded"
        )
    if outside:
        print(f"warning: {len(outside)} of {len(frames)} pictures are outside of the samples", file=sys.stderr)


def _write_sensor(folder: Path, measured: Measurements, described: str) -> None:
    """Write the folder under its name when it is complete."""
    # A stopped command may have left its part.
    partial = folder.with_name(f".{folder.name}.part")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir()
    try:
        rows = (",".join([str(at), *map(repr, measured.samples[at])]) for at in measured.stamps)
        (partial / "data.csv").write_text("\n".join([_HEAD, *rows, ""]))
        (partial / "sensor.yaml").write_text(described)
        partial.rename(folder)
    except BaseException:
        shutil.rmtree(partial, ignore_errors=True)
        raise


def _read_arguments(arguments: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m fathom.bag.imu",
        description="Add the inertial measurements of a recording to a sequence of `fathom export --format euroc`.",
        epilog="Exit status: 1 if samples were left out or the recording is cut off, 2 for bad input",
    )
    parser.add_argument("recording", type=read_path, metavar="RECORDING", help="recording that was uploaded")
    parser.add_argument("sequence", type=read_path, metavar="SEQUENCE", help="folder with mav0; mav0/imu0 is added")
    parser.add_argument("--imu", metavar="TOPIC", required=True, help="samples: Imu")
    parser.add_argument("--camera-frame", metavar="FRAME", help="`frame_id` of the pictures, for T_BS from /tf_static")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
