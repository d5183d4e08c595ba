"""Every format of an export, opened by the library that its users open it with."""

from __future__ import annotations

import asyncio
import hashlib
import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import BINARY, description
from numpy.typing import NDArray

SIZE = (96, 64)
KINDS = ["rgb", "range", "instances", "boxes"]
Export = Callable[..., Path]

# Hugging Face would ask its hub for what is on this disk.
os.environ |= {"HF_HUB_OFFLINE": "1", "HF_DATASETS_OFFLINE": "1"}


@pytest.fixture(scope="module")
def formats(server: str) -> str:
    """Render a set with labels and a set along a path, and return the service."""
    grid = {"grid": list(range(6))}
    labeled = description(
        dataset="labeled",
        count=1,
        scene={"kind": "procedural", "family": "structure", "seed": grid},
        artifacts=KINDS,
        labels={"run": "first"},
    )
    path = {"frames": 4, "sway_m": 0.05, "sway_deg": 8.0, "sway_frames": 5}
    followed = description(
        dataset="followed",
        count=4,
        scene={"kind": "procedural", "family": "structure", "seed": 3},
        camera={"width": SIZE[0], "height": SIZE[1], "path": path},
        water={"optics": {"grid": ["jerlov-IB", "jerlov-1C"]}},
        artifacts=KINDS,
    )
    with fathom.Client(server, token="secret") as client:
        for job in (labeled, followed):
            assert client.submit(job).wait().state["state"] == "done"
    return server


@pytest.fixture
def export(formats: str, tmp_path: Path) -> Export:
    def run(format: str, *options: str, dataset: str = "labeled", out: str = "out") -> Path:
        ended = try_export(formats, tmp_path / out, dataset, format, *options)
        assert ended.returncode == 0, ended.stderr
        check_sums(tmp_path / out)
        return tmp_path / out

    return run


def try_export(server: str, out: Path, dataset: str, format: str, *options: str) -> subprocess.CompletedProcess[str]:
    command = [BINARY, "export", dataset, "--format", format, "--out", str(out), "--server", server, *options]
    return subprocess.run(command, env=os.environ | {"FATHOM_TOKEN": "secret"}, capture_output=True, text=True)


def check_sums(folder: Path) -> None:
    """Check that every visible file stands in a list of digests with its own."""
    listed = set()
    for sums in folder.rglob("SHA256SUMS"):
        for line in sums.read_text().splitlines():
            digest, name = line.split("  ", 1)
            file = sums.parent / name
            assert hashlib.sha256(file.read_bytes()).hexdigest() == digest, file
            listed.add(file)
        listed.add(sums)
    files = {file for file in folder.rglob("*") if file.is_file() and not file.name.startswith(".")}
    assert files - listed == {folder / "export.json"}


def detected(boxes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the boxes that formats for detectors have by default."""
    return [box for box in boxes if box["category"] not in ("seabed", "lining")]


def rows_of(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "metadata.jsonl").read_text().splitlines()]


def fetched(ended: subprocess.CompletedProcess[str]) -> int:
    return int(ended.stdout.split("(")[1].split(" ")[0])


def test_webdataset_reads_the_shards(export: Export, no_torch: None) -> None:
    webdataset = pytest.importorskip("webdataset")
    out = export("webdataset", "--kinds", "rgb,boxes", "--shard-size", "4")
    assert sorted(file.name for file in out.glob("*.tar")) == ["000000.tar", "000001.tar"]
    shards = [str(out / name) for name in ("000000.tar", "000001.tar")]
    samples = list(webdataset.WebDataset(shards, shardshuffle=False))
    assert len(samples) == 6
    for index, sample in enumerate(samples):
        record = json.loads(sample["json"])
        assert sample["__key__"].rsplit("/", 1)[1] == f"{index:012}"
        assert (record["frame"], record["parameters"]["labels"]) == (index, {"run": "first"})
        digests = {artifact["kind"]: artifact["digest"] for artifact in record["artifacts"]}
        assert hashlib.sha256(sample["rgb.png"]).hexdigest() == digests["rgb"]
        assert json.loads(sample["boxes.json"])["instances"]


def test_shards_are_the_same_bytes_again_and_resumed_without_a_request(
    export: Export, formats: str, tmp_path: Path
) -> None:
    one = export("webdataset", "--shard-size", "4", out="one")
    other = export("webdataset", "--shard-size", "4", out="other")
    tars = {file.name: file.read_bytes() for file in one.glob("*.tar")}
    assert tars == {file.name: file.read_bytes() for file in other.glob("*.tar")}
    options = ("--shard-size", "4")
    assert fetched(try_export(formats, one, "labeled", "webdataset", *options)) == 0
    (one / "000001.tar").write_bytes(b"torn")
    assert fetched(try_export(formats, one, "labeled", "webdataset", *options)) == 4
    assert {file.name: file.read_bytes() for file in one.glob("*.tar")} == tars
    changed = try_export(formats, one, "labeled", "webdataset", "--shard-size", "5")
    assert changed.returncode == 2
    assert "another export" in changed.stderr


def test_shards_open_as_frames_here_and_at_a_url(export: Export, job: fathom.Job) -> None:
    out = export("webdataset", "--kinds", "rgb,range", "--shard-size", "4")
    folder = fathom.open(export("folder", "--kinds", "rgb,range", out="folder"))
    frames = fathom.open(out)
    assert len(frames) == len(folder) == 6
    for index in range(6):
        one, other = frames.read(index), folder.read(index)
        assert one.index == other.index
        assert (one.rgb == other.rgb).all()
        assert np.array_equal(one.range_m, other.range_m, equal_nan=True)
        assert one.record["scene"]["world_from_camera"]
    with pytest.raises(fathom.RenderError, match="no artifact `boxes`"):
        frames.read(0, ["boxes"])
    fsspec = pytest.importorskip("fsspec")
    fsspec.filesystem("memory").put(str(out) + "/", "/bucket/set/", recursive=True)
    there = fathom.open("memory://bucket/set")
    assert len(there) == 6
    assert (there.read(5).rgb == folder.read(5).rgb).all()


def test_a_list_cannot_lead_out_of_the_folder(export: Export) -> None:
    out = export("webdataset", "--shard-size", "4")
    row = rows_of(out)[0] | {"tar": "../secret.tar"}
    (out / "metadata.jsonl").write_text(json.dumps(row) + "\n")
    with pytest.raises(fathom.RenderError, match="not the name of a tar"):
        fathom.open(out)[0]


def test_the_coco_tools_read_masks_that_are_those_of_the_pictures(export: Export) -> None:
    coco_tools = pytest.importorskip("pycocotools.coco")
    out = export("coco", "--split", "train=.5,test=.5")
    names, found = set(), 0
    for part in ("train", "test"):
        coco = coco_tools.COCO(str(out / part / "annotations.json"))
        names.add(json.dumps(coco.dataset["categories"]))
        frames = fathom.open(out / part)
        assert len(coco.getImgIds()) == len(frames)
        for index, image in enumerate(coco.loadImgs(coco.getImgIds())):
            found += 1
            frame = frames.read(index, ["rgb", "instances", "boxes"])
            assert (image["width"], image["height"]) == SIZE
            assert (out / part / image["file_name"]).is_file()
            assert "video_id" not in image
            annotations = coco.loadAnns(coco.getAnnIds(imgIds=[image["id"]]))
            boxes = detected(frame.boxes)
            assert len(annotations) == len(boxes) > 0
            for annotation, box in zip(annotations, boxes, strict=True):
                mask = coco.annToMask(annotation)
                assert (mask == (frame.instances == annotation["instance"])).all()
                assert annotation["area"] == mask.sum()
                ys, xs = np.nonzero(mask)
                extent = [xs.min(), ys.min(), xs.max() - xs.min() + 1, ys.max() - ys.min() + 1]
                assert annotation["bbox"] == extent
                assert coco.cats[annotation["category_id"]]["name"] == box["category"]
                for name in ("visibility", "transmittance", "contrast", "range_m", "visible"):
                    assert annotation[name] == box.get(name), name
    assert found == 6
    assert len(names) == 1, "all parts have the same categories"


def test_an_object_keeps_its_track_along_a_path(export: Export) -> None:
    out = export("coco", dataset="followed")
    coco = json.loads((out / "annotations.json").read_text())
    assert len(coco["videos"]) == 2
    images = {image["id"]: image for image in coco["images"]}
    for video in coco["videos"]:
        frames = [image["frame_id"] for image in coco["images"] if image["video_id"] == video["id"]]
        assert frames == [0, 1, 2, 3]
    tracks: dict[int, set[tuple[int, int]]] = {}
    for annotation in coco["annotations"]:
        of = (images[annotation["image_id"]]["video_id"], annotation["instance"])
        tracks.setdefault(annotation["track_id"], set()).add(of)
    assert all(len(objects) == 1 for objects in tracks.values())
    assert len(tracks) == len({next(iter(objects)) for objects in tracks.values()})
    assert max(sum(a["track_id"] == track for a in coco["annotations"]) for track in tracks) == 4


def test_yolo_boxes_are_those_of_the_record(export: Export) -> None:
    yaml = pytest.importorskip("yaml")
    out = export("yolo", "--split", "train=.5,val=.5")
    data = yaml.safe_load((out / "data.yaml").read_text())
    assert list(data["names"]) == list(range(len(data["names"])))
    found = 0
    for part in ("train", "val"):
        frames = fathom.open(out / part)
        pictures = (out / data[part]).read_text().splitlines()
        assert len(pictures) == len(frames)
        for index, picture in enumerate(pictures):
            file = (out / data[part]).parent / picture
            assert file.is_file()
            # As YOLO finds the labels of a picture.
            labels = Path("/labels/".join(str(file).rsplit("/images/", 1))).with_suffix(".txt")
            lines = [line.split() for line in labels.read_text().splitlines()]
            boxes = detected(frames.read(index, ["boxes"]).boxes)
            assert [data["names"][int(line[0])] for line in lines] == [box["category"] for box in boxes]
            for line, box in zip(lines, boxes, strict=True):
                x, y, width, height = (float(value) for value in line[1:])
                scale = np.array([SIZE[0], SIZE[1]] * 2)
                edges = np.array([x - width / 2, y - height / 2, x + width / 2, y + height / 2]) * scale
                assert np.abs(edges - box["box"]).max() < 1e-3
            found += 1
    assert found == 6


def test_parquet_rows_hold_columns_and_files(export: Export, formats: str) -> None:
    dataset = pytest.importorskip("pyarrow.dataset")
    out = export("parquet", "--kinds", "rgb,range", "--shard-size", "4")
    table = dataset.dataset(out / "data").to_table()
    rows = rows_of(out)
    assert (table.num_rows, len(rows)) == (6, 6)
    types = {name: str(table.schema.field(name).type) for name in ("seed", "failed", "frame", "uiqm", "rgb", "record")}
    assert types == {
        "seed": "uint64",
        "failed": "bool",
        "frame": "int64",
        "uiqm": "double",
        "rgb": "binary",
        "record": "string",
    }
    for index, row in enumerate(table.to_pylist()):
        assert hashlib.sha256(row["rgb"]).hexdigest() == row["artifacts.rgb"] == rows[index]["artifacts.rgb"]
        assert hashlib.sha256(row["range"]).hexdigest() == row["artifacts.range"]
        assert row["labels.run"] == "first"
        assert row["uiqm"] == rows[index]["uiqm"]
        assert isinstance(row["frame"], int)
        assert json.loads(row["record"])["frame"] == row["frame"] == index
    assert fetched(try_export(formats, out, "labeled", "parquet", "--kinds", "rgb,range", "--shard-size", "4")) == 0
    with pytest.raises(ValueError, match="Parquet"):
        fathom.open(out)


def test_hugging_face_loads_images_rows_and_parts(export: Export, tmp_path: Path, no_torch: None) -> None:
    datasets = pytest.importorskip("datasets")
    cache = str(tmp_path / "cache")
    out = export("hf", "--kinds", "rgb,range,boxes", "--split", "train=.5,test=.5")
    parts = datasets.load_dataset(str(out), cache_dir=cache)
    assert set(parts) == {"train", "test"}
    assert sum(len(part) for part in parts.values()) == 6
    row = parts["train"][0]
    assert (row["image"].size, row["range"].size) == (SIZE, SIZE)
    assert row["labels.run"] == "first"
    assert row["boxes"].endswith("boxes.json")
    whole = export("parquet", "--kinds", "rgb", out="parquet")
    loaded = datasets.load_dataset(str(whole), cache_dir=cache)["train"].cast_column("rgb", datasets.Image())
    assert loaded[0]["rgb"].size == SIZE
    shards = export("webdataset", "--kinds", "rgb", out="shards")
    assert len(datasets.load_dataset(str(shards), cache_dir=cache)["train"]) == 6


def range_of(out: Path, sequence: str, name: str) -> NDArray[np.float64]:
    from fathom import _native

    file = out / sequence / "images" / name.replace(".rgb.", ".range.")
    return np.asarray(_native.decode(file.read_bytes()), np.float64) / 1000


def reprojected(cameras: list[dict[str, Any]]) -> float:
    """Carry the points that one camera sees into another; return the share that are in view there, at their range.

    A camera has `world` (4x4 from its axes right, down, ahead), `f`, `cx`, `cy` with pixel centers at halves, and
    `range`. Points that leave the view or that something else hides do not count, but most are seen by both.
    """
    one, other = cameras
    height, width = one["range"].shape
    y, x = np.mgrid[0:height, 0:width]
    rays = np.stack([(x + 0.5 - one["cx"]) / one["f"], (y + 0.5 - one["cy"]) / one["f"], np.ones(x.shape)])
    rays /= np.linalg.norm(rays, axis=0)
    points = (rays * one["range"]).reshape(3, -1)[:, one["range"].ravel() > 0]
    world = one["world"][:3, :3] @ points + one["world"][:3, 3:]
    there = other["world"][:3, :3].T @ (world - other["world"][:3, 3:])
    u = there[0] / there[2] * other["f"] + other["cx"] - 0.5
    v = there[1] / there[2] * other["f"] + other["cy"] - 0.5
    column, row = np.rint(u).astype(int), np.rint(v).astype(int)
    inside = (there[2] > 0) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
    seen = other["range"][row[inside], column[inside]]
    expected = np.linalg.norm(there[:, inside], axis=0)
    return float(np.sum(np.abs(seen - expected) < 0.03 * expected) / inside.size)


def matrix_of(quaternion: NDArray[np.float64], shift: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the 4x4 matrix from the camera to the world of a pose of COLMAP, which leads the other way."""
    w, x, y, z = quaternion
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    world = np.eye(4)
    world[:3, :3], world[:3, 3] = turn.T, -turn.T @ shift
    return world


def test_poses_of_colmap_carry_points_from_frame_to_frame(export: Export) -> None:
    out = export("colmap", "--kinds", "rgb,range", dataset="followed")
    sequences = sorted(path.name for path in out.iterdir() if path.is_dir())
    assert len(sequences) == 2
    for sequence in sequences:
        model = out / sequence / "sparse" / "0"
        lens = (model / "cameras.txt").read_text().splitlines()[1].split()
        assert lens[1:4] == ["PINHOLE", str(SIZE[0]), str(SIZE[1])]
        f, fy, cx, cy = (float(value) for value in lens[4:])
        assert (f, cx, cy) == (fy, SIZE[0] / 2, SIZE[1] / 2)
        lines = [line.split() for line in (model / "images.txt").read_text().splitlines()[1:] if line]
        assert len(lines) == 4
        cameras: list[dict[str, Any]] = []
        for line in lines:
            assert (out / sequence / "images" / line[9]).is_file()
            pose = np.array(line[1:8], float)
            world = matrix_of(pose[:4], pose[4:])
            cameras.append({"world": world, "f": f, "cx": cx, "cy": cy, "range": range_of(out, sequence, line[9])})
        assert np.linalg.norm(cameras[0]["world"][:3, 3] - cameras[3]["world"][:3, 3]) > 0.1
        right = reprojected(cameras[:2])
        assert right > 0.6
        # Axes that are wrong in both frames, and poses that lead from the camera to the world, are noticed.
        flip = np.diag([1.0, -1.0, -1.0, 1.0])
        turned = [camera | {"world": camera["world"] @ flip} for camera in cameras[:2]]
        inverse = [camera | {"world": np.linalg.inv(camera["world"])} for camera in cameras[:2]]
        assert reprojected(turned) < 0.8 * right
        assert reprojected(inverse) < 0.8 * right
    assert len(fathom.open(out)) == 8


def test_transforms_of_nerfstudio_carry_points_from_frame_to_frame(export: Export) -> None:
    out = export("transforms", "--kinds", "rgb,range", dataset="followed")
    sequence = min(path.name for path in out.iterdir() if path.is_dir())
    file = json.loads((out / sequence / "transforms.json").read_text())
    cameras = []
    for frame in file["frames"]:
        assert (out / sequence / frame["file_path"]).is_file()
        assert (frame["w"], frame["h"], frame["fl_x"]) == (*SIZE, frame["fl_y"])
        # Right, up, back.
        world = np.array(frame["transform_matrix"]) @ np.diag([1.0, -1.0, -1.0, 1.0])
        values = {"f": frame["fl_x"], "cx": frame["cx"], "cy": frame["cy"]}
        cameras.append(values | {"world": world, "range": range_of(out, sequence, frame["file_path"].rsplit("/")[-1])})
    assert len(cameras) == 4
    assert reprojected(cameras[:2]) > 0.6
    up = np.array(file["frames"][0]["transform_matrix"])[2, 1]
    assert up > 0.5, "the up axis of a camera that is about level is up"


def test_what_a_dataset_cannot_give_is_refused_before_a_file_is_written(
    formats: str, server: str, tmp_path: Path
) -> None:
    plain = description(dataset="plain", count=2, artifacts=["rgb"])
    with fathom.Client(server, token="secret") as client:
        client.submit(plain).wait()
        for format, part in [
            ("coco", "no image of `plain` has an artifact `instances`, `boxes`"),
            ("yolo", "add it to `artifacts` of the job"),
            ("colmap", "2 of 2 images of `plain` cannot be exported: the format colmap is made of poses"),
            ("transforms", "/camera/path"),
        ]:
            ended = try_export(formats, tmp_path / format, "plain", format)
            assert (ended.returncode, part in ended.stderr) == (2, True), ended.stderr
            assert not (tmp_path / format).exists()
        # Some of the images have what is wanted: the message tells how to take those.
        client.submit(description(dataset="plain", count=1)).wait()
        ended = try_export(formats, tmp_path / "some", "plain", "coco")
        assert ended.returncode == 2
        assert "2 of 3 images" in ended.stderr
        condition = ended.stderr.split("--filter '")[1].split("'")[0]
        with_filter = try_export(formats, tmp_path / "some", "plain", "coco", "--filter", condition)
        assert with_filter.returncode == 0, with_filter.stderr


@pytest.mark.parametrize("format", ["folder", "webdataset", "parquet", "hf", "coco", "yolo"])
def test_cards_name_terms_units_and_classes(export: Export, format: str, no_torch: None) -> None:
    croissant = pytest.importorskip("mlcroissant")
    yaml = pytest.importorskip("yaml")
    out = export(format, "--kinds", "rgb,range,boxes", "--license", "cc-by-4.0", "--split", "train=.5,test=.5")
    readme = (out / "README.md").read_text()
    front = yaml.safe_load(readme.split("---\n")[1])
    assert (front["pretty_name"], front["license"]) == ("labeled", "cc-by-4.0")
    assert "| water jerlov-1C/" in readme
    assert "| train | " in readme
    fields = json.loads((out / "fields.json").read_text())
    assert fields["arrays"]["range"]["unit"] == "mm"
    assert fields["columns"]["camera.hfov_deg"] == {
        "kind": "number",
        "unit": "degree",
        "meaning": "horizontal field of view",
    }
    assert all(column["meaning"] for column in fields["columns"].values())
    assert {"id": 2, "name": "pile"} in fields["classes"]
    card = croissant.Dataset(jsonld=str(out / "croissant.json"))
    assert not card.metadata.ctx.issues.errors
    based_on = json.loads((out / "croissant.json").read_text())["isBasedOn"]
    assert all(source["license"] and source["description"] for source in based_on)
    found = 0
    for part in ("train", "test"):
        records = list(card.records(f"images-{part}"))
        found += len(records)
        digests = {record[f"images-{part}/artifacts.rgb"] for record in records}
        assert all(len(digest) == 64 for digest in digests)
    assert found == 6


def test_clients_export(formats: str, tmp_path: Path) -> None:
    with fathom.Client(formats, token="secret") as client:
        out = client.export("labeled", tmp_path / "out", format="webdataset", kinds=["rgb"], filter="frame < 3")
        assert len(fathom.open(out)) == 3

        async def again() -> Path:
            async with fathom.AsyncClient(formats, token="secret") as client:
                return await client.export("labeled", tmp_path / "other", kinds=["rgb"])

        assert len(fathom.open(asyncio.run(again()))) == 6
        with pytest.raises(fathom.CommandError, match="no dataset `nothing`") as caught:
            client.export("nothing", tmp_path / "none")
        assert caught.value.status == 2
        # What holds Parquet is made by the program for sets, which the wheel carries.
        parts = client.export("labeled", tmp_path / "hf", format="hf", split={"train": 0.5, "test": 0.5})
        assert (parts / "train" / "metadata.parquet").is_file()


def test_a_sealed_version_is_exported_as_it_was_sealed(formats: str, tmp_path: Path) -> None:
    job = description(dataset="sealed", count=2, artifacts=["rgb", "instances", "boxes"])
    with fathom.Client(formats, token="secret") as client:
        client.submit(job).wait()
        version = client.seal("sealed")
        assert (version["name"], version["images"], len(version["root"])) == ("sealed@1", 2, 64)
        client.submit(job | {"seed": 8}).wait()
        for format in ("folder", "webdataset", "parquet", "hf", "coco"):
            out = client.export("sealed@1", tmp_path / format, format=format)
            check_sums(out)
            assert len((out / "metadata.jsonl").read_text().splitlines() if format != "hf" else [0, 0]) == 2
        assert len(fathom.open(client.export("sealed", tmp_path / "all"))) == 4
        assert len(fathom.open(client.dataset("sealed@1"))) == 2


def test_poses_of_uploads_come_back_in_models(formats: str, tmp_path: Path) -> None:
    shots = tmp_path / "shots"
    shots.mkdir()
    frames = []
    for number in range(3):
        codes = np.full((12, 16, 3), 60 + 20 * number, np.uint8)
        (shots / f"{number}.png").write_bytes(fathom._native.encode_png(codes))
        matrix = [[1, 0, 0, float(number)], [0, 0, -1, 2.5], [0, 1, 0, -1], [0, 0, 0, 1]]
        frames.append({"file_path": f"images/{number}.png", "transform_matrix": matrix})
    (shots / "transforms.json").write_text(json.dumps({"frames": frames[:2]}))
    # What lies beside the picture in its own file: axes right, down, ahead.
    own: list[list[float]] = [[1, 0, 0, 2], [0, 0, 1, 2.5], [0, -1, 0, -1], [0, 0, 0, 1]]
    (shots / "2.pose.json").write_text(json.dumps({"world_from_camera": own}))
    upload = [BINARY, "upload", str(shots), "--pose", str(shots / "transforms.json"), "--collection", "way"]
    environment = os.environ | {"FATHOM_TOKEN": "secret"}
    options = ["--hfov-deg", "70", "--server", formats]
    ended = subprocess.run([*upload, *options], env=environment, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert "3 of 3 pictures have a pose" in ended.stderr
    with fathom.Client(formats, token="secret") as client:
        job = {"dataset": "way", "count": 2, "scene": {"kind": "collection", "name": "way"}, "artifacts": ["rgb"]}
        made = client.submit(job | {"metrics": []}).wait()
        assert made.state["done"] == 6, made.state
        record = client.frame(made.id, 2).record
        assert record["scene"]["world_from_camera"] == own
        out = client.export("way", tmp_path / "out", format="transforms")
        for sequence in (f"{made.id}-0", f"{made.id}-1"):
            model = json.loads((out / sequence / "transforms.json").read_text())
            matrices = [frame["transform_matrix"] for frame in model["frames"]]
            assert matrices[:2] == [frame["transform_matrix"] for frame in frames[:2]]
            assert matrices[2][0] == [1, 0, 0, 2]
            assert model["frames"][0]["w"] == 16
            assert all((out / sequence / frame["file_path"]).is_file() for frame in model["frames"])
        flat = client.upload(np.full((12, 16, 3), 8, np.uint8), hfov_deg=70)
        client.submit({"dataset": "flat", "scene": {"kind": "uploaded", "id": flat}, "metrics": []}).wait()
        with pytest.raises(fathom.CommandError, match=f"which the scenes `{flat}` lack"):
            client.export("flat", tmp_path / "flat", format="colmap")
        assert not (tmp_path / "flat").exists()
        # In Python the matrix is an array.
        picture = np.full((12, 16, 3), 9, np.uint8)
        scene = client.upload(picture, hfov_deg=70, pose=np.array(own))
        assert client.upload(picture, hfov_deg=70, pose=own) == scene != client.upload(picture, hfov_deg=70)
        with pytest.raises(fathom.Problem, match="right-handed"):
            client.upload(picture, pose=np.diag([-1.0, 1.0, 1.0, 1.0]))
        with pytest.raises(ValueError, match=r"shape \(3, 4\)"):
            client.upload(picture, pose=np.eye(4)[:3])


def test_png_files_name_their_unit(formats: str, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    kinds = ["rgb", "range", "instances"]
    with fathom.Client(formats, token="secret") as client:
        client.submit(description(dataset="telling", count=1, artifacts=kinds)).wait()
        out = client.export("telling", tmp_path / "out", kinds=kinds)
        with image.open(next(out.rglob("range.png"))) as file:
            assert file.text["Unit"] == "mm"
            assert "0 = hole" in file.text["Description"]
        with image.open(next(out.rglob("instances.png"))) as file:
            assert "Unit" not in file.text
            assert file.text["Software"] == "Fathom"
