"""Exports of one, two, three and twelve images and of a grown dataset, opened by loaders and snippets of the docs."""

from __future__ import annotations

import io
import json
import os
import re
import runpy
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import BINARY, description

COUNTS = [1, 2, 3, 4, 12]
KINDS = ["rgb", "range", "instances", "boxes"]
FORMATS = ["folder", "hf", "webdataset", "parquet", "coco", "yolo"]
PAGE = Path(__file__).parents[3] / "docs" / "guide" / "exports.md"

# Hugging Face would ask its hub for what is on this disk.
os.environ |= {"HF_HUB_OFFLINE": "1", "HF_DATASETS_OFFLINE": "1"}

Submit = Callable[..., None]


@pytest.fixture(scope="module")
def submit(server: str) -> Submit:
    """Return a function that gives a dataset this many images."""

    def run(dataset: str, count: int, **more: Any) -> None:
        labels = {"depth": {"uniform": [1, 120]}, "night": {"choice": [True, False]}} | more
        job = description(dataset=dataset, count=count, artifacts=KINDS, metrics=["uiqm"], labels=labels)
        with fathom.Client(server, token="secret") as client:
            assert client.submit(job).wait().state["state"] == "done"

    return run


def export(server: str, dataset: str, out: Path, format: str, *options: str) -> None:
    command = [BINARY, "export", dataset, "--format", format, "--out", str(out), "--server", server, *options]
    subprocess.run(command, check=True, env=os.environ | {"FATHOM_TOKEN": "secret"}, capture_output=True, text=True)


def snippet(section: str) -> str:
    """Return the Python of a section of the page on exports."""
    text = PAGE.read_text().split(f"\n## {section}\n")[1].split("\n## ")[0]
    return str(re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0])


def run_snippet(section: str, place: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Run the Python of a section in a folder, and return its names."""
    monkeypatch.chdir(place)
    file = place / "snippet.py"
    file.write_text(snippet(section))
    return runpy.run_path(str(file))


@pytest.mark.parametrize("count", COUNTS)
def test_load_dataset_opens_every_format_of_every_size(
    server: str, submit: Submit, tmp_path: Path, no_torch: None, count: int
) -> None:
    datasets = pytest.importorskip("datasets")
    submit(f"sized{count}", count)
    for format in FORMATS:
        out = tmp_path / format
        export(server, f"sized{count}", out, format)
        rows = datasets.load_dataset(str(out), cache_dir=str(tmp_path / "cache"))["train"]
        assert len(rows) == count, format


@pytest.mark.parametrize("count", COUNTS)
def test_the_snippets_of_the_page_keep_every_value(
    server: str, submit: Submit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, no_torch: None, count: int
) -> None:
    pytest.importorskip("webdataset")
    pytest.importorskip("datasets")
    submit(f"shown{count}", count)
    export(server, f"shown{count}", tmp_path / "tars", "webdataset", "--kinds", "rgb,range,instances")
    sample = run_snippet("webdataset", tmp_path, monkeypatch)["sample"]
    frames = fathom.open(tmp_path / "tars")
    stored = frames.read(count - 1, ["rgb", "range", "instances"])
    codes = np.asarray(sample["range.png"])
    assert codes.dtype == np.uint16
    valid = ~np.isnan(stored.range_m)
    assert np.allclose(codes[valid] / 1000, stored.range_m[valid])
    assert (np.asarray(sample["instances.png"]) == stored.instances).all()
    assert np.asarray(sample["rgb.png"]).shape == stored.rgb.shape

    monkeypatch.setenv("HF_HOME", str(tmp_path / "home"))
    export(server, f"shown{count}", tmp_path / "table", "parquet")
    export(server, f"shown{count}", tmp_path / "hf", "hf", "--kinds", "rgb,range")
    names = run_snippet("parquet and hf", tmp_path, monkeypatch)
    assert (len(names["images"]), names["table"].num_rows) == (count, count)


def test_a_grown_dataset_is_exported_into_the_same_folder(
    server: str, submit: Submit, tmp_path: Path, no_torch: None
) -> None:
    datasets = pytest.importorskip("datasets")
    submit("grown", 5)
    for format in FORMATS:
        export(server, "grown", tmp_path / format, format)
        rows = datasets.load_dataset(str(tmp_path / format), cache_dir=str(tmp_path / "cache"))["train"]
        assert len(rows) == 5, format
    submit("grown", 11)
    for format in FORMATS:
        export(server, "grown", tmp_path / format, format)
        rows = datasets.load_dataset(str(tmp_path / format), cache_dir=str(tmp_path / "cache"))["train"]
        with fathom.Client(server, token="secret") as client:
            total = len(client.images("", dataset="grown", fields=["frame"]))
        assert len(rows) == total, format


def test_labels_have_typed_columns_in_parquet(server: str, submit: Submit, tmp_path: Path) -> None:
    dataset = pytest.importorskip("pyarrow.dataset")
    submit("typed", 12, mixed={"choice": [1.5, "deep"]})
    export(server, "typed", tmp_path / "table", "parquet")
    table = dataset.dataset(tmp_path / "table" / "data").to_table()
    names = ["labels.depth", "labels.night", "labels.mixed", "labels.mixed (text)"]
    types = {name: str(table.schema.field(name).type) for name in names}
    assert types == dict(zip(names, ["double", "bool", "double", "string"], strict=True))
    with fathom.Client(server, token="secret") as client:
        rows = client.images("", dataset="typed", fields=["frame", "labels.depth", "labels.mixed", "labels.night"])
    for row, stored in zip(rows, table.to_pylist(), strict=True):
        assert (row["labels.depth"], row["labels.night"]) == (stored["labels.depth"], stored["labels.night"])
        mixed = [stored["labels.mixed"], stored["labels.mixed (text)"]]
        assert row["labels.mixed"] in mixed
        assert mixed.count(None) == 1


def test_every_value_is_equal_in_every_table(server: str, submit: Submit, tmp_path: Path, no_torch: None) -> None:
    datasets = pytest.importorskip("datasets")
    dataset = pytest.importorskip("pyarrow.dataset")
    labels = {"exact": 41.22242330660449, "whole": 2**53, "yes": True, "text": 'a "b", c'}
    job = description(dataset="tables", count=3, seed=2**63 - 1, artifacts=["rgb"], metrics=["uiqm"], labels=labels)
    job["camera"] |= {"hfov_deg": 60}
    with fathom.Client(server, token="secret") as client:
        assert client.submit(job).wait().state["state"] == "done"
        rows = client.images("", dataset="tables", order_by="frame")
    export(server, "tables", tmp_path / "folder", "folder")
    export(server, "tables", tmp_path / "parquet", "parquet")
    export(server, "tables", tmp_path / "hf", "hf")
    (tmp_path / "job.json").write_text(json.dumps(job))
    command = [BINARY, "render", str(tmp_path / "job.json"), "--out", str(tmp_path / "set"), "--frames-per-shard", "2"]
    subprocess.run(command, check=True, capture_output=True)
    lines = (tmp_path / "folder" / "metadata.jsonl").read_text().splitlines()
    tables = {
        "folder": [json.loads(line) for line in lines],
        "parquet": dataset.dataset(tmp_path / "parquet" / "data").to_table().to_pylist(),
        "hf": datasets.load_dataset(str(tmp_path / "hf"), cache_dir=str(tmp_path / "cache"))["train"].to_list(),
        "set": dataset.dataset(tmp_path / "set" / "rows").to_table().to_pylist(),
    }
    own = ("job", "created_ms", "total_ms", "timings", "worker", "artifacts", "attempt", "host")
    for format, table in tables.items():
        compared = 0
        for row, stored in zip(rows, sorted(table, key=lambda row: row["frame"]), strict=True):
            for name, value in row.items():
                if name.startswith(own) or isinstance(value, list | dict) or name not in stored:
                    continue
                assert stored[name] == value, (format, name)
                assert isinstance(stored[name], bool) == isinstance(value, bool), (format, name)
                compared += value is not None
        assert compared > 3 * 40, (format, compared)
        first = min(table, key=lambda row: row["frame"])
        found = {name: first[f"labels.{name}"] for name in labels}
        assert found == labels, format
        assert (first["seed"], first["camera.hfov_deg"]) == (2**63 - 1, 60), format


def test_numbers_that_a_table_would_change_are_errors(server: str, submit: Submit, tmp_path: Path) -> None:
    submit("large", 1, whole=2**53 + 1)
    for format in ("parquet", "hf"):
        with pytest.raises(subprocess.CalledProcessError) as failed:
            export(server, "large", tmp_path / format, format)
        assert "labels.whole" in failed.value.stderr
        assert "--format folder" in failed.value.stderr
    export(server, "large", tmp_path / "folder", "folder")
    assert f'"labels.whole":{2**53 + 1}' in (tmp_path / "folder" / "metadata.jsonl").read_text()


@pytest.mark.parametrize("count", COUNTS)
def test_a_strict_loader_takes_every_yolo_box(server: str, submit: Submit, tmp_path: Path, count: int) -> None:
    submit(f"boxed{count}", count)
    export(server, f"boxed{count}", tmp_path / "yolo", "yolo")
    lines = [line for file in (tmp_path / "yolo").rglob("labels/**/*.txt") for line in file.read_text().splitlines()]
    boxes = np.loadtxt(io.StringIO("\n".join(lines)), ndmin=2)[:, 1:]
    for kind in (np.float64, np.float32):
        x, y, w, h = boxes.astype(kind).T
        edges = np.stack([x - w / 2, y - h / 2, x + w / 2, y + h / 2])
        assert edges.min() >= 0, kind
        assert edges.max() <= 1, kind
    albumentations = pytest.importorskip("albumentations")
    parameters = albumentations.BboxParams(format="yolo", label_fields=["classes"])
    flip = albumentations.Compose([albumentations.HorizontalFlip(p=1)], bbox_params=parameters)
    flip(image=np.zeros((64, 96, 3), np.uint8), bboxes=boxes.tolist(), classes=[0] * len(boxes))


def test_objects_are_selected_by_class_size_and_visibility(server: str, submit: Submit, tmp_path: Path) -> None:
    coco_tools = pytest.importorskip("pycocotools.coco")
    submit("selected", 3)

    def annotations(*options: str) -> list[dict[str, Any]]:
        out = tmp_path / "-".join(["coco", *options]).replace("--", "")
        export(server, "selected", out, "coco", *options)
        coco = coco_tools.COCO(str(out / "annotations.json"))
        return [found | {"name": coco.cats[found["category_id"]]["name"]} for found in coco.dataset["annotations"]]

    usual = annotations()
    assert usual
    assert all(found["name"] not in ("seabed", "lining") for found in usual)
    large = annotations("--min-pixels", "40")
    assert [found["area"] for found in large] == [found["area"] for found in usual if found["area"] >= 40]
    seen = annotations("--min-visibility", "0.5")
    assert len(seen) == sum((found["visibility"] or 0) >= 0.5 for found in usual)
    ground = annotations("--classes", "seabed")
    assert all(found["name"] == "seabed" for found in ground)
