from __future__ import annotations

import inspect
from typing import Any

import fathom
import numpy as np
import pytest


@pytest.fixture(scope="module")
def photo() -> Any:
    job = {
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 200, "height": 160},
        "water": {"optics": "jerlov-1C"},
    }
    return fathom.render(job, 0, ["rgb"], metrics=False).rgb


@pytest.mark.parametrize("spelling", ["license", "licence"])
def test_both_spellings_of_a_license_are_stored(photo: Any, spelling: str) -> None:
    options: dict[str, Any] = {spelling: "cc-by-4.0"}
    assert fathom.train(photo, "bay", steps=1, progress=False, **options).card["licence"] == "cc-by-4.0"


def test_a_service_stores_the_license(server: str, photo: Any) -> None:
    with fathom.Client(server, token="secret") as client:
        training = client.train(photo, "bay-license", steps=1, license="cc-by-4.0")
    assert training["state"] == "done"
    assert training["card"]["licence"] == "cc-by-4.0"


def test_two_licenses_are_refused() -> None:
    picture = np.zeros((4, 4, 3), np.uint8)
    client: Any = fathom.Client("http://127.0.0.1:9")
    for train in (fathom.train, client.train):
        with pytest.raises(fathom.InvalidArgument, match=r"`license` is 'mit' but `licence` is 'cc0-1.0'"):
            train(picture, "bay", license="mit", licence="cc0-1.0")


def test_every_call_that_trains_or_exports_spells_license() -> None:
    for call in (fathom.train, fathom.Client.train, fathom.AsyncClient.train, fathom.Client.export):
        assert "license" in inspect.signature(call).parameters
