from __future__ import annotations

import asyncio
from typing import Any

import fathom
import pytest
from fathom.client.proxies import find_proxy
from service_stand_in import reply_json, serve

EMPTY = reply_json(200, {"items": [], "next_cursor": None})
VARIABLES = ["http_proxy", "https_proxy", "all_proxy", "no_proxy"]
# A name that no network resolves.
LAB = "http://fathom.invalid:7311"


@pytest.fixture(autouse=True)
def clean(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)


def _list(server: str) -> list[Any]:
    return fathom.Client(server).jobs()


def _list_async(server: str) -> list[Any]:
    async def run() -> list[Any]:
        async with fathom.AsyncClient(server) as client:
            return await client.jobs()

    return asyncio.run(run())


@pytest.fixture(params=[_list, _list_async], ids=["sync", "async"])
def list_jobs(request: pytest.FixtureRequest) -> Any:
    return request.param


def test_requests_use_the_proxy(monkeypatch: pytest.MonkeyPatch, list_jobs: Any) -> None:
    for variable in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"):
        with serve(lambda *_: EMPTY) as proxy, monkeypatch.context() as patch:
            patch.setenv(variable, proxy.address)
            assert list_jobs(LAB) == []
            assert proxy.requests[0][1].startswith(f"{LAB}/v1/jobs")


def test_loopback_has_no_proxy(monkeypatch: pytest.MonkeyPatch, list_jobs: Any) -> None:
    for variable in ("http_proxy", "ALL_PROXY"):
        monkeypatch.setenv(
            variable, "socks4://user:secret@lab:bad" if variable == "ALL_PROXY" else "http://127.0.0.1:9"
        )
    with serve(lambda *_: EMPTY) as service:
        assert list_jobs(service.address) == []
        assert list_jobs(service.address.replace("127.0.0.1", "localhost")) == []


def test_a_proxy_that_does_not_respond_is_named(monkeypatch: pytest.MonkeyPatch, list_jobs: Any) -> None:
    monkeypatch.setenv("http_proxy", "http://user:secret@127.0.0.1:9")
    expected = (
        rf"no service responds at {LAB} through the proxy http://user:\*\*\*@127.0.0.1:9 of `http_proxy`: .*; "
        "add `fathom.invalid` to `no_proxy` to connect directly"
    )
    with pytest.raises(fathom.Unreachable, match=expected) as caught:
        list_jobs(LAB)
    assert "secret" not in str(caught.value)


def test_a_proxy_that_fails_is_named(monkeypatch: pytest.MonkeyPatch, list_jobs: Any) -> None:
    page = (502, {"content-type": "text/html"}, b"<html>no route</html>")
    with serve(lambda *_: page) as proxy:
        monkeypatch.setenv("http_proxy", proxy.address)
        monkeypatch.setenv("https_proxy", proxy.address)
        with pytest.raises(fathom.Unreachable, match=f"the proxy {proxy.address} of `http_proxy` responded with 502"):
            list_jobs(LAB)
        with pytest.raises(fathom.Unreachable, match=f"through the proxy {proxy.address} of `https_proxy`: .*502"):
            list_jobs("https://fathom.invalid")


def test_problems_of_a_service_pass_through_a_proxy(monkeypatch: pytest.MonkeyPatch, list_jobs: Any) -> None:
    problem = reply_json(401, {"type": "/problems/unauthorized", "title": "A valid token is needed"})
    with serve(lambda *_: problem) as proxy:
        monkeypatch.setenv("http_proxy", proxy.address)
        with pytest.raises(fathom.Problem, match="A valid token is needed"):
            list_jobs(LAB)


@pytest.mark.parametrize("value", ["socks5://lab:1080", "socks5h://user:word@lab:1080", "SOCKS4://lab", "socks://lab"])
def test_a_socks_proxy_is_named_with_its_remedy(monkeypatch: pytest.MonkeyPatch, list_jobs: Any, value: str) -> None:
    monkeypatch.setenv("ALL_PROXY", value)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(fathom.FathomError, match=r"`ALL_PROXY` is .*lab.*add `fathom.invalid` to `no_proxy`") as caught:
        list_jobs(LAB)
    assert value.replace("word", "***") in str(caught.value)
    # An exception wins over a proxy that cannot be used.
    monkeypatch.setenv("no_proxy", "10.0.0.0/8, .invalid")
    with pytest.raises(fathom.Unreachable, match=f"no service responds at {LAB}: "):
        list_jobs(LAB)


@pytest.mark.parametrize("value", ["lab:port", "http://", "ftp://lab:21"])
def test_a_variable_without_a_proxy_is_named(monkeypatch: pytest.MonkeyPatch, list_jobs: Any, value: str) -> None:
    monkeypatch.setenv("HTTP_PROXY", value)
    with pytest.raises(fathom.FathomError, match=f"`HTTP_PROXY` is `{value}`; must be a URL such as http://host:3128"):
        list_jobs(LAB)


@pytest.mark.parametrize(
    ("server", "entries", "has_proxy"),
    [
        ("http://10.1.2.3", "10.0.0.0/8", False),
        ("http://11.1.2.3", "10.0.0.0/8", True),
        ("http://10.1.2.3:80", "10.1.2.3", False),
        ("http://10.1.2.3:81", "10.1.2.3:80", True),
        ("http://[fd00::7]:80", "fd00::/8", False),
        ("http://[fd00::7]", "fd00::7", False),
        ("http://[fd00::7]:81", "[fd00::7]:80", True),
        ("http://store.lab.example", "lab.example", False),
        ("http://store.lab.example", ".lab.example", False),
        ("http://store.lab.example", "*.lab.example", False),
        ("http://mylab.example", "lab.example", True),
        ("http://Lab.Example", "other, lab.example", False),
        ("http://lab.example:8080", "lab.example:8080", False),
        ("http://lab.example:8081", "lab.example:8080", True),
        ("https://lab.example", "lab.example:443", False),
        ("http://anything", "*", False),
        ("http://10.1.2.3", "0.0.0.0/0", False),
        ("http://10.1.2.3", "10.0.0.0/99", True),
        ("http://127.9.9.9/v1", "", False),
        ("http://localhost:7311", "", False),
        ("http://a.localhost", "", False),
        ("http://[::1]:7311", "", False),
        ("http://[::ffff:127.0.0.1]", "", False),
        ("http://0.0.0.0:7311", "", False),
        ("http://lab:7311", "", True),
    ],
)
def test_exceptions_are_names_addresses_and_networks(server: str, entries: str, has_proxy: bool) -> None:
    for name in ("no_proxy", "NO_PROXY"):
        proxy = find_proxy(server, {"http_proxy": "http://proxy:1", "https_proxy": "http://proxy:2", name: entries})
        assert (proxy is not None) == has_proxy
    expected = f"proxy:{2 if server.startswith('https') else 1}"
    assert proxy is None or proxy.address.endswith(expected)
