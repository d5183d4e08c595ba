"""`Client.render`: the frames of a stream over HTTP, decoded."""

from __future__ import annotations

import asyncio
from typing import Any

import fathom
import numpy as np
import pytest
from fathom import _native
from service_stand_in import Reply, serve

K = [[80.0, 0.0, 47.5], [0.0, 80.0, 31.5], [0.0, 0.0, 1.0]]
JOB: dict[str, Any] = {
    "seed": 5,
    "water": {"optics": "jerlov-3C"},
    "artifacts": ["rgb", "backscatter", "boxes", "instances"],
    "enhance": ["hscm"],
}


@pytest.fixture(scope="module")
def client(server: str) -> Any:
    with fathom.Client(server, token="secret") as client:
        yield client


@pytest.fixture(scope="module")
def air() -> fathom.Frame:
    scene = {"kind": "procedural", "family": "structure", "seed": 3}
    return fathom.render({"scene": scene, "camera": {"width": 96, "height": 64}}, 0, ["clean", "range", "instances"])


def test_a_picture_is_rendered_as_in_a_stream(client: fathom.Client, air: fathom.Frame) -> None:
    stream = fathom.Stream(JOB | {"artifacts": ["rgb", "backscatter"]})
    own = stream(air.clean, range_m=air.range_m, camera=np.array(K), stamp_ns=7)
    jobs = len(client.jobs())
    frame = client.render(JOB, air.clean, range_m=air.range_m, instances=air.instances, camera=K, stamp_ns=7, wait_s=60)
    assert frame.index == 7
    assert (frame.rgb == own.rgb).all()
    assert np.array_equal(frame["backscatter"], own["backscatter"])
    assert (frame["enhanced.hscm"] == own.enhanced["hscm"]).all()  # type: ignore[union-attr]
    assert (frame.instances == air.instances).all()
    assert len(frame.boxes) > 0
    assert np.nanmax(np.abs(frame.range_m - air.range_m)) <= 0.001
    assert [artifact["kind"] for artifact in frame.record["artifacts"]] == list(frame.artifacts)
    assert len(client.jobs()) == jobs


def test_a_picture_without_distances_has_a_warning(server: str, air: fathom.Frame) -> None:
    async def run() -> fathom.Frame:
        async with fathom.AsyncClient(server, token="secret") as client:
            return await client.render({"water": {"optics": "jerlov-3C"}}, air.clean)

    with pytest.warns(UserWarning, match="range"):
        frame = asyncio.run(run())
    assert list(frame.artifacts) == ["rgb"]


def test_wrong_parts_of_a_render_are_errors(client: fathom.Client, air: fathom.Frame) -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"wait_s": 0}, "`wait_s` is 0; must be 1 to 60"),
        ({"wait_s": 61}, "`wait_s` is 61; must be 1 to 60"),
        ({"stamp_ns": -1}, "`stamp_ns` is -1; must be 0 to 18446744073709551615"),
        ({"camera": [1.0]}, r"`camera` has the shape \(1,\); must be \(3, 3\)"),
        ({"range_m": air.range_m, "z_depth": air.range_m}, "both given"),
    ]
    for given, message in cases:
        with pytest.raises(fathom.InvalidArgument, match=message):
            client.render(JOB, air.clean, **given)
    with pytest.raises(fathom.InvalidJob) as caught:
        client.render({"water": {"optics": "jerlov-9Z"}}, air.clean, range_m=air.range_m[:4])
    assert "/frame/water/optics" in {error.pointer for error in caught.value.errors}


@pytest.mark.parametrize(
    ("kind", "body", "message"),
    [
        ("text/html", b"<p>", "is of type text/html, not multipart/mixed"),
        ("multipart/mixed; boundary=x", b"--x\r\n\r\n", "is damaged"),
        ("multipart/mixed; boundary=x", b"", "is damaged"),
        (
            "multipart/mixed; boundary=x",
            b'--x\r\nContent-Disposition: attachment; name="rgb"\r\nContent-Length: 99\r\n\r\nabc\r\n--x--\r\n',
            "is damaged",
        ),
        ("multipart/mixed; boundary=x", b"--x--\r\n", "has no record"),
    ],
)
def test_a_damaged_response_is_an_error(kind: str, body: bytes, message: str) -> None:
    def respond(method: str, target: str, earlier: int) -> Reply:
        return 200, {"content-type": kind}, body

    with serve(respond) as stand_in, pytest.raises(fathom.FathomError, match=message):
        fathom.Client(stand_in.address).render({}, np.zeros((32, 32, 3), np.uint8))


def test_the_parts_of_a_picture_are_decoded_by_their_lengths() -> None:
    picture = np.full((2, 2, 3), 7, np.uint8)
    png = _native.encode_png(picture)
    parts = {"record": b'{"frame": 3, "warnings": []}', "rgb": png}
    body = b"".join(
        b'--a--b\r\nContent-Type: any\r\nContent-Disposition: attachment; name="%s"\r\nContent-Length: %d\r\n\r\n%s\r\n'
        % (name.encode(), len(content), content)
        for name, content in parts.items()
    )

    def respond(method: str, target: str, earlier: int) -> Reply:
        return 200, {"content-type": 'multipart/mixed; boundary="a--b"'}, body + b"--a--b--\r\n"

    with serve(respond) as stand_in:
        frame = fathom.Client(stand_in.address).render({}, picture)
    assert frame.index == 3
    assert (frame.rgb == picture).all()
