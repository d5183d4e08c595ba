"""One graph of ROS for all tests, and one node for the tests of each file."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
import rclpy
from camera_driver import Camera, play
from drive import SMALL, render_drive
from harness import FILES, Diagnostics, Node, ParameterClient, Process, Subscriber, wait_until

Start = Callable[..., Any]


@contextmanager
def start_processes() -> Iterator[Start]:
    """Yield a function that starts processes, and end them all."""
    started: list[Process] = []

    def begin(kind: type[Process], *arguments: Any, **parameters: Any) -> Process:
        started.append(kind(*arguments, **parameters))
        return started[-1]

    try:
        yield begin
    finally:
        for process in started:
            process.stop()


@pytest.fixture(scope="session")
def camera() -> Iterator[Camera]:
    """The topics of a simulator, in a graph apart from others of this machine."""
    os.environ.setdefault("ROS_DOMAIN_ID", str(100 + os.getpid() % 100))
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    # Fast DDS has two names of this variable, the older one in Jazzy.
    for name in ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"):
        os.environ.setdefault(name, str(FILES / "fastdds.xml"))
    rclpy.init()
    driver = Camera()
    yield driver
    driver.close()
    rclpy.try_shutdown()


@pytest.fixture
def diagnostics(camera: Camera) -> Diagnostics:
    """The diagnostics since the start of the test."""
    camera.diagnostics.forget()
    return camera.diagnostics


@pytest.fixture(scope="session")
def shots() -> list[Any]:
    """A drive in small pictures."""
    return render_drive(SMALL, 8)


@pytest.fixture
def start() -> Iterator[Start]:
    """Start processes that end with the test."""
    with start_processes() as begin:
        yield begin


@pytest.fixture(scope="module")
def node(camera: Camera) -> Iterator[Node]:
    """A node with the parameters `live` for all tests of a file, ready to receive."""
    with start_processes() as begin:
        begun = begin(Node, "live", qos="reliable")
        camera.wait_for_node()
        yield begun


@pytest.fixture(scope="module")
def subscriber(camera: Camera, node: Node, shots: list[Any]) -> Iterator[Subscriber]:
    """A subscriber of the rendered pictures that has received the first one."""
    with start_processes() as begin:
        begun = begin(Subscriber, "/fathom/image", "reliable")
        wait_until(lambda: play(camera, shots, 1, 10) and begun.list_arrivals(), "the first picture arrives")
        yield begun


@pytest.fixture(scope="module")
def parameters(camera: Camera, node: Node) -> ParameterClient:
    """The parameters of the node."""
    return ParameterClient(camera.node)
