"""Pictures rendered by `POST /v1/renders` with a form: the frames of a stream over HTTP."""

from __future__ import annotations

import io
import json
from typing import Any

import fathom
import httpx
import numpy as np
import pytest
from fathom import _native
from numpy.typing import NDArray

SIZE = (96, 64)
K = [[80.0, 0.0, 47.5], [0.0, 80.0, 31.5], [0.0, 0.0, 1.0]]
POSE = [[1.0, 0.0, 0.0, 0.5], [0.0, 0.0, 1.0, 8.0], [0.0, -1.0, 0.0, -9.5], [0.0, 0.0, 0.0, 1.0]]
JOB: dict[str, Any] = {
    "seed": 5,
    "water": {"optics": "jerlov-3C", "snow": {"density_per_m3": 2000, "radius_m": 0.002}},
    "lights": [{"kind": "point", "position_m": [0.3, -0.2, 0], "intensity": [3, 3, 3]}],
    "camera": {"sensor": {}},
    "enhance": ["hscm"],
}
LISTS = ["jobs", "images", "scenes", "datasets"]


@pytest.fixture(scope="module")
def air() -> fathom.Frame:
    """Render a picture in air with its range."""
    scene = {"kind": "procedural", "family": "structure", "seed": 3}
    camera = {"width": SIZE[0], "height": SIZE[1]}
    return fathom.render({"scene": scene, "camera": camera}, 0, ["clean", "range", "instances"])


def npy(array: NDArray[Any]) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def post(server: str, fields: dict[str, Any], accept: str | None = None) -> httpx.Response:
    headers = {"Authorization": "Bearer secret"} | ({"Accept": accept} if accept else {})
    files = {
        name: value if isinstance(value, bytes) else (None, value if isinstance(value, str) else json.dumps(value))
        for name, value in fields.items()
    }
    before = count(server)
    response = httpx.post(f"{server}/v1/renders", files=files, headers=headers, timeout=120)
    assert count(server) == before, "nothing is stored"
    return response


def count(server: str) -> list[int]:
    headers = {"Authorization": "Bearer secret"}
    return [len(httpx.get(f"{server}/v1/{name}", headers=headers).json()["items"]) for name in LISTS]


def parts_of(response: httpx.Response) -> dict[str, bytes]:
    """Return the parts of a mixed response by name."""
    boundary = response.headers["content-type"].split("boundary=")[1].encode()
    parts, rest = {}, response.content
    while not rest.startswith(b"--" + boundary + b"--"):
        head, rest = rest.split(b"\r\n\r\n", 1)
        fields = head.decode().split("\r\n")[1:]
        length = next(int(field.split(": ")[1]) for field in fields if field.startswith("Content-Length"))
        name = next(field.split('name="')[1].split('"')[0] for field in fields if "Disposition" in field)
        parts[name], rest = rest[:length], rest[length + 2 :]
    return parts


def problem_of(response: httpx.Response) -> dict[str, str]:
    """Return the messages of a rejected form by the pointers of its fields."""
    assert response.status_code == 422, response.text
    return {error["pointer"]: error["message"] for error in response.json()["errors"]}


def test_a_form_has_the_bytes_of_a_stream(server: str, air: fathom.Frame) -> None:
    stream = fathom.Stream(JOB)
    millimeters = np.nan_to_num(air.range_m * 1000).astype(np.uint16)
    fields = {"frame": JOB, "rgb": npy(air.clean)}
    cases: list[tuple[dict[str, Any], dict[str, Any]]] = [
        ({"range_m": air.range_m}, {"range": npy(air.range_m)}),
        ({"range_m": millimeters}, {"range": _native.encode_png(millimeters)}),
        ({"z_depth": air.range_m, "camera": np.array(K)}, {"z_depth": npy(air.range_m), "camera": K}),
        ({"pose": np.array(POSE)}, {"pose": {"world_from_camera": POSE}}),
        ({}, {}),
    ]
    for own, given in cases:
        for stamp_ns in (0, 123_456_789):
            out = stream(air.clean, stamp_ns=stamp_ns, **own)
            response = post(server, fields | given | {"stamp_ns": str(stamp_ns)})
            assert (response.status_code, response.headers["content-type"]) == (200, "image/png"), response.text
            assert (_native.decode(response.content) == out.rgb).all(), given.keys()
            assert bool(response.headers.get("fathom-warnings")) == bool(out.warnings)
    assert "range" in response.headers["fathom-warnings"]


def test_the_response_is_what_the_caller_accepts(server: str, air: fathom.Frame) -> None:
    job = JOB | {"artifacts": ["rgb", "backscatter", "instances", "boxes"], "metrics": ["uiqm"]}
    fields = {
        "frame": job,
        "rgb": _native.encode_png(air.clean),
        "range": npy(air.range_m),
        "instances": npy(air.instances),
        "stamp_ns": "7",
    }
    png, webp = post(server, fields, "image/png"), post(server, fields, "image/webp;q=0.9, */*")
    assert webp.headers["content-type"] == "image/webp"
    assert (_native.decode(png.content) == _native.decode(webp.content)).all()
    mixed = parts_of(post(server, fields, "multipart/mixed"))
    assert list(mixed) == ["record", "rgb", "backscatter", "instances", "boxes", "range", "enhanced.hscm"]
    record = json.loads(mixed["record"])
    assert record["frame"] == 7
    assert list(record["measurements"]["rgb"]) == ["uiqm"]
    assert [artifact["kind"] for artifact in record["artifacts"]] == list(mixed)[1:]
    assert (_native.decode(mixed["rgb"]) == _native.decode(png.content)).all()
    assert (_native.decode(mixed["instances"]) == air.instances).all()
    assert json.loads(mixed["boxes"])["instances"]
    own = fathom.Stream(JOB | {"artifacts": ["backscatter"]})
    out = own(air.clean, range_m=air.range_m, stamp_ns=7)
    assert np.array_equal(np.load(io.BytesIO(mixed["backscatter"])), out["backscatter"])
    assert (_native.decode(mixed["enhanced.hscm"]) == out.enhanced["hscm"]).all()
    refused = post(server, fields, "application/json")
    assert (refused.status_code, "multipart/mixed" in refused.json()["detail"]) == (400, True)


def test_every_wrong_part_is_named_at_once(server: str, air: fathom.Frame) -> None:
    good: dict[str, Any] = {"frame": JOB, "rgb": npy(air.clean)}
    assert set(problem_of(post(server, {"bogus": b"1"}))) == {"/bogus", "/frame", "/rgb"}
    wrong = {"frame": {"water": {"optics": "jerlov-9Z"}}, "rgb": npy(air.clean), "range": b"", "z_depth": b""}
    wrong |= {"camera": "[[1]]", "stamp_ns": "-1", "pose": b"[]"}
    found = problem_of(post(server, wrong))
    assert set(found) >= {"/frame/water/optics", "/z_depth", "/camera", "/stamp_ns"}
    assert "18446744073709551615" in found["/stamp_ns"]
    assert any(pointer.startswith("/pose") for pointer in found)
    found = problem_of(post(server, {"frame": JOB, "rgb": b"no picture", "range": b"none", "instances": b"none"}))
    assert set(found) == {"/rgb", "/range", "/instances"}
    narrow = [[1, 0, 0], [0, 9, 0], [0, 0, 1]]
    small = problem_of(post(server, good | {"range": npy(air.range_m[:4]), "camera": narrow}))
    assert set(small) == {"/range", "/camera"}
    assert "96×4" in small["/range"]
    headers = {"Authorization": "Bearer secret"}
    twice = [("rgb", good["rgb"]), ("rgb", good["rgb"]), ("frame", json.dumps(JOB).encode())]
    assert "given twice" in problem_of(httpx.post(f"{server}/v1/renders", files=twice, headers=headers))["/rgb"]
    keyed = headers | {"Idempotency-Key": "k"}
    assert httpx.post(f"{server}/v1/renders", files={"rgb": b""}, headers=keyed).status_code == 400


def test_pictures_with_large_headers_are_rejected_before_they_are_decoded(server: str) -> None:
    shape = b"{'descr': '|u1', 'fortran_order': False, 'shape': (60000, 60000, 3), }"
    header = b"\x93NUMPY\x01\x00v\x00" + shape.ljust(117) + b"\n"
    found = problem_of(post(server, {"frame": JOB, "rgb": header}))
    assert "3600000000 pixels; must be at most 8388608" in found["/rgb"]
    # The next request is served as usual.
    gray = npy(np.full((8, 8, 3), 90, np.uint8))
    assert post(server, {"frame": {"enhance": ["hscm"]}, "rgb": gray}).status_code == 200
