"""Control, dry runs, deletion and verification over a client."""

from __future__ import annotations

import asyncio
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import description, run_service
from fathom import _native
from fathom.client import Scene, Submitted
from service_stand_in import Reply, reply_json, serve

# Bytes that no other test uploads: the service is shared, and equal files are one scene.
PICTURE = np.random.default_rng(77).integers(0, 99, (12, 16, 3), np.uint8)
WATER = {
    "name": "dock-7",
    "source": "our transmissometer",
    "wavelength_nm": [650, 532, 450],
    "absorption_per_m": [0.42, 0.2, 0.5],
    "scattering_per_m": [1.0, 1.1, 1.3],
    "diffuse_attenuation_per_m": [0.6, 0.4, 0.8],
}


@pytest.fixture(scope="module")
def client(server: str) -> Any:
    with fathom.Client(server, token="secret") as client:
        yield client


@pytest.fixture(scope="module")
def sealed(client: fathom.Client) -> Submitted:
    """Render and seal a small dataset."""
    job = client.submit(description(dataset="managed", count=2, seed=31)).wait()
    assert client.seal("managed")["name"] == "managed@1"
    return job


def _seed() -> int:
    return int(time.monotonic() * 1000)


def test_a_job_is_paused_resumed_and_deleted(client: fathom.Client) -> None:
    job = client.submit(description(dataset="paused", count=90_000, seed=_seed()))
    assert job.pause().state["state"] == "paused"
    assert client.resume(job.id[:-3]).state["state"] in ("queued", "running")
    assert client.pause(job.id).state["state"] == "paused"
    assert job.resume().state["state"] in ("queued", "running")
    job.cancel()
    with pytest.raises(fathom.Problem) as late:
        job.pause()
    assert late.value.status == 409
    assert job.delete()["jobs"] == 1
    for call in (job.delete, job.resume):
        with pytest.raises(fathom.Problem, match=f"no job `{job.id}`") as caught:
            call()
        assert caught.value.status == 404


def test_an_ended_job_is_rendered_again_or_finished(client: fathom.Client) -> None:
    job = client.submit(description(dataset="ended", count=1, seed=33)).wait()
    assert job.start_again().wait().state["done"] == 1
    assert client.start_again(job.id[:-3]).wait().state["done"] == 1
    for call in (job.retry, lambda: client.retry(job.id), lambda: client.finish_elsewhere(job.id)):
        with pytest.raises(fathom.Problem, match="is done") as caught:
            call()
        assert caught.value.status == 409


def test_failed_frames_are_tried_again() -> None:
    job_id = "job_" + "0" * 32

    def respond(method: str, target: str, earlier: int) -> Reply:
        return reply_json(200, {"id": job_id, "dataset": "tour", "state": "running"})

    with serve(respond) as stand_in:
        client = fathom.Client(stand_in.address)
        assert client.retry(job_id).retry().state["state"] == "running"
        asyncio.run(fathom.AsyncClient(stand_in.address).retry(job_id))
    assert stand_in.requests == [("POST", f"/v1/jobs/{job_id}/retry-failed")] * 3


def test_a_dry_run_has_the_price_and_submits_nothing(client: fathom.Client) -> None:
    before = [job.id for job in client.jobs()]
    found = client.dry_run(description(dataset="dry", count=500), frames=2)
    assert found["frames"] == 500
    assert found["estimate"]["slot_seconds"] > 0
    assert found["estimate"]["bytes"] > 0
    assert [frame["frame"] for frame in found["first"]] == [0, 1]
    assert client.dry_run(fathom.Job(description()))["first"] == []
    with pytest.raises(fathom.InvalidJob) as caught:
        client.dry_run(description(alpha=2))
    assert [error.pointer for error in caught.value.errors] == ["/alpha"]
    assert [job.id for job in client.jobs()] == before


def test_a_job_is_rendered_again_on_request(client: fathom.Client, sealed: Submitted) -> None:
    again = client.submit(description(dataset="managed", count=2, seed=31), again=True).wait()
    assert again.id != sealed.id
    again.delete()


def test_a_sealed_version_is_verified(client: fathom.Client, sealed: Submitted) -> None:
    [version] = client.versions("managed")
    found = client.verify("managed@1", read_bytes=True)
    assert found["intact"]
    assert found["root"] == found["computed"] == version["root"]
    assert (found["images"], found["artifacts"]) == (2, 14)
    with pytest.raises(
        fathom.InvalidArgument, match=r"must be a sealed version such as managed@1, which `client\.versions"
    ):
        client.verify("managed")
    for call in (client.verify, client.delete):
        with pytest.raises(fathom.Problem, match=r"no sealed version `managed@7`.*are managed@1"):
            call("managed@7")
    with pytest.raises(fathom.Problem, match="did you mean `managed`"):
        client.versions("manged")


def test_a_dataset_is_deleted_after_its_seals(client: fathom.Client) -> None:
    client.submit(description(dataset="deleted", count=2, seed=32)).wait()
    client.seal("deleted")
    with pytest.raises(fathom.Problem) as kept:
        client.delete("deleted")
    assert kept.value.status == 409
    assert client.delete("deleted@1") == {"jobs": 0, "images": 0, "bytes": 0}
    gone = client.delete("deleted")
    assert (gone["jobs"], gone["images"]) == (1, 2)
    assert gone["bytes"] > 0
    with pytest.raises(fathom.Problem, match="no dataset `deleted`"):
        client.delete("deleted")


def test_scenes_and_collections_are_listed_and_deleted(client: fathom.Client) -> None:
    made = [client.upload(PICTURE + number, collection="pier", name=f"view-{number}") for number in range(3)]
    assert made[2] in client.scenes()
    assert len(client.scenes(limit=2)) == 2
    listed = client.scenes(collection="pier")
    assert listed == made
    assert [scene.name for scene in listed] == ["view-0", "view-1", "view-2"]
    assert client.scenes(collection="pier", limit=1) == made[:1]
    assert isinstance(listed[0], Scene)
    assert not listed[0].has_range
    assert repr(listed[0]) == f"<fathom.Scene {made[0]}: view-0, 16×12, no range>"
    client.delete_collection("pier")
    for call in (client.delete_collection, lambda name: client.scenes(collection=name)):
        with pytest.raises(fathom.Problem, match="no collection `pier`"):
            call("pier")
    assert client.delete(made[0])["images"] == 0
    assert made[0] not in client.scenes()


def test_waters_and_styles_are_listed_and_a_water_is_added(client: fathom.Client) -> None:
    assert "jerlov-1C/williamson2022" in [row["name"] for row in client.waters()]
    assert client.add_water(WATER)["name"] == "dock-7"
    assert "dock-7" in [row["name"] for row in client.waters()]
    with pytest.raises(fathom.Problem):
        client.add_water(WATER)
    assert "atlantic" in [row["name"] for row in client.styles(role="style")]
    assert "atlantic" not in [row["name"] for row in client.styles(role="metric")]


def test_a_contact_sheet_is_drawn(client: fathom.Client, sealed: Submitted, tmp_path: Path) -> None:
    sheet = client.sheet("managed", tmp_path / "sheet.png", kind="semantics", order_by="-uiqm", limit=1)
    assert sheet == tmp_path / "sheet.png"
    assert _native.decode(sheet.read_bytes()).shape[1] >= 320
    with pytest.raises(fathom.CommandError, match="did you mean `managed`") as caught:
        client.sheet("manged", tmp_path / "other.png")
    assert caught.value.status != 0


def test_the_async_client_manages_too(server: str, sealed: Submitted, tmp_path: Path) -> None:
    async def run() -> None:
        async with fathom.AsyncClient(server, token="secret") as client:
            job = await client.submit(description(dataset="endless", count=90_000, seed=_seed()), again=True)
            assert (await job.pause()).state["state"] == "paused"
            assert (await client.resume(job.id)).state["state"] in ("queued", "running")
            await job.cancel()
            assert (await job.delete())["jobs"] == 1
            assert (await client.dry_run(description(count=3)))["frames"] == 3
            assert (await client.verify("managed@1"))["intact"]
            assert [row["name"] for row in await client.versions("managed")] == ["managed@1"]
            scene = await client.upload(PICTURE + 99)
            assert scene in await client.scenes()
            await client.delete(scene)
            assert len(await client.waters()) > 3
            assert await client.imports() == []
            assert (await client.sheet("managed", tmp_path / "sheet.webp")).stat().st_size > 100

    asyncio.run(run())


@pytest.fixture
def importing(tmp_path: Path) -> Iterator[fathom.Client]:
    """Run a service that imports sharded datasets below a folder."""
    (tmp_path / "store").mkdir()
    with run_service(tmp_path / "data", "--store", str(tmp_path / "store"), "--workers", "0") as address:
        yield fathom.Client(address)


def test_a_sharded_dataset_is_imported(importing: fathom.Client, tmp_path: Path, monkeypatch: Any) -> None:
    job = tmp_path / "job.json"
    job.write_text(fathom.Job(description(dataset="shards", count=4)).canonical)
    command = [sys.executable, "-m", "fathom", "render", str(job), "--out", str(tmp_path / "store" / "set")]
    subprocess.run([*command, "--shard", "0/1", "--frames-per-shard", "2"], check=True, capture_output=True)
    monkeypatch.chdir(tmp_path / "store")
    imported = importing.import_dataset("set").wait(timeout=60)
    assert (imported.state["state"], imported.state["done"]) == ("done", 4)
    [row] = importing.imports()
    assert (row["url"], row["shards"], row["error"]) == (str(tmp_path / "store" / "set"), 2, None)
    assert len(importing.images(dataset="shards")) == 4
    assert importing.delete(imported.id)["images"] == 4
    assert importing.imports() == []
    with pytest.raises(fathom.Problem):
        importing.import_dataset(tmp_path / "elsewhere")


@pytest.mark.parametrize("followed", [False, True])
def test_an_error_of_an_import_ends_the_wait_or_is_a_warning(followed: bool) -> None:
    state = {"id": "job_" + "0" * 32, "dataset": "reef", "frames": 9, "done": 0, "failed": 0, "version": 1}
    state |= {"state": "running", "set": "s3://reef/tour"}
    view = {"job": state["id"], "url": "s3://reef/tour", "error": "000001.tar is damaged", "followed": followed}

    def respond(method: str, target: str, earlier: int) -> Reply:
        if target.startswith("/v1/jobs"):
            return reply_json(200, state | {"state": "done" if earlier > 5 else "running"})
        return reply_json(200, view)

    with serve(respond) as stand_in:
        client = fathom.Client(stand_in.address)
        if followed:
            with pytest.warns(UserWarning, match="damaged; the service tries again") as caught:
                assert client.import_dataset("s3://reef/tour").wait().state["state"] == "done"
            assert len(caught) == 1
        else:
            with pytest.raises(fathom.FathomError, match=r"the import of s3://reef/tour ended: 000001\.tar"):
                client.import_dataset("s3://reef/tour").wait()
    assert stand_in.requests[0] == ("POST", "/v1/sets")
