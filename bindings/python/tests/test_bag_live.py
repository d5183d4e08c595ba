"""A recording and a live node render the same messages to the same bytes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import fathom
import pytest

rosbags = pytest.importorskip("rosbags", reason="rosbags is not installed: recordings are not tested")

from fathom.bag import command  # noqa: E402
from fathom.bag.recording import Recording  # noqa: E402
from fathom.messages.images import read_stamp  # noqa: E402
from fathom.messages.pairing import Pair, Pairing  # noqa: E402
from fathom.ros.diagnostics import Topics  # noqa: E402
from fathom.ros.frames import FrameRenderer  # noqa: E402
from fathom.ros.settings import read_settings  # noqa: E402
from fathom.ros.transforms import Transforms  # noqa: E402
from recordings import DEPTH, IMAGE, INFO, START_NS, STEP_NS, Recorder, make_depth, make_pixels  # noqa: E402

JOB: dict[str, Any] = {
    "water": {"optics": "jerlov-3C", "snow": {"density_per_m3": 4000}},
    "camera": {"sensor": {}},
    "enhance": ["gray_world"],
}
FRAMES = 3


def record_moving_camera(folder: Path) -> Path:
    """Write images with late depths, and transforms between their stamps."""
    with Recorder(folder, "mcap") as recorder:
        recorder.transform("/tf_static", START_NS - STEP_NS, "base", "camera", (0.1, 0.0, 0.0))
        recorder.info(START_NS - STEP_NS)
        for number in range(FRAMES):
            stamp_ns = START_NS + number * STEP_NS
            recorder.transform("/tf", stamp_ns - 33_000_000, "map", "base", (number / 3, 0.2, -2.0))
            recorder.image(IMAGE, stamp_ns, "bgr8", make_pixels(number))
            recorder.image(DEPTH, stamp_ns + 5_000_000 * number, "32FC1", make_depth())
            recorder.transform("/tf", stamp_ns + 33_000_000, "map", "base", (number / 3 + 0.1, 0.3, -2.1))
    return recorder.path


def render_live(path: Path) -> list[bytes]:
    """Feed the messages to the parts of the node, in the order of recording."""
    transforms, pairing, pairs = Transforms(), Pairing[Any, Any](), list[Pair[Any, Any]]()
    settings = read_settings({"world_frame": "map", "mode": "water+enhance"})
    renderer = FrameRenderer(settings, fathom.Stream(JOB), Topics(IMAGE, DEPTH, INFO), transforms)
    with Recording(path) as recording:
        for connection, _, data in recording.messages():
            message = recording.deserialize(connection, data)
            if connection.topic == "/tf_static":
                transforms.add_static(message)
            elif connection.topic == "/tf":
                transforms.add(message)
            elif connection.topic == INFO:
                renderer.camera_info = message
            elif connection.topic == IMAGE:
                pairs += pairing.add_image(read_stamp(message, IMAGE), message)
            else:
                pairs += pairing.add_depth(read_stamp(message, DEPTH), message)
    frames = [renderer.render(pair).frame for pair in pairs]
    return [array.tobytes() for frame in frames for array in (frame.rgb, frame.enhanced["gray_world"])]


def test_a_recording_has_the_bytes_of_a_live_node(tmp_path: Path) -> None:
    dive, wet, job = record_moving_camera(tmp_path), tmp_path / "wet.mcap", tmp_path / "job.json"
    job.write_text(json.dumps(JOB))
    topics = ["--image", IMAGE, "--depth", DEPTH, "--camera-info", INFO, "--world", "map"]
    assert command.main([str(dive), str(wet), "--job", str(job), *topics]) == 0
    with Recording(wet) as recording:
        added = [each for each in recording.connections if each.topic.endswith("/underwater")]
        results = {
            each.topic: [recording.deserialize(each, data).data.tobytes() for _, _, data in recording.messages([each])]
            for each in added
        }
    written: list[bytes] = []
    for number in range(FRAMES):
        written += [results[f"{IMAGE}/underwater"][number], results[f"{IMAGE}/enhanced/gray_world/underwater"][number]]
    assert written == render_live(dive)
    assert len(set(written)) == 2 * FRAMES
