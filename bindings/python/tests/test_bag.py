from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest

rosbags = pytest.importorskip("rosbags", reason="rosbags is not installed: recordings are not tested")

from fathom.bag import command  # noqa: E402
from fathom.bag.recording import Recording  # noqa: E402
from recordings import (  # noqa: E402
    DEPTH,
    IMAGE,
    INFO,
    KINDS,
    NOTE,
    POSE,
    START_NS,
    STEP_NS,
    Recorder,
    make_depth,
    make_pixels,
    record_dive,
)
from rosbags.rosbag2 import CompressionFormat, CompressionMode  # noqa: E402

JOB: dict[str, Any] = {"seed": 3, "water": {"optics": "jerlov-3C"}, "camera": {"sensor": {}}, "enhance": ["gray_world"]}
CAMERA = [[30.0, 0, 15.5], [0, 30.0, 11.5], [0, 0, 1]]
WET, WET_RANGE = f"{IMAGE}/underwater", f"{DEPTH}/underwater"
ENHANCED = f"{IMAGE}/enhanced/gray_world/underwater"
TOPICS = ["--image", IMAGE, "--depth", DEPTH, "--camera-info", INFO]


def convert(folder: Path, recording: Path, out: str, *options: str, job: dict[str, Any] = JOB) -> int:
    (folder / "job.json").write_text(json.dumps(job))
    return command.main([str(recording), str(folder / out), "--job", str(folder / "job.json"), *options])


def read(path: Path) -> dict[str, list[tuple[int, bytes]]]:
    """Return the messages by topic."""
    messages: dict[str, list[tuple[int, bytes]]] = {}
    with Recording(path) as recording:
        for connection, recorded_ns, data in recording.messages():
            messages.setdefault(connection.topic, []).append((recorded_ns, bytes(data)))
        assert recording.cut is None
    return messages


def read_images(path: Path, topic: str) -> Iterator[Any]:
    with Recording(path) as recording:
        for connection, _, data in recording.messages(recording.find(topic)):
            yield recording.deserialize(connection, data)


def describe_topics(path: Path) -> dict[str, Any]:
    """Return type, definition and quality of service by topic."""
    with Recording(path) as recording:
        return {each.topic: (each.msgtype, each.msgdef, each.digest, each.ext) for each in recording.connections}


def digest(path: Path) -> str:
    files = [path] if path.is_file() else sorted(path.iterdir())
    return hashlib.sha256(b"".join(file.name.encode() + file.read_bytes() for file in files)).hexdigest()


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_gains_topics_and_keeps_the_others(
    tmp_path: Path, kind: str, capsys: pytest.CaptureFixture[str]
) -> None:
    dive = record_dive(tmp_path, kind)
    wet = f"wet{dive.suffix}"
    assert convert(tmp_path, dive, wet, *TOPICS, "--range") == 0
    before, after = read(dive), read(tmp_path / wet)
    assert set(after) - set(before) == {WET, WET_RANGE, ENHANCED}
    assert {topic: after[topic] for topic in before} == before
    topics = describe_topics(tmp_path / wet)
    assert {topic: topics[topic] for topic in before} == describe_topics(dive)
    assert topics[WET] == topics[IMAGE]
    assert [recorded_ns for recorded_ns, _ in after[WET]] == [recorded_ns for recorded_ns, _ in before[IMAGE]]
    assert "3 frames written, 0 left out" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([dive.name, wet, "job.json"])


@pytest.mark.parametrize("kind", KINDS)
def test_the_bytes_are_those_of_a_stream_and_of_another_run(tmp_path: Path, kind: str) -> None:
    dive = record_dive(tmp_path, kind)
    ending = dive.suffix
    assert convert(tmp_path, dive, f"one/wet{ending}", *TOPICS, "--range") == 0
    assert convert(tmp_path, dive, f"two/wet{ending}", *TOPICS, "--range") == 0
    assert digest(tmp_path / f"one/wet{ending}") == digest(tmp_path / f"two/wet{ending}")
    stream = fathom.Stream(JOB)
    images = {topic: list(read_images(tmp_path / f"one/wet{ending}", topic)) for topic in (WET, WET_RANGE, ENHANCED)}
    for number in range(3):
        stamp_ns = START_NS + number * STEP_NS
        out = stream(make_pixels(number), z_depth=make_depth(), camera=CAMERA, stamp_ns=stamp_ns)
        assert out.range_m is not None
        for topic, array in ((WET, out.rgb), (WET_RANGE, out.range_m), (ENHANCED, out.enhanced["gray_world"])):
            message = images[topic][number]
            assert message.data.tobytes() == array.tobytes()
            assert message.header.frame_id == "camera"
            assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == stamp_ns
    assert [image.encoding for image in (images[WET][0], images[WET_RANGE][0])] == ["rgb8", "32FC1"]


DRY: dict[str, Any] = {"enhance": ["gray_world"]}


@pytest.mark.parametrize(
    ("kind", "out", "expected"),
    [
        ("ros1", "wet", {"metadata.yaml", "wet.mcap"}),
        ("ros1", "wet.db3", None),
        ("mcap", "wet.bag", None),
        ("sqlite", "wet.bag", None),
        ("mcap", "wet.db3", None),
    ],
)
def test_the_name_states_the_kind(tmp_path: Path, kind: str, out: str, expected: set[str] | None) -> None:
    dive = record_dive(tmp_path, kind, frames=2)
    assert convert(tmp_path, dive, out, "--image", IMAGE, job=DRY) == 0
    path = tmp_path / out
    assert path.is_file() if expected is None else {file.name for file in path.iterdir()} == expected
    assert [image.data.tobytes() for image in read_images(path, IMAGE)] == [make_pixels(n).tobytes() for n in range(2)]
    assert len(list(read_images(path, ENHANCED))) == 2
    notes = [bytes(data) for _, data in read(path)[NOTE]]
    assert [b"number 0" in notes[0], b"number 1" in notes[1]] == [True, True]


@pytest.mark.parametrize("encoding", ["bgr8", "rgba8", "bgra8", "mono8"])
def test_encodings_with_padding_and_compressed_files_are_read(tmp_path: Path, encoding: str) -> None:
    pixels = make_pixels(1)
    expected = pixels
    if encoding == "mono8":
        expected = pixels[:, :, :1].repeat(3, axis=2)
        given = pixels[:, :, :1]
    else:
        order = [2, 1, 0] if encoding.startswith("bgr") else [0, 1, 2]
        given = np.pad(pixels[:, :, order], ((0, 0), (0, 0), (0, len(encoding) - 4)))
    rows = np.pad(given.reshape(len(given), -1), ((0, 0), (0, 3)))
    with Recorder(tmp_path, "mcap") as recorder:
        size = {"width": pixels.shape[1], "step": rows.shape[1]}
        recorder.image(IMAGE, START_NS, encoding, rows, **size)
        data = np.frombuffer(fathom._native.encode_png(np.ascontiguousarray(expected)), np.uint8)
        header = recorder.header(START_NS)
        compressed = recorder.make("sensor_msgs/msg/CompressedImage", header=header, format="png", data=data)
        recorder.write("/cam/compressed", START_NS, compressed)
    for topic, out in ((IMAGE, "raw"), ("/cam/compressed", "compressed")):
        assert convert(tmp_path, recorder.path, out, "--image", topic, job={}) == 0
        (image,) = read_images(tmp_path / out, f"{topic}/underwater")
        assert image.data.tobytes() == expected.tobytes()


@pytest.mark.parametrize("big", [False, True])
def test_depths_of_both_types_and_byte_orders_are_equal(tmp_path: Path, big: bool) -> None:
    millimeters = (make_depth() * 1000).astype(np.uint16)
    order = ">" if big else "<"
    given = {"32FC1": (millimeters / np.float32(1000)).astype(f"{order}f4"), "16UC1": millimeters.astype(f"{order}u2")}
    with Recorder(tmp_path, "ros1") as recorder:
        recorder.info(START_NS)
        recorder.image(IMAGE, START_NS, "rgb8", make_pixels(0))
        for encoding, depth in given.items():
            recorder.image(f"/{encoding}", START_NS, encoding, depth, is_bigendian=int(big))
    results = []
    for encoding in given:
        options = ["--image", IMAGE, "--depth", f"/{encoding}", "--camera-info", INFO, "--range"]
        assert convert(tmp_path, recorder.path, f"{encoding}.bag", *options, job=DRY) == 0
        (image,) = read_images(tmp_path / f"{encoding}.bag", f"/{encoding}/underwater")
        results.append(image.data.view("<f4"))
    np.testing.assert_allclose(results[0], results[1], rtol=1e-6)


SNOW: dict[str, Any] = {"water": {"optics": "jerlov-3C", "snow": {"density_per_m3": 4000}}}


def record_poses(folder: Path, kind: str) -> Path:
    """Write a camera that moves by 0.5 m ahead in each step, with its poses in both forms."""
    with Recorder(folder, kind) as recorder:
        recorder.transform("/tf_static", START_NS, "base_link", "camera", (0.0, 0.0, 0.0))
        for number in range(-1, 3):
            stamp_ns = START_NS + number * STEP_NS
            recorder.odometry(stamp_ns + 7, number / 2)
            recorder.transform("/tf", stamp_ns + 7, "map", "base_link", (number / 2, 2.0, -3.0))
        for number in range(2):
            stamp_ns = START_NS + number * STEP_NS
            recorder.image(IMAGE, stamp_ns, "rgb8", make_pixels(0))
            recorder.image(DEPTH, stamp_ns, "32FC1", make_depth())
    return recorder.path


@pytest.mark.parametrize("kind", ["ros1", "mcap"])
@pytest.mark.parametrize(
    ("options", "turn"),
    [
        (["--world", "map"], np.eye(3)),
        (["--pose-topic", POSE, "--pose-axes", "optical"], np.eye(3)),
        (["--pose-topic", POSE, "--pose-axes", "body"], np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])),
    ],
)
def test_poses_are_interpolated_at_the_stamps(tmp_path: Path, kind: str, options: list[str], turn: Any) -> None:
    dive = record_poses(tmp_path, kind)
    assert convert(tmp_path, dive, "wet.mcap", "--image", IMAGE, "--depth", DEPTH, *options, job=SNOW) == 0
    stream = fathom.Stream(SNOW)
    for number, image in enumerate(read_images(tmp_path / "wet.mcap", WET)):
        pose = np.eye(4)
        pose[:3, :3] = turn
        share = (STEP_NS - 7) / STEP_NS
        pose[:3, 3] = [(number - 1) / 2 + share * 0.5, 2, -3]
        stamp_ns = START_NS + number * STEP_NS
        out = stream(make_pixels(0), z_depth=make_depth(), stamp_ns=stamp_ns, pose=pose)
        assert image.data.tobytes() == out.rgb.tobytes()
    assert out.rgb.tobytes() != stream(make_pixels(0), z_depth=make_depth(), stamp_ns=stamp_ns).rgb.tobytes()


def test_frames_can_have_the_time_of_recording(tmp_path: Path) -> None:
    with Recorder(tmp_path, "mcap") as recorder:
        for number in range(2):
            message = recorder.make(
                "sensor_msgs/msg/Image",
                header=recorder.header(0),
                height=24,
                width=32,
                encoding="rgb8",
                is_bigendian=0,
                step=96,
                data=make_pixels(number).reshape(-1),
            )
            recorder.write(IMAGE, START_NS + number * STEP_NS, message)
    job: dict[str, Any] = {"camera": {"sensor": {}}}
    assert convert(tmp_path, recorder.path, "header", "--image", IMAGE, job=job) == 1
    assert convert(tmp_path, recorder.path, "recorded", "--image", IMAGE, "--stamps", "recorded", job=job) == 0
    assert len(list(read_images(tmp_path / "header", WET))) == 1
    stream = fathom.Stream(job)
    for number, image in enumerate(read_images(tmp_path / "recorded", WET)):
        out = stream(make_pixels(number), stamp_ns=START_NS + number * STEP_NS)
        assert image.data.tobytes() == out.rgb.tobytes()


@pytest.mark.parametrize(
    ("kind", "mode"),
    [("ros1", "LZ4"), ("ros1", "BZ2"), ("mcap", "STORAGE"), ("mcap", "FILE"), ("sqlite", "MESSAGE")],
)
def test_compressed_recordings_are_read(tmp_path: Path, kind: str, mode: str) -> None:
    recorder = Recorder(tmp_path, kind)
    if kind == "ros1":
        recorder.writer.set_compression(recorder.writer.CompressionFormat[mode])
    else:
        recorder.writer.set_compression(CompressionMode[mode], CompressionFormat.ZSTD)
    with recorder:
        recorder.image(IMAGE, START_NS, "rgb8", make_pixels(0))
    out = f"wet{recorder.path.suffix}"
    assert convert(tmp_path, recorder.path, out, "--image", IMAGE, job={}) == 0
    for topic in (IMAGE, WET):
        assert [image.data.tobytes() for image in read_images(tmp_path / out, topic)] == [make_pixels(0).tobytes()]
