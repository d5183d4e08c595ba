from __future__ import annotations

import inspect
import subprocess
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import description


@pytest.mark.parametrize(
    ("options", "expected"), [({"license": "cc0-1.0"}, "cc0-1.0"), ({"licence": "mit"}, "mit"), ({}, "unknown")]
)
def test_both_spellings_of_a_license_reach_the_command(
    monkeypatch: pytest.MonkeyPatch, options: dict[str, Any], expected: str
) -> None:
    commands: list[list[str]] = []

    def refuse(command: list[str], **_: Any) -> Any:
        commands.append(command)
        return subprocess.CompletedProcess(command, 1, stderr="")

    monkeypatch.setattr("fathom.training.subprocess.run", refuse)
    with pytest.raises(fathom.CommandError):
        fathom.train(np.zeros((4, 4, 3), np.uint8), "bay", progress=False, **options)
    assert commands[0][commands[0].index("--licence") + 1] == expected


def test_a_service_stores_the_license(server: str) -> None:
    photo = fathom.render(description(camera={"width": 200, "height": 160}), 0, ["rgb"], metrics=False).rgb
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
