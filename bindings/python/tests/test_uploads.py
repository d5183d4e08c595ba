from __future__ import annotations

import asyncio
import copy
import json
import pickle
import warnings
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import description
from exr_files import write_exr
from fathom.client import Scene
from fathom.client.exr import has_distances
from numpy.typing import NDArray

SHAPE = (32, 48)
PICTURE = np.full((*SHAPE, 3), 90, np.uint8)


@pytest.fixture(scope="module")
def client(server: str) -> Any:
    with fathom.Client(server, token="secret") as client:
        yield client


def _planes(*names: str) -> dict[str, NDArray[np.float64]]:
    return {name: np.full(SHAPE, 3.0 if name.endswith(("Z", "V")) else 0.2) for name in names}


def test_an_upload_is_an_id_with_a_summary(client: fathom.Client) -> None:
    mask = np.zeros(SHAPE, np.uint8)
    mask[4:8, :10] = 1
    scene = client.upload(PICTURE, range=np.full(SHAPE, 2.5, np.float32), instances=mask, classes={1: "pile"})
    assert isinstance(scene, str)
    assert scene.id == scene == f"{scene}"
    assert type(scene.id) is str
    assert (scene.width, scene.height, scene.has_range, scene.notes) == (48, 32, True, ())
    assert scene.summary["valid_share"] == 1
    assert scene.summary["nearest_m"] == scene.summary["farthest_m"] == 2.5
    assert scene.summary["classes"] == [{"name": "pile", "pixels": 40}]
    assert "range of 100.0 % of the pixels, 2.500 to 2.500 m, 1 objects (pile 40 px)" in repr(scene)
    for other in (pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene)):
        assert (other, other.summary) == (scene, scene.summary)
    assert json.dumps({"id": scene}) == json.dumps({"id": scene.id})
    job = description(scene={"kind": "uploaded", "id": scene}, camera={}, artifacts=["rgb"], count=1, dataset="summary")
    assert client.submit(job).wait().state["state"] == "done"


def test_notes_of_an_upload_are_warnings(client: fathom.Client, tmp_path: Path) -> None:
    path = write_exr(tmp_path / "a.exr", _planes("R", "G", "B", "Z"))
    with pytest.warns(UserWarning, match="channel of distances, which is not used") as caught:
        scene = client.upload(path)
    assert caught[0].filename == __file__
    assert (scene.has_range, len(scene.notes)) == (False, 1)
    assert "no range" in repr(scene)


@pytest.mark.parametrize("camera", [{"hfov_deg": 60}, {"focal_px": 40}])
def test_a_picture_with_distances_brings_its_range(
    client: fathom.Client, tmp_path: Path, camera: dict[str, Any]
) -> None:
    path = write_exr(tmp_path / "a.exr", _planes("R", "G", "B", "Z"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = client.upload(path, **camera)
        ranged = client.upload(path, range=path)
    assert scene.fields["range_kind"] == "z_depth"
    assert scene.summary["nearest_m"] == pytest.approx(3, rel=1e-3)
    assert scene.summary["farthest_m"] > 3.2
    assert ranged.summary["farthest_m"] == 3


def test_the_async_client_brings_the_range_and_warns(server: str, tmp_path: Path) -> None:
    path = write_exr(tmp_path / "a.exr", _planes("R", "G", "B", "Z"))

    async def run() -> tuple[Scene, Scene]:
        async with fathom.AsyncClient(server, token="secret") as client:
            with pytest.warns(UserWarning, match="channel of distances"):
                bare = await client.upload(path)
            return bare, await client.upload(path, hfov_deg=60, cx=20, cy=10)

    bare, scene = asyncio.run(run())
    assert (bare.has_range, scene.has_range) == (False, True)
    assert (scene.fields["cx"], scene.fields["cy"]) == (20, 10)


def test_the_principal_point_is_part_of_the_camera(client: fathom.Client) -> None:
    scene = client.upload(PICTURE, hfov_deg=60, cx=20.5, cy=10)
    assert (scene.fields["cx"], scene.fields["cy"]) == (20.5, 10)
    with pytest.raises(fathom.Problem, match="cx"):
        client.upload(PICTURE, cx=20.5)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["R", "G", "B"], False),
        (["R", "G", "B", "A"], False),
        (["R", "G", "B", "Z"], True),
        (["R", "G", "B", "X", "Y", "Z"], False),
        (["Z"], False),
        (["View.Combined.R", "View.Combined.G", "View.Combined.B", "View.Depth.Z"], True),
        (["View.Combined.R", "View.Combined.G", "View.Combined.B", "View.Depth.V"], True),
        (["R", "G", "B", "a.Z", "b.Z"], False),
    ],
)
def test_channels_of_distances_are_found_like_the_service_does(
    client: fathom.Client, tmp_path: Path, names: list[str], expected: bool
) -> None:
    path = write_exr(tmp_path / "a.exr", _planes(*names))
    assert has_distances(path.read_bytes()) == expected
    for length in range(0, 400, 7):
        has_distances(path.read_bytes()[:length])
    if "Z" not in names[0]:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            client.upload(path)
        assert any("channel of distances" in str(warning.message) for warning in caught) == expected


def test_a_submission_passes_on_the_warnings_of_the_service(client: fathom.Client) -> None:
    job = description(dataset="warned", count=1)
    client.submit(job).wait()
    with pytest.warns(UserWarning, match="every image"):
        client.submit(job)
