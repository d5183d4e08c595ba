from __future__ import annotations

import asyncio
import subprocess
import sys
import time
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import description
from fathom.client import connection
from service_stand_in import LOCKED, reply_json, serve

STATE: dict[str, Any] = {
    "id": "job_" + "0" * 32,
    "dataset": "a",
    "state": "done",
    "frames": 1,
    "done": 1,
    "failed": 0,
    "version": 3,
}
SCENE = {"id": "scn_1", "width": 4, "height": 4, "rgb_digest": "", "created_at": "", "summary": None}


def _respond_after(refusals: int) -> Any:
    def respond(method: str, target: str, earlier: int) -> Any:
        if earlier < refusals:
            return LOCKED
        return reply_json(201, SCENE if target == "/v1/scenes" else STATE)

    return respond


def test_no_service_is_an_error_with_address_and_remedy() -> None:
    address = "http://127.0.0.1:9"
    with pytest.raises(fathom.FathomError, match=rf"no service responds at {address}: .*`fathom serve`") as caught:
        fathom.Client(address).images()
    assert isinstance(caught.value, fathom.Unreachable)
    assert isinstance(caught.value, ConnectionError)

    async def run() -> None:
        async with fathom.AsyncClient(address) as client:
            await client.jobs()

    with pytest.raises(fathom.Unreachable, match=address):
        asyncio.run(run())


@pytest.mark.parametrize("address", ["ftp://lab", "http://", "http://lab:port"])
def test_an_address_that_is_no_url_is_refused(address: str) -> None:
    with pytest.raises(fathom.FathomError, match="must be a URL such as"):
        fathom.Client(address)


def test_an_address_without_scheme_is_http() -> None:
    with serve(_respond_after(0)) as service:
        assert fathom.Client(service.address.removeprefix("http://")).job(STATE["id"]).id == STATE["id"]


def test_another_program_at_the_address_is_reported() -> None:
    page = (200, {"content-type": "text/html"}, b"<html>")
    with serve(lambda *_: page) as other, pytest.raises(fathom.FathomError, match="text/html, not JSON"):
        fathom.Client(other.address).images()


def test_a_locked_catalogue_is_waited_for() -> None:
    picture = np.zeros((4, 4, 3), np.uint8)
    with serve(_respond_after(2)) as service:
        begun = time.monotonic()
        assert fathom.Client(service.address).submit(description()).id == STATE["id"]
        assert 1.9 < time.monotonic() - begun < 10
        assert len(service.requests) == 3
        assert len(set(service.bodies)) == 1
    with serve(_respond_after(1)) as service:
        assert fathom.Client(service.address).upload(picture) == "scn_1"
        assert len(service.requests) == 2
    with serve(_respond_after(1)) as service:

        async def run() -> str:
            async with fathom.AsyncClient(service.address) as client:
                assert await client.upload(picture) == "scn_1"
                return (await client.submit(description())).id

        assert asyncio.run(run()) == STATE["id"]
        assert len(service.requests) == 3


def test_patience_has_an_end(monkeypatch: pytest.MonkeyPatch) -> None:
    assert connection.PATIENCE_S == 60
    with serve(lambda *_: LOCKED) as service:
        client = fathom.Client(service.address)
        # Longer than a first attempt takes under load; the pause is cut to what is left of it.
        attempts = connection.Attempts(0.9)
        monkeypatch.setattr("fathom.client.connection.Attempts", lambda _: attempts)
        monkeypatch.setattr("fathom.client.sync.Attempts", lambda _: attempts)
        with pytest.raises(fathom.Problem) as caught:
            client.submit(description())
        assert caught.value.status == 503
        assert len(service.requests) == 2


def test_other_failures_are_not_repeated() -> None:
    for reply in (reply_json(500, {"title": "broken"}), reply_json(503, {"title": "no hint"})):
        with serve(lambda *_, reply=reply: reply) as service:
            with pytest.raises(fathom.Problem):
                fathom.Client(service.address).submit(description())
            assert len(service.requests) == 1


def test_a_locked_catalogue_does_not_delay_a_timeout() -> None:
    def respond(method: str, target: str, earlier: int) -> Any:
        return LOCKED if earlier else reply_json(201, STATE | {"state": "running", "done": 0})

    with serve(respond) as service:
        job = fathom.Client(service.address).submit(description())
        begun = time.monotonic()
        with pytest.raises(TimeoutError):
            job.wait(timeout=1)
        assert time.monotonic() - begun < 5


SCRIPT = """
import asyncio, gc, sys, fathom
address = sys.argv[1]

def use():
    fathom.Client(address).jobs()

async def use_async():
    client = fathom.AsyncClient(address)
    await asyncio.gather(client.jobs(), client.jobs())

async def use_twice():
    await use_async()
    await asyncio.sleep(0.1)
    await kept_async.jobs()

use()
gc.collect()
kept = fathom.Client(address)
kept.jobs()
kept_async = fathom.AsyncClient(address)
asyncio.run(use_async())
asyncio.run(use_twice())
asyncio.run(use_twice())
gc.collect()
print("end")
"""


def test_sockets_close_without_a_with_block() -> None:
    with serve(lambda *_: reply_json(200, {"items": [], "next_cursor": None})) as service:
        command = [sys.executable, "-W", "error::ResourceWarning", "-c", SCRIPT, service.address]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (ended.stdout, ended.stderr) == ("end\n", "")
