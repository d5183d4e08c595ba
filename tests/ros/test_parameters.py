"""Parameters that change while pictures arrive: every leaf of the job, and settings of the node."""

from typing import Any

import pytest
from camera_driver import Camera, play
from harness import Arrival, ParameterClient, Subscriber, wait_until

Shots = list[Any]


def render_next(camera: Camera, subscriber: Subscriber, shots: Shots) -> Arrival:
    """Return the result of the first picture of the drive with the next stamp."""
    stamps = play(camera, shots[:1] * 2, 1, 10)
    return wait_until(
        lambda: next((a for a in subscriber.list_arrivals() if a.stamp_ns == stamps[0]), None), "the picture arrives"
    )


def test_a_change_applies_to_the_next_frame(
    camera: Camera, subscriber: Subscriber, parameters: ParameterClient, shots: Shots
) -> None:
    before = render_next(camera, subscriber, shots).checksum
    assert render_next(camera, subscriber, shots).checksum == before
    sweep = {before}
    for scale in (0.2, 0.4, 0.8, 1.6):
        assert parameters.set(water__range_scale=scale) == [(True, "")]
        sweep.add(render_next(camera, subscriber, shots).checksum)
    assert len(sweep) == 5
    assert parameters.set(water__range_scale=0.15) == [(True, "")]
    assert render_next(camera, subscriber, shots).checksum == before


def test_an_invalid_value_is_rejected_with_the_message_of_the_job(
    camera: Camera, subscriber: Subscriber, parameters: ParameterClient, shots: Shots
) -> None:
    before = render_next(camera, subscriber, shots).checksum
    refused = {
        "water__range_scale": (-1.0, "/water/range_scale: `water.range_scale` is -1.0; must be"),
        "water__optics__preset": ("jerlow-1C", 'preset` "jerlow-1C" is not a known water preset'),
        "lights__0__intensity": (3.0, "/lights/0/intensity: `lights[0].intensity` is 3.0; must be 0..=1"),
        "lights__7__x": (0.5, "`lights.7.x` does not exist: `lights` has 2 elements; the next index is 2"),
        "allpha": (0.5, "the description has no field `allpha` (did you mean `alpha`?)"),
        "mode": ("dry", '`mode` is "dry"; must be water, enhance, water+enhance'),
        "slop_s": (-0.5, "`slop_s` is -0.5; must be 0 to 10"),
        "qos": ("sensor_data", "`qos` cannot change while the node runs"),
        "count": (3, "`count` changes no picture of a topic"),
    }
    for name, (value, expected) in refused.items():
        [(is_accepted, reason)] = parameters.set(**{name: value})
        assert not is_accepted, name
        assert expected in reason
    assert parameters.get("water.range_scale") == pytest.approx(0.15)
    assert render_next(camera, subscriber, shots).checksum == before


def test_parameters_mirror_the_leaves_of_the_job(parameters: ParameterClient) -> None:
    names = parameters.list()
    assert {"alpha", "water.optics.preset", "lights.0.intensity", "lights.1.color", "slop_s", "mode"} <= set(names)
    assert parameters.get("lights.0.intensity") == pytest.approx(0.5)
    assert parameters.get("water.optics.preset") == "jerlov-1C/williamson2022"
    assert parameters.set(lights="[]") == [(True, "")]
    wait_until(lambda: "lights.0.x" not in parameters.list(), "the leaves of removed lamps are gone")
    together = {"lights__0__kind": "haze", "lights__0__x": 0.5, "lights__0__y": 1}
    assert parameters.set_together(**together) == (True, "")
    wait_until(lambda: "lights.0.size" in parameters.list(), "the leaves of the new lamp are there")


def test_a_site_and_a_mode_can_be_selected_while_running(
    camera: Camera, subscriber: Subscriber, parameters: ParameterClient, shots: Shots
) -> None:
    before = render_next(camera, subscriber, shots).checksum
    assert parameters.set(site="paper") == [(True, "")]
    wait_until(lambda: "water.style.choice" in parameters.list(), "the leaves of the site are there")
    assert render_next(camera, subscriber, shots).checksum != before
    # `enhance` publishes no picture of its own, so a mode with both keeps the topic.
    assert parameters.set(mode="water+enhance") == [(True, "")]
    wait_until(lambda: camera.node.count_publishers("/fathom/enhanced/hscm"), "the topic of the enhancement is there")
    assert parameters.set(mode="water", use_depth=False) == [(True, "")] * 2
    render_next(camera, subscriber, shots)
