"""Inertial measurements of a recording next to an exported sequence."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import fathom
import numpy as np
import pytest
from sequence_checks import export
from test_bag_upload import upload

rosbags = pytest.importorskip("rosbags", reason="rosbags is not installed: recordings are not tested")

from fathom.bag import imu  # noqa: E402
from recordings import (  # noqa: E402
    DEPTH,
    IMAGE,
    INFO,
    KINDS,
    POSE,
    START_NS,
    STEP_NS,
    Recorder,
    make_depth,
    make_pixels,
)

IMU = "/imu/data"
FRAMES = 3
IMU_STEP_NS = 10_000_000
SAMPLES = (FRAMES - 1) * STEP_NS // IMU_STEP_NS + 1


def measure(number: int) -> tuple[float, ...]:
    """Return the rad/s and m/s² of a sample; 1/3 has no short decimals."""
    return (number / 3, -0.25, 1e-9, 0.1 * number, 0.0, 9.80665)


def record(folder: Path, kind: str, frames: int = FRAMES) -> Path:
    """Record a camera and an IMU, 0.1 m ahead of it and with axes of its own."""
    with Recorder(folder, kind) as recorder:
        recorder.transform("/tf_static", START_NS, "base", "imu", (0.3, 0.0, 0.0))
        recorder.transform("/tf_static", START_NS, "base", "camera", (0.2, 0.5, 0.0))
        for number in range(SAMPLES):
            values = measure(number)
            recorder.imu(IMU, START_NS + number * IMU_STEP_NS, values[:3], values[3:])
        for number in range(frames):
            stamp_ns = START_NS + number * STEP_NS
            recorder.info(stamp_ns)
            recorder.odometry(stamp_ns, float(number))
            recorder.image(IMAGE, stamp_ns, "rgb8", make_pixels(number))
            recorder.image(DEPTH, stamp_ns, "32FC1", make_depth())
    return recorder.path


def make_sequence(folder: Path, stamps: list[int]) -> Path:
    listed = folder / "sequence/mav0/cam0/data.csv"
    listed.parent.mkdir(parents=True)
    listed.write_text("#timestamp [ns],filename\n" + "".join(f"{stamp},{stamp}.png\n" for stamp in stamps))
    return folder / "sequence"


@pytest.mark.parametrize("kind", KINDS)
def test_samples_have_their_times_units_and_all_digits(tmp_path: Path, kind: str) -> None:
    dive = record(tmp_path, kind)
    sequence = make_sequence(tmp_path, [START_NS, START_NS + STEP_NS])
    assert imu.main([str(dive), str(sequence), "--imu", IMU, "--camera-frame", "camera"]) == 0
    text = (sequence / "mav0/imu0/data.csv").read_text()
    head, *rows = csv.reader(text.splitlines())
    assert head[:2] == ["#timestamp [ns]", "w_RS_S_x [rad s^-1]"]
    assert head[-1] == "a_RS_S_z [m s^-2]"
    assert len(rows) == SAMPLES
    for number, (stamp, *values) in enumerate(rows):
        assert int(stamp) == START_NS + number * IMU_STEP_NS
        assert tuple(map(float, values)) == measure(number)
    sensor = (sequence / "mav0/imu0/sensor.yaml").read_text()
    assert "sensor_type: imu\n" in sensor
    assert "rate_hz: 100.0\n" in sensor
    [data] = re.findall(r"data: \[(.*)\]", sensor)
    # Both frames have the axes of the base; the IMU is 0.1 m along x and -0.5 m along y from the camera.
    expected = np.eye(4)
    expected[:2, 3] = 0.1, -0.5
    np.testing.assert_allclose(np.array(data.split(","), float).reshape(4, 4), expected, atol=1e-12)


def test_a_recording_with_imu_goes_through_a_dataset_to_euroc(server: str, tmp_path: Path) -> None:
    yaml = pytest.importorskip("yaml")
    dive = record(tmp_path, "mcap")
    topics = ["--depth", DEPTH, "--camera-info", INFO, "--pose-topic", POSE, "--pose-axes", "body"]
    uploaded = upload(server, dive, "inertial", *topics)
    assert uploaded.returncode == 0, uploaded.stderr
    job = {
        "dataset": "inertial",
        "scene": {"kind": "collection", "name": "inertial", "each": True},
        "enhance": ["hscm"],
    }
    with fathom.Client(server, token="secret") as client:
        assert client.submit(job).wait().state["state"] == "done"
    out = export(server, tmp_path, "inertial", "euroc")
    [sequence] = [path for path in out.iterdir() if path.is_dir()]
    assert imu.main([str(dive), str(sequence), "--imu", IMU, "--camera-frame", "camera"]) == 0
    listed = {name: sequence / "mav0" / name / "data.csv" for name in ("cam0", "imu0")}
    stamps = {
        name: [int(row.split(",")[0]) for row in path.read_text().splitlines()[1:]] for name, path in listed.items()
    }
    assert stamps["cam0"] == [START_NS + number * STEP_NS for number in range(FRAMES)]
    assert set(stamps["cam0"]) <= set(stamps["imu0"])
    sensors = [yaml.safe_load((path.parent / "sensor.yaml").read_text()) for path in listed.values()]
    assert [sensor["sensor_type"] for sensor in sensors] == ["camera", "imu"]
    assert sensors[0]["T_BS"].keys() == sensors[1]["T_BS"].keys()


def test_samples_without_a_use_are_left_out_and_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with Recorder(tmp_path, "sqlite") as recorder:
        # Recorded in another order than measured.
        for stamp_ns, turn in ((20, 1.0), (10, 2.0), (20, 3.0), (30, np.nan), (40, np.inf), (50, 4.0)):
            recorder.imu(IMU, START_NS + stamp_ns, (turn, 0.0, 0.0), (0.0, 0.0, 9.8))
    sequence = make_sequence(tmp_path, [START_NS, START_NS + 40])
    assert imu.main([str(recorder.path), str(sequence), "--imu", IMU]) == 1
    rows = (sequence / "mav0/imu0/data.csv").read_text().splitlines()[1:]
    assert [row.split(",")[:2] for row in rows] == [
        [str(START_NS + stamp_ns), turn] for stamp_ns, turn in ((10, "2.0"), (20, "1.0"), (50, "4.0"))
    ]
    assert "T_BS" not in (sequence / "mav0/imu0/sensor.yaml").read_text()
    printed = capsys.readouterr().err
    assert "3 samples written, 3 left out" in printed
    assert f"left out: 2 × {IMU}: not finite" in printed
    assert f"left out: 1 × {IMU}: repeated stamp" in printed
    assert "warning: 1 of 2 pictures are outside of the samples" in printed
    assert "note: sensor.yaml has no T_BS; give --camera-frame" in printed


@pytest.mark.parametrize(
    ("options", "stamps", "reason"),
    [
        (["--imu", "/nope"], [START_NS], "has no topic /nope; its topics are"),
        (["--imu", IMAGE], [START_NS], "is sensor_msgs/msg/Image; must be sensor_msgs/msg/Imu"),
        (
            ["--imu", IMU],
            [1_000_000_000],
            "but pictures are from 1000000000 to 1000000000 ns in .*; give the recording",
        ),
        (["--imu", IMU, "--camera-frame", "nope"], [START_NS], "leads from the frame 'imu' to 'nope'"),
        (["--imu", "/imu/turn"], [START_NS], "/imu/turn has no `angular_velocity`: its covariance begins with -1"),
        (["--imu", IMU], None, "data.csv does not exist; give a sequence of `fathom export --format euroc`"),
    ],
)
def test_wrong_topics_and_sequences_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], stamps: list[int] | None, reason: str
) -> None:
    with Recorder(tmp_path, "mcap") as recorder:
        recorder.transform("/tf_static", START_NS, "base", "imu", (0.3, 0.0, 0.0))
        recorder.imu(IMU, START_NS, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8))
        recorder.imu("/imu/turn", START_NS, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8), first_covariance=-1)
        recorder.image(IMAGE, START_NS, "rgb8", make_pixels(0))
    sequence = tmp_path / "sequence" if stamps is None else make_sequence(tmp_path, stamps)
    assert imu.main([str(recorder.path), str(sequence), *options]) == 2
    assert re.search(reason, capsys.readouterr().err)
    assert not (sequence / "mav0/imu0").exists()


def test_a_sensor_that_is_there_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dive, sequence = record(tmp_path, "mcap", frames=1), make_sequence(tmp_path, [START_NS])
    arguments = [str(dive), str(sequence), "--imu", IMU, "--camera-frame", "camera"]
    assert imu.main(arguments) == 0
    before = (sequence / "mav0/imu0/data.csv").read_bytes()
    assert imu.main(arguments) == 2
    assert "exists; remove it first" in capsys.readouterr().err
    assert (sequence / "mav0/imu0/data.csv").read_bytes() == before
    assert {path.name for path in (sequence / "mav0").iterdir()} == {"cam0", "imu0"}
