from __future__ import annotations

import asyncio
import pickle
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import KINDS, description


@pytest.fixture(scope="module")
def client(server: str) -> Any:
    with fathom.Client(server, token="secret") as client:
        yield client


@pytest.fixture(scope="module")
def submitted(client: fathom.Client) -> Any:
    job = client.submit(description(), key="first").wait()
    assert job.state["state"] == "done", job.state
    return job


def test_a_service_stores_the_frames_that_are_rendered_here(
    client: fathom.Client, submitted: Any, job: fathom.Job
) -> None:
    assert submitted.state["done"] == 8
    for index in (0, 6):
        stored = client.frame(submitted.id, index)
        here = job.read(index, KINDS)
        assert list(stored.artifacts) == KINDS
        assert (stored.rgb == here.rgb).all()
        assert (stored.instances == here.instances).all()


def test_the_same_key_is_the_same_job(client: fathom.Client, submitted: Any, job: fathom.Job) -> None:
    assert client.submit(description(), key="first").id == submitted.id


def test_images_are_asked_for_by_filter(client: fathom.Client, submitted: Any) -> None:
    rows = client.images("uiqm > -1000", dataset="python", order_by="-uiqm", fields=["frame", "uiqm"])
    assert len(rows) == 8
    assert [row["uiqm"] for row in rows] == sorted((row["uiqm"] for row in rows), reverse=True)
    assert len(client.images(dataset="python", limit=3)) == 3
    with pytest.raises(fathom.Problem) as caught:
        client.images("nonsense ===")
    assert caught.value.status == 400


def test_rows_become_tables(client: fathom.Client, submitted: Any) -> None:
    rows = client.images(dataset="python", fields=["frame", "uiqm"])
    pandas = pytest.importorskip("pandas")
    assert isinstance(rows.to_pandas(), pandas.DataFrame)
    assert len(rows.to_pandas()) == 8
    pytest.importorskip("pyarrow")
    assert rows.to_arrow().num_rows == 8


def test_statistics_stand_side_by_side(client: fathom.Client, submitted: Any) -> None:
    job = description(dataset="beside", count=4, seed=8)
    client.submit(job).wait()
    whole = client.stats("python", "beside", metrics=["uiqm"])
    assert [(row["dataset"], row["metric"], row["count"]) for row in whole] == [
        ("python", "uiqm", 8),
        ("beside", "uiqm", 4),
    ]
    values = [row["uiqm"] for row in client.images(dataset="beside", fields=["uiqm"])]
    assert whole[1]["mean"] == pytest.approx(np.mean(values))
    bins = client.stats("python", metrics=["uiqm", "uciqe"], by=["water.optics", "water.range_scale:0.25"])
    assert {row["water.optics"] for row in bins} == {"jerlov-1C/williamson2022"}
    assert sum(row["count"] for row in bins if row["metric"] == "uiqm") == 8
    assert all((row["water.range_scale"] / 0.25).is_integer() for row in bins)
    with pytest.raises(fathom.Problem, match="nothing"):
        client.stats("python", by=["nothing"])


def test_frames_come_in_order_and_in_parallel(client: fathom.Client, submitted: Any) -> None:
    rows = client.images(dataset="python", order_by="frame")
    frames = list(client.frames(rows, ["rgb"], parallel=3))
    assert [frame.index for frame in frames] == list(range(8))
    assert [list(frame.artifacts) for frame in frames] == [["rgb"]] * 8


def test_a_dataset_opens_as_frames(client: fathom.Client, submitted: Any, job: fathom.Job) -> None:
    frames = fathom.open(client.dataset("python"))
    assert len(frames) == 8
    copy = pickle.loads(pickle.dumps(frames))
    assert (copy.read(3).rgb == job.read(3, ["rgb"]).rgb).all()
    assert len(fathom.Frames(frames, ["rgb"])[2:5]) == 3


def test_refusals_have_the_fields_of_the_problem(client: fathom.Client, server: str) -> None:
    with pytest.raises(fathom.InvalidJob) as caught:
        client.submit(description(alpha=2, seed=-1))
    assert {error.pointer for error in caught.value.errors} == {"/alpha", "/seed"}
    with pytest.raises(fathom.Problem) as refused:
        fathom.Client(server, token="wrong").images()
    assert refused.value.status == 401
    with pytest.raises(fathom.Problem) as unknown:
        client.frame("job_none", 0)
    assert unknown.value.status in (400, 404)


def test_arrays_are_uploaded_as_scenes(client: fathom.Client, job: fathom.Job) -> None:
    air = job.read(0, ["clean", "range", "instances"])
    scene = client.upload(air.clean, range=air.range_m, instances=air.instances, hfov_deg=80)
    uploaded = description(
        dataset="uploaded", count=1, camera={}, scene={"kind": "uploaded", "id": scene}, artifacts=["rgb", "instances"]
    )
    made = client.submit(uploaded).wait()
    assert made.state["state"] == "done"
    assert (client.frame(made.id, 0).instances == air.instances).all()


def test_classes_of_an_upload_name_its_boxes(client: fathom.Client) -> None:
    mask = np.repeat(np.array([[0, 1, 2, 2]], np.uint8), 16, axis=1)
    mask = np.repeat(mask, 32, axis=0)
    picture = np.full((*mask.shape, 3), 90, np.uint8)
    scene = client.upload(picture, instances=mask, classes={1: "pile", 2: "rope"})
    job = {"dataset": "classes", "scene": {"kind": "uploaded", "id": scene}, "artifacts": ["semantics", "boxes"]}
    frame = client.frame(client.submit(job).wait().id, 0)
    assert [box["category"] for box in frame.boxes] == ["pile", "rope"]
    assert np.unique(frame.semantics).tolist() == [0, 2, 128]


def test_a_collection_gives_every_scene_its_frames(client: fathom.Client) -> None:
    shades = {"a": 40, "b": 90, "c": 140}
    for name, shade in shades.items():
        client.upload(np.full((12, 16, 3), shade, np.uint8), collection="shades", name=name)
    job = {"dataset": "shades", "count": 2, "scene": {"kind": "collection", "name": "shades"}, "metrics": []}
    made = client.submit(job).wait()
    assert made.state["done"] == 6
    codes = [int(client.frame(made.id, number).rgb[0, 0, 0]) for number in range(6)]
    assert codes == [*shades.values(), *shades.values()]
    with pytest.raises(fathom.InvalidJob, match="needs a range, which scene `scn_"):
        client.submit(job | {"artifacts": ["rgb", "range"]})
    with pytest.raises(fathom.InvalidJob, match="needs a service"):
        fathom.Job(job)


def test_arrays_that_are_no_scene_are_refused(client: fathom.Client) -> None:
    with pytest.raises(ValueError, match="rgb has 1 samples that are not finite"):
        client.upload(np.array([[[np.nan, 0.0, 0.0]]], np.float32))
    with pytest.raises(ValueError, match=r"rgb has shape \(2, 2, 2\)"):
        client.upload(np.zeros((2, 2, 2), np.float32))
    with pytest.raises(ValueError, match=r"rgb has shape \(5,\)"):
        client.upload(np.zeros(5, np.uint8))


def test_the_async_client_does_the_same(server: str, job: fathom.Job) -> None:
    async def run() -> list[fathom.Frame]:
        async with fathom.AsyncClient(server, token="secret") as client:
            made = await client.submit(description(dataset="async", count=4))
            assert (await made.wait(progress=False)).state["done"] == 4
            rows = await client.images(dataset="async", order_by="frame")
            assert len(fathom.open(await client.dataset("async"))) == 4
            return [frame async for frame in client.frames(rows, ["rgb"], parallel=2)]

    frames = asyncio.run(run())
    assert [frame.index for frame in frames] == [0, 1, 2, 3]
    assert (frames[2].rgb == job.read(2, ["rgb"]).rgb).all()


def test_an_export_opens_as_frames(server: str, submitted: Any, job: fathom.Job, tmp_path: Path) -> None:
    import subprocess
    import sys

    command = [sys.executable, "-m", "fathom", "export", "python", "--out", str(tmp_path / "set")]
    options = ["--kinds", "rgb,range", "--server", server, "--token", "secret"]
    subprocess.run([*command, *options], check=True, capture_output=True)
    frames = fathom.open(tmp_path / "set")
    assert len(frames) == 8
    frame = frames.read(2)
    assert set(frame.artifacts) == {"rgb", "range"}
    assert (frame.rgb == job.read(frame.index, ["rgb"]).rgb).all()
