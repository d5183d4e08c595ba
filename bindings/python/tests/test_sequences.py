"""Exports of sequences as in benchmarks, read as their tools do."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from numpy.typing import NDArray
from sequence_checks import BASELINE_M, SIZE, STAMPS, check_poses, decode, export, pose_of, render_sequences
from test_formats import rows_of, try_export

FORMATS = ["mcap", "tum", "euroc", "kitti"]
sequences = pytest.fixture(scope="module")(render_sequences)


def settings_of(file: Path) -> dict[str, Any]:
    """Read the settings of ORB-SLAM, whose first line is OpenCV's alone, and check that its numbers are real."""
    yaml = pytest.importorskip("yaml")
    first, rest = file.read_text().split("\n", 1)
    assert first == "%YAML:1.0"
    settings: dict[str, Any] = yaml.safe_load(rest)
    for name in ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "fps", "bf"):
        assert isinstance(settings[f"Camera.{name}"], float), name
    assert settings["Camera.fps"] == pytest.approx(3, rel=1e-6)
    return settings


def matrix_of(settings: dict[str, Any]) -> NDArray[np.float64]:
    fx, fy, cx, cy = (settings[f"Camera.{name}"] for name in ("fx", "fy", "cx", "cy"))
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])


@pytest.mark.parametrize("dataset", ["dive", "lens", "port"])
def test_tum_lists_pictures_z_depth_and_poses_by_time(sequences: str, tmp_path: Path, dataset: str) -> None:
    kinds = "rgb,instances" if dataset == "dive" else "rgb"
    out = export(sequences, tmp_path, dataset, "tum", "--kinds", kinds)
    folders = sorted(path for path in out.iterdir() if path.is_dir())
    assert len(folders) == (2 if dataset == "dive" else 1)
    for folder in folders:
        settings = settings_of(folder / "orb_slam.yaml")
        assert settings["DepthMapFactor"] == 5000
        distortion = [settings[f"Camera.{name}"] for name in ("k1", "k2", "p1", "p2", "k3")]
        assert any(distortion) == (dataset != "dive")
        poses = np.loadtxt(folder / "groundtruth.txt")
        lines = [line.split() for line in (folder / "associations.txt").read_text().splitlines()]
        listed = [line.split() for line in (folder / "rgb.txt").read_text().splitlines()[1:]]
        assert [line[:2] for line in lines] == listed
        assert [int(line[0].replace(".", "")) for line in lines] == STAMPS
        cameras: list[dict[str, Any]] = []
        for (stamp, rgb, other, depth), pose in zip(lines, poses, strict=True):
            assert stamp == other
            assert pose[0] == float(stamp)
            assert decode((folder / rgb).read_bytes()).shape == (SIZE[1], SIZE[0], 3)
            codes = decode((folder / depth).read_bytes())
            assert codes.dtype == np.uint16
            world = pose_of(pose[1:4], pose[4:8])
            cameras.append({"world": world, "k": matrix_of(settings), "d": distortion, "depth": codes / 5000})
        check_poses(cameras)
        assert (folder / "instances.txt").exists() == (dataset == "dive")
    frames = fathom.open(out)
    assert len(frames) == 3 * len(folders)
    assert frames.read(0).rgb.shape == (SIZE[1], SIZE[0], 3)
    fields = json.loads((out / "fields.json").read_text())
    assert fields["arrays"]["z_depth"]["unit"] == "1/5000 m"
    assert fields["columns"]["stamp_ns"]["unit"] == "ns"


def test_depth_beyond_sixteen_bits_is_zero_and_counted(sequences: str, tmp_path: Path) -> None:
    ended = try_export(sequences, tmp_path / "tum", "lens", "tum")
    files = sorted((tmp_path / "tum").glob("*/depth/*.png"))
    ended_range = try_export(sequences, tmp_path / "folder", "lens", "folder", "--kinds", "rgb,range")
    assert ended.returncode == ended_range.returncode == 0
    ranges = [decode(file.read_bytes()) for file in sorted((tmp_path / "folder").glob("*/*/range.png"))]
    lost = sum(int(np.sum((decode(file.read_bytes()) == 0) & (r > 0))) for file, r in zip(files, ranges, strict=True))
    found = int(ended.stderr.split("warning: ")[1].split(" pixels")[0]) if "warning" in ended.stderr else 0
    assert lost == found


def test_euroc_has_cameras_pictures_and_poses(sequences: str, tmp_path: Path) -> None:
    yaml = pytest.importorskip("yaml")
    out = export(sequences, tmp_path, "dive", "euroc", "--kinds", "rgb,range,instances")
    folder = min(path for path in out.iterdir() if path.is_dir())
    camera = yaml.safe_load((folder / "mav0/cam0/sensor.yaml").read_text())
    assert (camera["resolution"], camera["camera_model"]) == (list(SIZE), "pinhole")
    assert np.array_equal(np.reshape(camera["T_BS"]["data"], (4, 4)), np.eye(4))
    assert camera["distortion_coefficients"] == [0, 0, 0, 0]
    fu, fv, cu, cv = camera["intrinsics"]
    k = np.array([[fu, 0, cu], [0, fv, cv], [0, 0, 1]])
    assert (k == matrix_of(settings_of(folder / "orb_slam.yaml"))).all()
    assert [int(line) for line in (folder / "times.txt").read_text().split()] == STAMPS
    with (folder / "mav0/state_groundtruth_estimate0/data.csv").open() as file:
        poses = list(csv.reader(file))[1:]
    stored = {row["stamp_ns"]: row for row in rows_of(out) if row["sequence"] == folder.name}
    cameras = []
    for line, pose in zip((folder / "mav0/cam0/data.csv").read_text().splitlines()[1:], poses, strict=True):
        stamp, name = line.split(",")
        assert stamp == pose[0]
        assert len(pose) == 17
        rgb = (folder / "mav0/cam0/data" / name).read_bytes()
        # The stored WebP is converted: readers of this layout expect PNG.
        assert rgb.startswith(b"\x89PNG")
        assert stored[int(stamp)]["files"]["rgb"] == f"{folder.name}/mav0/cam0/data/{name}"
        depth = decode((folder / "mav0/depth0/data" / name).read_bytes()) / 1000
        mask = decode((folder / "mav0/instances0/data" / name).read_bytes())
        assert mask.max() > 0
        world = pose_of(pose[1:4], [*pose[5:8], pose[4]])
        cameras.append({"world": world, "k": k, "d": [0] * 5, "depth": depth})
    check_poses(cameras)
    moved = [(float(b) - float(a)) / (2 / 3) for a, b in zip(poses[0][1:4], poses[2][1:4], strict=True)]
    assert [float(value) for value in poses[1][8:11]] == pytest.approx(moved, rel=1e-6)
    pictures = fathom.open(out)
    folders = tmp_path / "folder"
    assert try_export(sequences, folders, "dive", "folder").returncode == 0
    exact = {(row["job"], row["frame"]): index for index, row in enumerate(rows_of(folders))}
    for index, row in enumerate(rows_of(out)):
        assert (pictures.read(index).rgb == fathom.open(folders).read(exact[row["job"], row["frame"]]).rgb).all()


def test_stereo_pairs_have_a_second_camera_at_the_baseline(sequences: str, tmp_path: Path) -> None:
    yaml = pytest.importorskip("yaml")
    out = export(sequences, tmp_path, "pair", "euroc", "--kinds", "rgb,range")
    folder = min(path for path in out.iterdir() if path.is_dir())
    right = yaml.safe_load((folder / "mav0/cam1/sensor.yaml").read_text())
    from_right = np.reshape(right["T_BS"]["data"], (4, 4))
    assert (from_right[:3, 3] == [BASELINE_M, 0, 0]).all()
    assert settings_of(folder / "orb_slam.yaml")["Camera.bf"] == pytest.approx(right["intrinsics"][0] * BASELINE_M)
    names = [row[1] for row in csv.reader((folder / "mav0/cam1/data.csv").open())][1:]
    assert names == [f"{stamp}.png" for stamp in STAMPS]
    assert all((folder / "mav0/cam1/data" / name).is_file() for name in names)
    plain = tmp_path / "folder"
    assert try_export(sequences, plain, "pair", "folder", "--kinds", "rgb,rgb_right,disparity").returncode == 0
    disparity = np.load(next(plain.glob("*/0/disparity.npy")))[:, :, 0]
    depth = decode((folder / "mav0/depth0/data" / names[0]).read_bytes()) / 1000
    valid = depth > 0
    expected = right["intrinsics"][0] * BASELINE_M / depth[valid]
    assert np.abs(disparity[valid] - expected).max() < 0.02
    kitti = export(sequences, tmp_path, "pair", "kitti")
    matrices = [line.split() for line in (kitti / "sequences/00/calib.txt").read_text().splitlines()]
    assert [line[0] for line in matrices] == ["P0:", "P1:", "P2:", "P3:"]
    left, right_of = (np.array(matrices[index][1:], float).reshape(3, 4) for index in (2, 3))
    assert right_of[0, 3] == pytest.approx(-left[0, 0] * BASELINE_M)
    for side, kind in (("image_2", "rgb"), ("image_3", "rgb_right")):
        pictures = sorted(path.read_bytes() for path in (kitti / "sequences/00" / side).iterdir())
        assert pictures == sorted(path.read_bytes() for path in plain.glob(f"*/*/{kind}.png"))


def test_kitti_poses_lead_to_the_axes_of_the_first_frame(sequences: str, tmp_path: Path) -> None:
    out = export(sequences, tmp_path, "dive", "kitti", "--kinds", "rgb,range")
    assert sorted(path.name for path in (out / "sequences").iterdir()) == ["00", "01"]
    assert {row["sequence"].rsplit("-", 1)[1] for row in rows_of(out)} == {"0", "1"}
    for number in ("00", "01"):
        folder = out / "sequences" / number
        poses = np.loadtxt(out / "poses" / f"{number}.txt").reshape(-1, 3, 4)
        assert np.abs(poses[0] - np.eye(4)[:3]).max() < 1e-12
        assert np.loadtxt(folder / "times.txt") == pytest.approx([0, 1 / 3, 2 / 3], abs=1e-9)
        k = np.array((folder / "calib.txt").read_text().splitlines()[2].split()[1:], float).reshape(3, 4)[:, :3]
        cameras: list[dict[str, Any]] = []
        for index, pose in enumerate(poses):
            assert (folder / "image_2" / f"{index:06}.png").read_bytes().startswith(b"\x89PNG")
            depth = decode((folder / "depth_2" / f"{index:06}.png").read_bytes()) / 256
            world = np.vstack([pose, [0, 0, 0, 1]])
            cameras.append({"world": world, "k": k, "d": [0] * 5, "depth": depth})
        # The world of the first camera is level with it, so its inverse is itself: compare later frames.
        check_poses(cameras[1:])


@pytest.mark.parametrize("format", FORMATS)
def test_parts_hold_whole_sequences_and_cards_are_valid(
    sequences: str, tmp_path: Path, format: str, no_torch: None
) -> None:
    croissant = pytest.importorskip("mlcroissant")
    out = export(sequences, tmp_path, "dive", format, "--split", "train=.5,val=.5")
    parts = [rows_of(out / part) for part in ("train", "val")]
    assert sorted(len(rows) for rows in parts) == [0, 6], "both sequences show the same scene"
    dataset = croissant.Dataset(jsonld=str(out / "croissant.json"))
    assert not dataset.metadata.issues.errors
    assert "z_depth" not in (out / "README.md").read_text().split("Each image has")[1].split(".")[0] or format == "tum"


def test_what_a_format_cannot_describe_is_refused_before_a_file_is_written(sequences: str, tmp_path: Path) -> None:
    for dataset, format, options, parts in [
        ("lens", "kitti", [], ["3 of 3 images", "kitti has no distortion", "tum, mcap or colmap"]),
        ("port", "euroc", [], ["euroc has no coefficient k3"]),
        ("port", "kitti", [], ["kitti has no distortion"]),
        ("zoom", "tum", [], ["`range`"]),
        ("zoom", "euroc", [], ["`camera.hfov_deg`", "choose the format mcap"]),
        ("dive", "mcap", ["--kinds", "range"], ["begins with range"]),
        ("dive", "kitti", ["--kinds", "rgb,boxes"], ["not boxes"]),
        ("pair", "tum", ["--kinds", "rgb,disparity"], ["not disparity"]),
        ("dive", "mcap", ["--shard-size", "3"], ["has no shards"]),
    ]:
        out = tmp_path / f"{dataset}-{format}-{len(options)}"
        ended = try_export(sequences, out, dataset, format, *options)
        assert ended.returncode == 2, (dataset, format, ended.stderr)
        assert all(part in ended.stderr for part in parts), ended.stderr
        assert not out.exists()
    assert export(sequences, tmp_path, "lens", "euroc").is_dir()
    assert export(sequences, tmp_path, "zoom", "mcap").is_dir()


@pytest.mark.parametrize(
    ("names", "stamps"),
    [
        (["1403636579.763555584", "1403636579.813555456"], [1_403_636_579_763_555_584, 1_403_636_579_813_555_456]),
        (["1403636579763555584", "1403636579813555456"], [1_403_636_579_763_555_584, 1_403_636_579_813_555_456]),
        (["frame-1", "frame-2"], [1_000_000_000, 1_040_000_000]),
    ],
)
def test_uploaded_scenes_have_the_times_of_their_names(
    server: str, tmp_path: Path, names: list[str], stamps: list[int]
) -> None:
    collection = f"recorded-{names[0][:12].strip('.')}{len(names[0])}"
    with fathom.Client(server, token="secret") as client:
        for index, name in enumerate(names):
            pose = np.eye(4)
            pose[0, 3] = index
            value = 40 * index + len(names[0])
            client.upload(
                np.full((8, 12, 3), value, np.uint8), focal_px=10, pose=pose, collection=collection, name=name
            )
        scene = {"kind": "collection", "name": collection, "each": True}
        job = {"dataset": collection, "scene": scene, "enhance": ["hscm"]}
        assert client.submit(job).wait().state["state"] == "done"
    out = export(server, tmp_path, collection, "euroc")
    folder = next(path for path in out.iterdir() if path.is_dir())
    assert [int(line) for line in (folder / "times.txt").read_text().split()] == stamps
    poses = list(csv.reader((folder / "mav0/state_groundtruth_estimate0/data.csv").open()))[1:]
    assert [float(pose[1]) for pose in poses] == [0, 1]
