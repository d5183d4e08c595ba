"""`fathom bag`: the images of a recording in water."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from fathom.bag.frames import Frame, Frames
from fathom.bag.output import Output
from fathom.bag.recording import Recording
from fathom.bag.report import Report
from fathom.bag.status import end_if_stopped
from fathom.bag.topics import IMAGE, Topics
from fathom.errors import InvalidArgument, RenderError
from fathom.messages.images import write_fields
from fathom.stream import Stream, StreamFrame

ENDING = "/underwater"
"""End of the names of all added topics."""


class Converter:
    """Renders frames and adds them to a recording."""

    def __init__(
        self, stream: Stream, recording: Recording, output: Output, topics: Topics, report: Report, adds_range: bool
    ) -> None:
        """`adds_range` also adds the range along the ray, as the frames have it."""
        self._stream = stream
        self._output = output
        self._topics = topics
        self._report = report
        self._adds_range = adds_range
        self._image_type = recording.message_type(IMAGE)
        self._like = recording.find(topics.image)[0]
        output.add_topic(topics.image + ENDING, IMAGE, self._like)

    def write(self, frame: Frame) -> None:
        """Render a frame and write its results."""
        try:
            out = self._stream(
                frame.picture.rgb,
                z_depth=frame.z_depth,
                camera=frame.camera,
                stamp_ns=frame.stamp_ns,
                pose=frame.pose,
                channels=frame.picture.channels,
            )
        except (InvalidArgument, RenderError) as error:
            end_if_stopped()
            self._report.leave_out(frame.stamp_ns, _remove_numbers(str(error)), str(error))
            return
        for warning in out.warnings:
            self._report.warn(frame.stamp_ns, _remove_numbers(warning), warning)
        for topic, array in self._list_results(out):
            self._add(topic, frame, array)
        self._report.advance()

    def _list_results(self, out: StreamFrame) -> list[tuple[str, NDArray[Any]]]:
        results = [(self._topics.image + ENDING, out.rgb)]
        if self._adds_range and out.range_m is not None and self._topics.depth is not None:
            results.append((self._topics.depth + ENDING, out.range_m))
        for name, picture in out.enhanced.items():
            results.append((f"{self._topics.image}/enhanced/{_make_topic(name)}{ENDING}", picture))
        return results

    def _add(self, topic: str, frame: Frame, array: NDArray[Any]) -> None:
        if not self._output.has_topic(topic):
            self._output.add_topic(topic, IMAGE, self._like)
        message = self._image_type(header=frame.header, **write_fields(array))
        self._output.add(topic, frame.recorded_ns, message)


def convert(
    recording: Recording, output: Path, stream: Stream, topics: Topics, frames: Frames, report: Report, adds_range: bool
) -> bool:
    """Write the recording with the results; return whether there is one, else nothing is left."""
    written = Output(output, recording)
    try:
        written.begin()
        converter = Converter(stream, recording, written, topics, report, adds_range)
        for connection, recorded_ns, data in recording.messages():
            written.copy(connection, recorded_ns, data)
            for frame in frames.add(connection, recorded_ns, data):
                converter.write(frame)
        for frame in frames.finish():
            converter.write(frame)
        end_if_stopped()
    except BaseException:
        written.discard()
        raise
    if report.done == 0:
        written.discard()
        return False
    written.finish()
    return True


def _remove_numbers(text: str) -> str:
    """Return a reason without its numbers, which differ between frames."""
    return re.sub(r"\d+(\.\d+)?", "…", text)


def _make_topic(name: str) -> str:
    """Return a name with the characters that topics may have."""
    return re.sub(r"\W", "_", name, flags=re.ASCII)
