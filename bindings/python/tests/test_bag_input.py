from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

rosbags = pytest.importorskip("rosbags", reason="rosbags is not installed: recordings are not tested")

from fathom.bag import command  # noqa: E402
from fathom.bag.recording import Recording  # noqa: E402
from fathom.bag.status import end_if_stopped, run  # noqa: E402
from recordings import (  # noqa: E402
    DEPTH,
    HEIGHT,
    IMAGE,
    INFO,
    KINDS,
    NOTE,
    START_NS,
    STEP_NS,
    WIDTH,
    Recorder,
    make_depth,
    make_pixels,
    record_dive,
)

JOB: dict[str, Any] = {"enhance": ["gray_world"]}
WET, WET_RANGE = f"{IMAGE}/underwater", f"{DEPTH}/underwater"
TOPICS = ["--image", IMAGE, "--depth", DEPTH]


def convert(folder: Path, recording: Path, *options: str, job: dict[str, Any] = JOB, out: str = "wet.mcap") -> int:
    (folder / "job.json").write_text(json.dumps(job))
    return command.main([str(recording), str(folder / out), "--job", str(folder / "job.json"), *options])


def read_stamps(path: Path, topic: str = WET) -> list[int]:
    """Return the numbers of the frames of a topic."""
    with Recording(path) as recording:
        messages = [recording.deserialize(each, data) for each, _, data in recording.messages(recording.find(topic))]
    stamps = [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in messages]
    return [(stamp - START_NS) // STEP_NS for stamp in stamps]


def record_one_bad(folder: Path, depth: dict[str, Any], late_ns: int = 0) -> Path:
    """Write three frames; the depth of the second has other fields, or none with `{}`."""
    with Recorder(folder, "mcap") as recorder:
        for number in range(3):
            stamp_ns = START_NS + number * STEP_NS
            recorder.image(IMAGE, stamp_ns, "rgb8", make_pixels(number))
            usual: dict[str, Any] = {"encoding": "32FC1", "pixels": make_depth()}
            fields = depth if number == 1 else usual
            if fields:
                recorder.image(DEPTH, stamp_ns + (late_ns if number == 1 else 0), **fields)
    return recorder.path


@pytest.mark.parametrize(
    ("depth", "late_ns", "reason", "counted"),
    [
        (
            {"encoding": "32FC1", "pixels": make_depth()},
            30_000_000,
            "/cam/depth: no depth within 0.02 s (--slop-s); the nearest is 0.030000000 s later",
            "1 × /cam/depth: no depth",
        ),
        (
            {},
            0,
            "/cam/depth: no depth within 0.02 s (--slop-s); the nearest is 0.100000000 s earlier",
            "1 × /cam/depth: no depth",
        ),
        (
            {"encoding": "32FC1", "pixels": make_depth()[:-1]},
            0,
            f"/cam/depth: the depth is {WIDTH}×{HEIGHT - 1} but the image {WIDTH}×{HEIGHT}; register it",
            "1 × /cam/depth: size",
        ),
        (
            {"encoding": "64FC1", "pixels": make_depth()},
            0,
            '/cam/depth: `encoding` is "64FC1"; must be 32FC1 (meters) or 16UC1 (millimeters)',
            "1 × /cam/depth: encoding",
        ),
        (
            {"encoding": "32FC1", "pixels": make_depth(), "step": 7},
            0,
            f"/cam/depth: `step` is 7; must be {4 * WIDTH} or more",
            "1 × /cam/depth: size",
        ),
    ],
)
def test_a_frame_without_a_usable_depth_is_left_out_and_counted(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    depth: dict[str, Any],
    late_ns: int,
    reason: str,
    counted: str,
) -> None:
    dive = record_one_bad(tmp_path, depth, late_ns)
    assert convert(tmp_path, dive, *TOPICS) == 1
    assert read_stamps(tmp_path / "wet.mcap") == [0, 2]
    assert read_stamps(tmp_path / "wet.mcap", IMAGE) == [0, 1, 2]
    printed = capsys.readouterr().err
    assert f"frame 1700000000.100000000: left out: {reason}" in printed
    assert "2 frames written, 1 left out" in printed
    assert counted in printed


def test_a_larger_slop_takes_the_late_depth(tmp_path: Path) -> None:
    dive = record_one_bad(tmp_path, {"encoding": "32FC1", "pixels": make_depth()}, 30_000_000)
    assert convert(tmp_path, dive, *TOPICS, "--slop-s", "0.04") == 0
    assert read_stamps(tmp_path / "wet.mcap") == [0, 1, 2]


def test_nan_infinity_zero_and_negative_depths_are_pixels_without_a_return(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    depth = make_depth()
    depth[0, :4] = [np.nan, np.inf, 0, -1]
    assert convert(tmp_path, record_one_bad(tmp_path, {"encoding": "32FC1", "pixels": depth}), *TOPICS, "--range") == 0
    with Recording(tmp_path / "wet.mcap") as recording:
        messages = list(recording.messages(recording.find(WET_RANGE)))
        ranges = [
            recording.deserialize(each, data).data.view("<f4").reshape(HEIGHT, WIDTH) for each, _, data in messages
        ]
    assert np.isnan(ranges[1]).sum() == 4
    assert np.isnan(ranges[1][0, :4]).all()
    assert np.isfinite(ranges[0]).all()
    assert "no pixel with a distance" not in capsys.readouterr().err


def test_a_depth_without_any_return_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    empty = {"encoding": "32FC1", "pixels": np.full((HEIGHT, WIDTH), np.nan, np.float32)}
    assert convert(tmp_path, record_one_bad(tmp_path, empty), *TOPICS) == 0
    assert "1 × /cam/depth: no pixel with a distance" in capsys.readouterr().err


def test_an_unknown_encoding_of_an_image_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with Recorder(tmp_path, "ros1") as recorder:
        for number, encoding in enumerate(["rgb8", "yuv422", "rgb8"]):
            recorder.image(IMAGE, START_NS + number * STEP_NS, encoding, make_pixels(number))
    assert convert(tmp_path, recorder.path, "--image", IMAGE, out="wet.bag") == 1
    assert read_stamps(tmp_path / "wet.bag") == [0, 2]
    assert '`encoding` is "yuv422"; must be rgb8, bgr8, rgba8, bgra8, mono8' in capsys.readouterr().err


def test_a_message_of_other_bytes_is_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with Recorder(tmp_path, "mcap") as recorder:
        recorder.image(IMAGE, START_NS, "rgb8", make_pixels(0))
        recorder.writer.write(recorder.connections[IMAGE], START_NS + STEP_NS, b"\0\1\0\0nothing")
        recorder.image(IMAGE, START_NS + 2 * STEP_NS, "rgb8", make_pixels(2))
    assert convert(tmp_path, recorder.path, "--image", IMAGE) == 1
    assert read_stamps(tmp_path / "wet.mcap") == [0, 2]
    assert "1 × /cam/image: unreadable message" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("info", "job", "reason"),
    [
        ({"width": 64}, JOB, f"/cam/camera_info: describes pictures of 64×{HEIGHT}, but they are {WIDTH}×{HEIGHT}"),
        ({}, JOB | {"camera": {"hfov_deg": 90}}, "`camera` has a focal length of 30.0 px, but `camera.hfov_deg`"),
    ],
)
def test_a_camera_that_contradicts_the_image_or_the_job_leaves_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], info: dict[str, int], job: dict[str, Any], reason: str
) -> None:
    with Recorder(tmp_path, "sqlite") as recorder:
        for number in range(5):
            recorder.info(START_NS + number * STEP_NS, **info)
            recorder.image(IMAGE, START_NS + number * STEP_NS, "rgb8", make_pixels(number))
            recorder.image(DEPTH, START_NS + number * STEP_NS, "32FC1", make_depth())
    assert convert(tmp_path, recorder.path, *TOPICS, "--camera-info", INFO, job=job) == 2
    printed = capsys.readouterr().err
    assert reason in printed
    assert "0 frames written, 5 left out" in printed
    assert printed.count("left out: ") == 3 + 1
    assert "no frame of /cam/image could be converted; nothing was written" in printed
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dive", "job.json"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("share", [0.55, 0.9])
def test_a_recording_that_is_cut_off_is_converted_up_to_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str, share: float
) -> None:
    with Recorder(tmp_path, kind) as recorder:
        for number in range(400):
            stamp_ns = START_NS + number * STEP_NS
            recorder.note(stamp_ns, "x" * 9000)
            if number % 40 == 0:
                recorder.image(IMAGE, stamp_ns, "rgb8", make_pixels(number))
    dive = recorder.path
    file = dive if dive.is_file() else next(path for path in dive.iterdir() if path.suffix in (".mcap", ".db3"))
    file.write_bytes(file.read_bytes()[: int(file.stat().st_size * share)])
    out = f"wet{dive.suffix}"
    assert convert(tmp_path, dive, "--image", IMAGE, out=out) == 1
    frames = read_stamps(tmp_path / out)
    assert frames == read_stamps(tmp_path / out, IMAGE) == list(range(0, 400, 40))[: len(frames)]
    assert len(frames) >= 10 * share - 3
    with Recording(tmp_path / out) as recording:
        notes = [data for _, _, data in recording.messages(recording.find(NOTE))]
        assert recording.cut is None
    assert len(notes) >= 400 * share - 120
    assert all(len(data) > 9000 for data in notes)
    printed = capsys.readouterr().err
    assert f"fathom: {dive} is cut off: it ends at 17000000" in printed


def test_a_folder_without_its_metadata_is_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dive = record_dive(tmp_path, "mcap")
    (dive / "metadata.yaml").unlink()
    assert convert(tmp_path, dive, *TOPICS) == 0
    assert read_stamps(tmp_path / "wet.mcap") == [0, 1, 2]
    assert "cut off" not in capsys.readouterr().err


def test_the_log_of_a_killed_recorder_is_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dive = record_dive(tmp_path, "sqlite")
    script = (
        "import os, sqlite3, sys; file = sqlite3.connect(sys.argv[1]); file.execute('PRAGMA journal_mode=WAL');"
        "file.execute('INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp + 1, data"
        " FROM messages ORDER BY id DESC LIMIT 1'); file.commit(); os._exit(0)"
    )
    subprocess.run([sys.executable, "-c", script, str(dive / "dive.db3")], check=True)
    assert (dive / "dive.db3-wal").stat().st_size > 0
    assert convert(tmp_path, dive, *TOPICS) == 1
    assert "a write-ahead log shows that it was not closed" in capsys.readouterr().err
    with Recording(tmp_path / "wet.mcap") as recording:
        assert len(list(recording.messages(recording.find(NOTE)))) == 4


def test_types_without_definitions_are_copied(tmp_path: Path) -> None:
    dive = record_dive(tmp_path, "sqlite")
    script = (
        "import sqlite3, sys; file = sqlite3.connect(sys.argv[1]); file.execute('DELETE FROM message_definitions');"
        'file.execute(\'UPDATE topics SET type_description_hash="", type="my_msgs/msg/Own" WHERE name="/note"\');'
        "file.execute('UPDATE topics SET type_description_hash=\"\"'); file.commit()"
    )
    subprocess.run([sys.executable, "-c", script, str(dive / "dive.db3")], check=True)
    for out in ("wet.mcap", "wet.db3"):
        assert convert(tmp_path, dive / "dive.db3", *TOPICS, out=out) == 0
        with Recording(tmp_path / out) as recording, Recording(dive / "dive.db3") as before:
            (note,) = recording.find(NOTE)
            assert (note.msgtype, note.msgdef.data) == ("my_msgs/msg/Own", "")
            copied = [bytes(data) for _, _, data in recording.messages([note])]
            assert copied == [bytes(data) for _, _, data in before.messages(before.find(NOTE))]
        assert read_stamps(tmp_path / out) == [0, 1, 2]


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--image", "/nope"], "has no topic /nope; its topics are\n  /cam/camera_info (sensor_msgs/msg/CameraInfo)\n"),
        (["--image", NOTE], "--image /note is std_msgs/msg/String; must be sensor_msgs/msg/Image or"),
        (["--image", IMAGE, "--depth", INFO], "--depth /cam/camera_info is sensor_msgs/msg/CameraInfo; must be"),
        (["--image", IMAGE, "--depth", IMAGE], "--image and --depth are both /cam/image"),
        (["--image", IMAGE, "--camera-info", DEPTH], "--camera-info /cam/depth is sensor_msgs/msg/Image; must be"),
        (["--image", IMAGE, "--rectified"], "--rectified needs --camera-info"),
        (["--image", IMAGE, "--slop-s", "2"], "--slop-s is 2; must be 0 to 1"),
        (["--image", IMAGE, "--slop-s", "nan"], "--slop-s is nan; must be 0 to 1"),
        (["--image", IMAGE, "--world", "map"], "has no topic of tf2_msgs/msg/TFMessage; --world needs /tf"),
        (["--image", IMAGE, "--pose-topic", NOTE, "--pose-axes", "body"], "--pose-topic /note is std_msgs/msg/String"),
        (["--image", IMAGE, "--pose-topic", NOTE], "--pose-topic needs --pose-axes optical or body"),
    ],
)
def test_wrong_options_name_what_there_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], reason: str
) -> None:
    dive = record_dive(tmp_path, "mcap", frames=1)
    assert convert(tmp_path, dive, *options) == 2
    assert reason in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dive_mcap", "job.json"]


def test_wrong_files_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dive = record_dive(tmp_path, "mcap", frames=1)
    (tmp_path / "empty").mkdir()
    (tmp_path / "text.bag").write_text("no bag")
    (tmp_path / "text.mcap").write_text("no mcap")
    (tmp_path / "text.db3").write_text("no database")
    (tmp_path / "picture.png").write_text("")
    (tmp_path / "wet.mcap").write_text("mine")
    for given, reason in (
        (tmp_path / "missing.bag", "does not exist"),
        (tmp_path / "empty", "holds no .mcap or .db3 file"),
        (tmp_path / "picture.png", "is no recording; must be a .bag, .mcap or .db3 file"),
        (tmp_path / "text.bag", "has no readable message"),
        (tmp_path / "text.mcap", "has no readable message"),
        (tmp_path / "text.db3", "has no readable message"),
        (dive, "wet.mcap exists; choose another name, or remove it"),
    ):
        assert convert(tmp_path, given, "--image", IMAGE) == 2
        assert reason in capsys.readouterr().err
    assert (tmp_path / "wet.mcap").read_text() == "mine"
    assert convert(tmp_path, dive, "--image", IMAGE, job={"water": 3}, out="other.mcap") == 2
    assert "Invalid job" in capsys.readouterr().err
    assert convert(tmp_path, dive, "--image", IMAGE, "--styles", "/nope", out="other.mcap") == 2
    assert "/nope cannot be read" in capsys.readouterr().err
    assert command.main([str(dive), "other.mcap", "--job", "/nope.json", "--image", IMAGE]) == 2
    assert "/nope.json: No such file or directory" in capsys.readouterr().err
    assert not (tmp_path / "other.mcap").exists()


def test_a_converted_recording_is_not_converted_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dive = record_dive(tmp_path, "mcap", frames=1)
    assert convert(tmp_path, dive, "--image", IMAGE) == 0
    assert convert(tmp_path, tmp_path / "wet.mcap", "--image", IMAGE, out="again.mcap") == 2
    assert "already has the topic /cam/image/underwater" in capsys.readouterr().err
    assert not (tmp_path / "again.mcap").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_conversion_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    dive = record_dive(tmp_path, "mcap", frames=200)
    job = tmp_path / "job.json"
    job.write_text(json.dumps({"water": {"optics": "jerlov-3C"}}))
    arguments = [str(dive), str(tmp_path / "wet.mcap"), "--job", str(job), *TOPICS]
    with subprocess.Popen([sys.executable, "-m", "fathom.bag", *arguments], stderr=subprocess.PIPE) as process:
        until = time.monotonic() + 20
        while not any(path.name.startswith(".fathom-bag-") for path in tmp_path.iterdir()):
            assert time.monotonic() < until
            time.sleep(0.01)
        os.kill(process.pid, number)
        assert process.wait(20) == 128 + number
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dive_mcap", "job.json"]


def test_a_stop_that_a_frame_took_for_its_own_error_ends_the_conversion() -> None:
    def command(_: Sequence[str]) -> int:
        for number in (signal.SIGINT, signal.SIGTERM):
            with pytest.raises((KeyboardInterrupt, SystemExit)):
                os.kill(os.getpid(), number)
            with pytest.raises((KeyboardInterrupt, SystemExit)):
                end_if_stopped()
        os.kill(os.getpid(), signal.SIGINT)
        return 0

    before = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    assert run(command, []) == 128 + signal.SIGINT
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)] == before


@pytest.mark.parametrize("kind", KINDS)
def test_a_full_disk_leaves_nothing(tmp_path: Path, kind: str) -> None:
    with Recorder(tmp_path, kind) as recorder:
        recorder.image(IMAGE, START_NS, "rgb8", make_pixels(0))
        for number in range(40):
            recorder.note(START_NS + number * STEP_NS, "x" * 60_000)
    (tmp_path / "job.json").write_text("{}")
    out = f"wet{recorder.path.suffix}"
    converting = [sys.executable, "-m", "fathom.bag", str(recorder.path), out, "--job", "job.json", "--image", IMAGE]
    limit = "import os, resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (10**6, 10**6))"
    arguments = [sys.executable, "-c", f"{limit}; os.execv(sys.argv[1], sys.argv[1:])", *converting]
    result = subprocess.run(arguments, capture_output=True, text=True, cwd=tmp_path)
    assert (result.returncode, result.stderr.count("\n")) == (1, 1), result.stderr
    assert "fathom: the output cannot be written: " in result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([recorder.path.name, "job.json"])
