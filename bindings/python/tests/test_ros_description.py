from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import fathom
import pytest
from fathom import InvalidArgument, InvalidJob
from fathom.ros.description import (
    change_description,
    list_enhancements,
    list_ignored,
    open_stream,
    select_mode,
    start_description,
)
from fathom.ros.leaves import flatten
from fathom.ros.settings import FIXED, NAMES, Settings, read_settings


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"mode": "dry"}, '`mode` is "dry"; must be water, enhance, water\\+enhance'),
        ({"slop_s": -0.5}, "`slop_s` is -0.5; must be 0 to 10"),
        ({"deadline_ms": float("nan")}, "`deadline_ms` is nan; must be 0 to 1e\\+06"),
        ({"use_depth": 1}, "`use_depth` is 1; must be of the type bool"),
        ({"jpeg_quality": 90.0}, "`jpeg_quality` is 90.0; must be of the type integer"),
        ({"slop_s": True}, "`slop_s` is True; must be of the type double"),
    ],
)
def test_wrong_settings_are_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidArgument, match=message):
        read_settings(values)


def test_settings_change_except_those_that_are_fixed() -> None:
    before = read_settings({"slop_s": 1, "qos": "reliable"})
    assert type(before.slop_s) is float
    after = read_settings({"mode": "enhance", "qos": "reliable"}, before)
    assert (after.slop_s, after.mode, after.qos, after.needs_depth) == (1.0, "enhance", "reliable", False)
    for name in FIXED:
        other = not getattr(before, name) if isinstance(getattr(before, name), bool) else "raw"
        if name in ("qos", "image_transport", "depth_transport"):
            other = {"qos": "sensor_data"}.get(name, "compressed")
        with pytest.raises(InvalidArgument, match=f"`{name}` cannot change while the node runs"):
            read_settings({name: other}, before)


def test_names_of_settings_are_no_fields_of_a_job() -> None:
    # `job` and `site` replace a whole job; a field with the name of another setting could not be reached.
    fields = {
        "alpha", "artifacts", "camera", "count", "dataset", "daylight", "encode", "enhance", "fidelity", "labels",
        "lights", "metrics", "scene", "seed", "water",
    }  # fmt: skip
    description = fathom.Job({"scene": {"kind": "procedural", "family": "structure"}}).description
    assert set(description) == fields
    assert not fields & set(NAMES)


@pytest.mark.parametrize("site", fathom.names()["sites"])
def test_every_site_opens_and_its_leaves_build_it_again(site: str) -> None:
    settings = read_settings({"site": site})
    description = start_description(settings, {})
    open_stream(description, settings)
    leaves = flatten(description)
    assert "water.optics.preset" in leaves or "water.optics.preset.choice" in leaves
    assert start_description(Settings(), leaves) == description


def test_a_job_comes_from_a_file_with_comments(tmp_path: Path) -> None:
    path = tmp_path / "job.json"
    path.write_text('{\n  // "a comment"\n  "alpha": 0.5, "count": 3,\n  "water": {"style": "muddy"} // "//"\n}')
    settings = read_settings({"job": str(path)})
    assert start_description(settings, {"seed": 7})["seed"] == 7
    assert flatten(start_description(settings, {}))["water.style"] == "muddy"
    assert list_ignored(settings) == ["count"]
    for content, message in (("{", "which is no JSON"), ("[]", "must hold a JSON object")):
        path.write_text(content)
        with pytest.raises(InvalidArgument, match=message):
            start_description(settings, {})
    with pytest.raises(InvalidArgument, match="which cannot be read"):
        start_description(read_settings({"job": "/none.json"}), {})
    with pytest.raises(InvalidArgument, match="give one of them"):
        start_description(read_settings({"job": str(path), "site": "tank"}), {})


def test_the_camera_of_the_topics_replaces_that_of_a_site() -> None:
    described = {
        use: start_description(read_settings({"site": "tank", "use_camera_info": use}), {})["camera"]["hfov_deg"]
        for use in (True, False)
    }
    # 80 is the default, which a stream does not compare with the matrix of a camera.
    assert described == {True: 80.0, False: 75.0}


def test_errors_are_those_of_the_job() -> None:
    settings = Settings()
    description = start_description(settings, {"water.optics": "jerlov-1C"})
    assert description["water"]["range_scale"] == 1.0
    with pytest.raises(InvalidJob, match=r"`alpha` is 3\.0; must be 0\.\.=1"):
        open_stream(change_description(description, {"alpha": 3.0}, settings), settings)
    with pytest.raises(InvalidJob, match="did you mean `tank`"):
        start_description(read_settings({"site": "tonk"}), {})
    for name in ("count", "scene.kind", "camera.width", "camera.path.frames", "artifacts"):
        with pytest.raises(InvalidArgument, match=f"`{name}` changes no picture of a topic"):
            change_description(description, {name: 3}, settings)


def test_modes_select_fields() -> None:
    job = {
        "seed": 3,
        "water": {"optics": "jerlov-1C"},
        "enhance": ["clahe", {"method": "hscm", "name": "mine"}, "x:a=1"],
    }
    assert select_mode(job, "water") == {"seed": 3, "water": job["water"]}
    assert select_mode(job, "enhance") == {"seed": 3, "enhance": job["enhance"]}
    assert select_mode(job, "water+enhance") == job
    assert list_enhancements(job, "enhance") == ["clahe", "mine", "x"]
    assert list_enhancements(job, "water") == []
    assert list_enhancements({}, "enhance") == ["hscm"]
    assert list_enhancements({"enhance": {"choice": [["hscm"]]}}, "enhance") == []
    assert "enhance" not in json.dumps(select_mode({}, "water"))


def test_a_deadline_does_not_contradict_the_default_fidelity() -> None:
    settings = read_settings({"deadline_ms": 50, "mode": "enhance"})
    open_stream(start_description(settings, {}), settings)
