"""Processes around a test: the node, and the subscriber with another version of ROS."""

import json
import os
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from typing import Any

import fathom.ros
import psutil
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient

FILES = pathlib.Path(fathom.ros.__file__).parent / "files"
_OF_THIS_ROS = ("LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
REMAPPED = ("image:=/camera/image", "depth:=/camera/depth", "camera_info:=/camera/camera_info")


class Process:
    """A process whose output is collected."""

    def __init__(self, command: list[str], environment: dict[str, str] | None = None) -> None:
        self._output = tempfile.NamedTemporaryFile("w+", suffix=".log")
        self.process = subprocess.Popen(command, stdout=self._output, stderr=subprocess.STDOUT, env=environment)

    def read(self) -> str:
        """Return the output so far."""
        return pathlib.Path(self._output.name).read_text()

    def stop(self, with_signal: int = signal.SIGTERM, timeout_s: float = 20) -> int:
        """End the process and return its exit status."""
        if self.process.poll() is None:
            self.process.send_signal(with_signal)
        return self.process.wait(timeout_s)


class Node(Process):
    """`python -m fathom.ros` with a parameter file of the package and parameters."""

    def __init__(self, file: str | None = None, **parameters: Any) -> None:
        command = [sys.executable, "-m", "fathom.ros", "--ros-args"]
        if file:
            command += ["--params-file", str(FILES / f"{file}.yaml")]
        for rule in REMAPPED:
            command += ["-r", rule]
        for name, value in parameters.items():
            command += ["-p", f"{name.replace('__', '.')}:={json.dumps(value)}"]
        super().__init__(command)

    def measure_cpu(self) -> float:
        """Return the CPU seconds so far."""
        times = psutil.Process(self.process.pid).cpu_times()
        return times.user + times.system

    def measure_memory(self) -> float:
        """Return the memory of the process in MB, without that shared with other processes."""
        info = psutil.Process(self.process.pid).memory_info()
        return (info.rss - info.shared) / 1e6


@dataclass(frozen=True)
class Arrival:
    """A message that the subscriber received."""

    stamp_ns: int
    received_ns: int
    width: int
    height: int
    encoding: str
    checksum: int

    @property
    def latency_ms(self) -> float:
        """Time since the stamp of the picture."""
        return (self.received_ns - self.stamp_ns) / 1e6


class Subscriber(Process):
    """The subscriber of `subscriber.py`, with the interpreter of `FATHOM_ROS_SUBSCRIBER`."""

    def __init__(self, topic: str, quality: str = "sensor_data") -> None:
        # The wheels of ROS start Python again with the paths of their libraries, unless these variables are there.
        environment = {name: value for name, value in os.environ.items() if name not in _OF_THIS_ROS}
        script = str(pathlib.Path(__file__).with_name("subscriber.py"))
        super().__init__([os.environ["FATHOM_ROS_SUBSCRIBER"], script, topic, quality], environment)
        wait_until(lambda: "ready" in self.read() or self.process.poll(), "the subscriber is ready", 60)
        assert self.process.poll() is None, self.read()

    @property
    def version(self) -> str:
        """Version of the `rclpy` of the subscriber."""
        return self.read().split("ready ")[1].split()[0]

    def list_arrivals(self) -> list[Arrival]:
        """Return the messages so far."""
        lines = self.read().splitlines()
        return [Arrival(*json.loads(line)) for line in lines if line.startswith("[") and line.endswith("]")]


def wait_until(condition: Any, description: str, timeout_s: float = 20) -> Any:
    """Wait until the condition returns something true, and return that."""
    until = time.monotonic() + timeout_s
    while not (result := condition()):
        assert time.monotonic() < until, f"not within {timeout_s} s: {description}"
        time.sleep(0.05)
    return result


class Diagnostics:
    """The diagnostics of the node."""

    def __init__(self) -> None:
        self._statuses: list[tuple[int, str, dict[str, str]]] = []

    def take(self, message: Any) -> None:
        """Take a message."""
        for status in message.status:
            level = status.level if isinstance(status.level, int) else status.level[0]
            self._statuses.append((level, status.message, {value.key: value.value for value in status.values}))

    def forget(self) -> None:
        """Forget the messages so far."""
        self._statuses.clear()

    def wait_for(self, text: str, timeout_s: float = 20) -> tuple[int, str, dict[str, str]]:
        """Return the first level, message and values since `forget` whose message contains a text."""
        try:
            return wait_until(lambda: next((s for s in self._statuses if text in s[1]), None), text, timeout_s)
        except AssertionError:
            raise AssertionError(f"no diagnostic with `{text}` in {[s[:2] for s in self._statuses]}") from None

    def list_medians(self) -> dict[str, float]:
        """Return the median of the medians of each part of a frame, in ms."""
        ending, found = ", median ms", {}
        for _, _, values in self._statuses:
            for name, value in values.items():
                if name.endswith(ending):
                    found.setdefault(name.removesuffix(ending), []).append(float(value))
        return {part: statistics.median(values) for part, values in found.items()}

    def read_total(self, name: str) -> int:
        """Return the next total of a count."""
        seen = len(self._statuses)
        wait_until(lambda: len(self._statuses) > seen, "the next diagnostic")
        return int(self._statuses[-1][2][f"total {name}"])


class ParameterClient:
    """The parameters of the node."""

    def __init__(self, node: Any) -> None:
        self._client = AsyncParameterClient(node, "/fathom")
        assert self._client.wait_for_services(30), "the node has no services of parameters"

    def set(self, **values: Any) -> list[tuple[bool, str]]:
        """Set parameters one after another; returns success and reason of each."""
        return [
            (result.successful, result.reason) for result in self._call(self._client.set_parameters, values).results
        ]

    def set_together(self, **values: Any) -> tuple[bool, str]:
        """Set parameters in one step."""
        result = self._call(self._client.set_parameters_atomically, values).result
        return result.successful, result.reason

    def get(self, name: str) -> Any:
        """Return the value of a parameter."""
        from rclpy.parameter import parameter_value_to_python

        return parameter_value_to_python(_wait(self._client.get_parameters([name])).values[0])

    def list(self) -> list[str]:
        """Return the names of all parameters."""
        return list(_wait(self._client.list_parameters([], 0)).result.names)

    def _call(self, method: Any, values: dict[str, Any]) -> Any:
        given = [Parameter(name.replace("__", "."), value=value) for name, value in values.items()]
        return _wait(method(given))


def _wait(future: Any, timeout_s: float = 60) -> Any:
    done = threading.Event()
    future.add_done_callback(lambda _: done.set())
    assert done.wait(timeout_s), "the node has not responded"
    return future.result()
