"""Exports of sequences as messages of ROS 2, read by the libraries mcap and rosbags."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from numpy.typing import NDArray
from sequence_checks import BASELINE_M, KINDS, SIZE, STAMPS, check_poses, decode, export, pose_of, render_sequences
from test_formats import fetched, rows_of, try_export

sequences = pytest.fixture(scope="module")(render_sequences)


def read_messages(file: Path) -> dict[str, list[tuple[int, Any]]]:
    """Decode the messages of each topic with their times, and check every checksum."""
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_ros2.decoder")
    messages: dict[str, list[tuple[int, Any]]] = {}
    with file.open("rb") as stream:
        opened = reader.make_reader(stream, validate_crcs=True, decoder_factories=[decoder.DecoderFactory()])
        assert opened.get_header().profile == "ros2"
        statistics = opened.get_summary().statistics
        for _, channel, message, decoded in opened.iter_decoded_messages():
            assert message.log_time == message.publish_time
            messages.setdefault(channel.topic, []).append((message.log_time, decoded))
        assert statistics.message_count == sum(len(found) for found in messages.values())
        late = opened.iter_messages(starting_at=STAMPS[2])
        assert {message.log_time for _, _, message in late} == {STAMPS[2]}, "the index of times leads to chunks"
    return messages


def depth_of(message: Any) -> NDArray[np.float64]:
    assert (message.encoding, message.step, message.is_bigendian) == ("32FC1", 4 * message.width, 0)
    depth = np.frombuffer(bytes(message.data), "<f4").reshape(message.height, message.width).astype(np.float64)
    depth[np.isnan(depth)] = 0
    return depth


@pytest.mark.parametrize("dataset", ["dive", "lens"])
def test_mcap_carries_points_from_frame_to_frame(sequences: str, tmp_path: Path, dataset: str) -> None:
    kinds = ",".join(KINDS if dataset == "dive" else KINDS[:2])
    out = export(sequences, tmp_path, dataset, "mcap", "--kinds", kinds)
    rows = rows_of(out)
    for file in sorted(out.glob("*.mcap")):
        messages = read_messages(file)
        own = [row for row in rows if row["mcap"] == file.name]
        assert [row["stamp_ns"] for row in own] == STAMPS
        cameras = []
        for index, row in enumerate(own):
            of = {topic: found[index][1] for topic, found in messages.items()}
            for topic, found in messages.items():
                assert found[index][0] == row["stamp_ns"], topic
            picture = of["/camera/image/compressed"]
            assert hashlib.sha256(bytes(picture.data)).hexdigest() == row["artifacts.rgb"]
            assert picture.format == ("webp" if dataset == "dive" else "png")
            stamp = picture.header.stamp
            assert stamp.sec * 10**9 + stamp.nanosec == row["stamp_ns"]
            info = of["/camera/camera_info"]
            assert (info.width, info.height, info.distortion_model) == (*SIZE, "plumb_bob")
            assert list(info.p)[:3] == list(info.k)[:3]
            pose, transform = of["/camera/pose"], of["/tf"].transforms[0]
            assert (transform.header.frame_id, transform.child_frame_id) == ("world", picture.header.frame_id)
            assert pose.pose.position.x == transform.transform.translation.x
            place, turn = pose.pose.position, pose.pose.orientation
            world = pose_of([place.x, place.y, place.z], [turn.x, turn.y, turn.z, turn.w])
            depth = depth_of(of["/camera/depth"])
            cameras.append({"world": world, "k": np.reshape(info.k, (3, 3)), "d": info.d, "depth": depth})
        check_poses(cameras)
        assert ("/camera/instances" in messages) == (dataset == "dive")
    with pytest.raises(ValueError, match="mcap"):
        fathom.open(out)


def test_rosbags_reads_recordings_and_masks_are_those_of_the_dataset(sequences: str, tmp_path: Path) -> None:
    highlevel = pytest.importorskip("rosbags.highlevel")
    out = export(sequences, tmp_path, "pair", "mcap", "--kinds", ",".join(KINDS))
    plain = tmp_path / "folder"
    assert try_export(sequences, plain, "pair", "folder", "--kinds", "rgb,instances").returncode == 0
    masks = [decode(path.read_bytes()) for path in sorted(plain.glob("*/*/instances.png"))]
    with highlevel.AnyReader([next(out.glob("*.mcap"))]) as bag:
        assert {"/camera_right/image/compressed", "/camera_right/camera_info"} <= set(bag.topics)
        found = []
        for connection, _, data in bag.messages():
            message = bag.deserialize(data, connection.msgtype)
            if connection.topic == "/camera/instances":
                assert message.encoding == "mono16"
                found.append(message.data.view("<u2").reshape(message.height, message.width))
            if connection.topic == "/camera_right/camera_info":
                assert message.p[3] == pytest.approx(-message.k[0] * BASELINE_M)
            if connection.topic == "/tf":
                right = message.transforms[1]
                assert (right.header.frame_id, right.child_frame_id) == (
                    "camera_optical_frame",
                    "camera_right_optical_frame",
                )
                assert right.transform.translation.x == BASELINE_M
    assert all((one == other).all() for one, other in zip(found, masks, strict=True))


def test_torn_files_are_written_again_with_the_same_bytes(sequences: str, tmp_path: Path) -> None:
    out = export(sequences, tmp_path, "dive", "mcap")
    recordings = {file.name: file.read_bytes() for file in out.glob("*.mcap")}
    assert len(recordings) == 2
    first = min(out.glob("*.mcap"))
    first.write_bytes(b"torn")
    assert fetched(try_export(sequences, out, "dive", "mcap")) == 6
    assert {file.name: file.read_bytes() for file in out.glob("*.mcap")} == recordings
    tum = export(sequences, tmp_path, "dive", "tum")
    depth = min(tum.glob("*/depth/*.png"))
    before = depth.read_bytes()
    depth.write_bytes(b"torn")
    assert fetched(try_export(sequences, tum, "dive", "tum")) == 3, "rgb, range and record of one frame"
    assert depth.read_bytes() == before
