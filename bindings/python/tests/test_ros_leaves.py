from __future__ import annotations

from typing import Any

import pytest
from fathom import InvalidArgument
from fathom.ros.leaves import REMOVED, change, flatten

JOB: dict[str, Any] = {
    "alpha": 0.5,
    "water": {"optics": {"preset": "jerlov-1C"}, "range_scale": {"uniform": [0.3, 1]}, "snow": {}},
    "lights": [{"kind": "haze", "x": 0.3}, {"kind": "point", "intensity": [1, 2, 3]}],
    "enhance": ["hscm", {"method": "clahe", "clip": 3.0}],
    "metrics": [],
    "flags": [True, False],
}


def test_every_leaf_has_its_path_as_name_and_a_type_of_ros() -> None:
    assert flatten(JOB) == {
        "alpha": 0.5,
        "water.optics.preset": "jerlov-1C",
        "water.range_scale.uniform": [0.3, 1.0],
        "water.snow": "{}",
        "lights.0.kind": "haze",
        "lights.0.x": 0.3,
        "lights.1.kind": "point",
        "lights.1.intensity": [1, 2, 3],
        "enhance.0": "hscm",
        "enhance.1.method": "clahe",
        "enhance.1.clip": 3.0,
        "metrics": "[]",
        "flags": [True, False],
    }
    assert all(type(item) is float for item in flatten(JOB)["water.range_scale.uniform"])


def test_leaves_build_the_job_again_in_any_order() -> None:
    leaves = flatten(JOB)
    assert change({}, leaves) == JOB
    assert change({}, dict(reversed(leaves.items()))) == JOB
    many = {f"lights.{index}.x": float(index) for index in range(12)}
    assert [lamp["x"] for lamp in change({}, many)["lights"]] == list(range(12))


@pytest.mark.parametrize(
    ("changes", "path", "expected"),
    [
        ({"alpha": 1.0}, ["alpha"], 1.0),
        ({"water.range_scale": 0.4}, ["water", "range_scale"], 0.4),
        ({"water.range_scale.uniform": [1.0, 2.0]}, ["water", "range_scale"], {"uniform": [1.0, 2.0]}),
        ({"alpha.uniform": [0.0, 1.0]}, ["alpha"], {"uniform": [0.0, 1.0]}),
        ({"lights": "[]"}, ["lights"], []),
        ({"lights.0": '{"kind": "haze", "x": 1}'}, ["lights", 0], {"kind": "haze", "x": 1}),
        ({"lights.0": "{'kind': 'spot', 'fog': None, 'on': True}"}, ["lights", 0, "on"], True),
        ({"water.range_scale.uniform": "[1, 2.5]"}, ["water", "range_scale", "uniform"], [1, 2.5]),
        ({"lights": []}, ["lights"], []),
        ({"lights.choice.0": "[]"}, ["lights"], {"choice": [[]]}),
        ({"alpha.0.x": 1}, ["alpha"], [{"x": 1}]),
        ({"water.range_scale.0": 1}, ["water", "range_scale"], [1]),
        ({"lights.2.kind": "spot"}, ["lights", 2], {"kind": "spot"}),
        ({"lights.0": REMOVED}, ["lights"], [{"kind": "point", "intensity": [1, 2, 3]}]),
        ({"water.snow": REMOVED}, ["water"], {key: JOB["water"][key] for key in ("optics", "range_scale")}),
        ({"camera.sensor.gain": 2}, ["camera"], {"sensor": {"gain": 2}}),
        ({"camera.motion.x_px": REMOVED}, ["alpha"], 0.5),
    ],
)
def test_a_change_replaces_everything_at_its_path(changes: dict[str, Any], path: list[Any], expected: Any) -> None:
    found: Any = change(JOB, changes)
    for part in path:
        found = found[part]
    assert found == expected
    assert JOB["alpha"] == 0.5
    assert len(JOB["lights"]) == 2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lights.3.x": 1}, "`lights.3.x` does not exist: `lights` has 2 elements; the next index is 2"),
        ({"lights.first.x": 1}, "`lights.first.x` does not exist: `lights` has 2 elements"),
        ({"lights..x": 1}, "`lights..x` has an empty part"),
        ({"lights": "{1, 2}"}, r"`lights` is '\{1, 2\}', which is no JSON"),
        ({"lights": "[{]"}, r"`lights` is '\[\{\]', which is no JSON"),
    ],
)
def test_a_path_that_does_not_exist_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidArgument, match=message):
        change(JOB, changes)


def test_a_number_beyond_the_integers_of_ros_is_refused() -> None:
    assert flatten({"seed": 2**63 - 1}) == {"seed": 2**63 - 1}
    with pytest.raises(InvalidArgument, match="`seed` is 9223372036854775808; must be at most 9223372036854775807"):
        flatten({"seed": 2**63})
