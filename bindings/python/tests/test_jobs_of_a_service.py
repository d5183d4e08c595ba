from __future__ import annotations

import asyncio
import inspect
import time
from typing import Any

import fathom
import pytest
from conftest import description
from fathom.client import AsyncSubmitted, Submitted


@pytest.fixture(scope="module")
def client(server: str) -> Any:
    with fathom.Client(server, token="secret") as client:
        yield client


@pytest.fixture(scope="module")
def tour(client: fathom.Client) -> Submitted:
    return client.submit(description(dataset="tour", count=2, seed=21)).wait()


@pytest.fixture
def endless(client: fathom.Client) -> Any:
    """Submit a job that ends with the test."""
    job = client.submit(description(dataset="endless", count=90_000, seed=int(time.monotonic() * 1000)))
    yield job
    job.cancel()


def test_jobs_and_datasets_are_listed(client: fathom.Client, tour: Submitted) -> None:
    assert tour.id in [job.id for job in client.jobs()]
    assert [job.id for job in client.jobs(dataset="tour", state="done")] == [tour.id]
    assert len(client.jobs(limit=1)) == 1
    assert {"name": "tour", "images": 2, "jobs": 1}.items() <= {row["name"]: row for row in client.datasets()}[
        "tour"
    ].items()


def test_a_job_is_found_by_the_start_of_its_id(client: fathom.Client, tour: Submitted) -> None:
    for start in (tour.id, tour.id[:-3], tour.id.removeprefix("job_")[:-2]):
        assert client.job(start).id == tour.id
    assert client.job(tour.id).wait().state["done"] == 2
    client.submit(description(dataset="other", count=1)).wait()
    with pytest.raises(fathom.InvalidArgument, match=r"`job_0` is the start of \d+ job ids"):
        client.job("job_0")
    with pytest.raises(fathom.InvalidArgument, match="the start of one"):
        client.job("job_")


def test_an_unknown_job_has_a_suggestion(client: fathom.Client, tour: Submitted) -> None:
    changed = tour.id[:-1] + ("0" if tour.id[-1] != "0" else "1")
    for call in (client.job, client.errors, client.cancel):
        with pytest.raises(fathom.Problem) as caught:
            call("job_f" + tour.id[5:20])
        assert caught.value.status == 404
        assert "the newest jobs are" in str(caught.value)
    for call in (client.job, client.errors, client.cancel):
        with pytest.raises(fathom.Problem, match=f"did you mean `{tour.id}`"):
            call(changed)


def test_an_unknown_dataset_is_an_error_with_a_suggestion(client: fathom.Client, tour: Submitted) -> None:
    calls: list[Any] = [
        client.dataset,
        client.seal,
        client.stats,
        lambda name: client.images(dataset=name),
        lambda name: client.jobs(dataset=name),
    ]
    for call in calls:
        with pytest.raises(fathom.Problem, match="no dataset `tuor` \\(did you mean `tour`\\?\\)") as caught:
            call("tuor")
        assert caught.value.status == 404
    with pytest.raises(fathom.Problem, match="no sealed version `tour@7`"):
        client.dataset("tour@7")
    assert len(client.dataset("tour", "seed = 0")) == 0


def test_waiting_ends_after_its_timeout_and_the_job_continues(client: fathom.Client, endless: Submitted) -> None:
    for timeout in (0, 1.2):
        begun = time.monotonic()
        with pytest.raises(TimeoutError, match="it continues") as caught:
            endless.wait(timeout=timeout)
        assert timeout <= time.monotonic() - begun < timeout + 3
        assert isinstance(caught.value, fathom.JobTimeout)
        assert isinstance(caught.value, fathom.FathomError)
        assert caught.value.state == endless.state
    assert client.job(endless.id).state["state"] == "running"
    assert client.cancel(endless.id[:-4]).state["state"] == "cancelled"
    assert endless.wait(timeout=5).state["state"] == "cancelled"


def test_a_finished_job_needs_no_time(client: fathom.Client, tour: Submitted) -> None:
    assert tour.wait(timeout=0).state["state"] == "done"


def test_failed_frames_are_rows(client: fathom.Client, tour: Submitted) -> None:
    assert client.errors(tour.id) == tour.errors() == []
    assert client.errors(tour.id[:-5]) == []


def test_both_clients_have_the_same_methods() -> None:
    for sync, other in ((fathom.Client, fathom.AsyncClient), (Submitted, AsyncSubmitted)):
        names = [name for name in dir(sync) if not name.startswith("_")]
        assert names == [name for name in dir(other) if not name.startswith("_")]
        for name in names:
            if inspect.isfunction(method := getattr(sync, name)):
                parameters = inspect.signature(method).parameters
                assert parameters == inspect.signature(getattr(other, name)).parameters, name


def test_the_async_client_lists_and_cancels(server: str, tour: Submitted) -> None:
    async def run() -> None:
        async with fathom.AsyncClient(server, token="secret") as client:
            assert tour.id in [job.id for job in await client.jobs()]
            assert "tour" in [row["name"] for row in await client.datasets()]
            with pytest.raises(fathom.Problem, match="did you mean `tour`"):
                await client.dataset("tuor")
            job = await client.submit(description(dataset="endless", count=80_000, seed=int(time.monotonic() * 1000)))
            with pytest.raises(TimeoutError):
                await job.wait(timeout=0)
            assert (await job.cancel()).state["state"] == "cancelled"
            assert await client.errors(job.id[:-2]) == await job.errors() == []
            assert (await client.job(job.id)).state == job.state

    asyncio.run(run())
