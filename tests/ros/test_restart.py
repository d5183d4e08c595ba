"""A node that is killed and started again, and one that is started wrongly."""

import signal
from typing import Any

import pytest
from camera_driver import Camera, play
from conftest import Start
from harness import Node, Subscriber, wait_until


def test_a_killed_node_continues_after_a_restart(camera: Camera, start: Start, shots: list[Any]) -> None:
    killed, subscriber = start(Node, "live", qos="reliable"), start(Subscriber, "/fathom/image", "reliable")
    wait_until(lambda: play(camera, shots, 1, 10) and subscriber.list_arrivals(), "the first picture arrives")
    assert killed.stop(signal.SIGKILL) == -signal.SIGKILL
    restarted = start(Node, "live", qos="reliable")
    before = len(subscriber.list_arrivals())
    wait_until(
        lambda: play(camera, shots, 1, 10) and len(subscriber.list_arrivals()) > before + 2, "pictures arrive again", 30
    )
    assert restarted.stop(signal.SIGINT) == 0
    assert "Traceback" not in restarted.read()


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"site": "tonk"}, "did you mean `tank`?"),
        ({"alpha": 7.0}, "/alpha: `alpha` is 7.0; must be 0..=1"),
        ({"world_frame": 3}, "`world_frame` is 3; must be of the type string"),
    ],
)
def test_a_wrong_start_fails_with_one_message(start: Start, given: dict[str, Any], expected: str) -> None:
    begun = start(Node, **given)
    assert begun.process.wait(30) == 2
    assert expected in begun.read()
    assert "Traceback" not in begun.read()
