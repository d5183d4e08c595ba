"""Minutes at 10 Hz: frames lost, latency, memory, and CPU time by conversion, transport and chain.

The middleware keeps the memory of the largest queue of each topic there ever was, so the memory grows when the node
is first late, up to full queues. Stops of the process fill them before the measurement, and other work of the machine
fills the rest in its first fifth; after that the memory must not grow.
"""

import os
import signal
import threading
import time
from typing import Any

import numpy as np
import pytest
from camera_driver import Camera, play
from conftest import Start
from drive import render_drive
from harness import Node, Subscriber, wait_until

HZ = 10
MINUTES = float(os.environ.get("FATHOM_ROS_MINUTES", "10"))
STOPS, STOP_S, BETWEEN_S = 12, 1.5, 1.0
"""Stops of the process before the measurement; each fills the queues only in part."""
GROWTH_MB = 5
"""The goal of a stream: buffers of frames come and go, but none is kept."""
TOTALS = ("received", "rendered", "without depth", "replaced by a newer one", "failed")
CONVERSION = ("conversion CPU", "writing CPU")


def sample_memory(node: Node, memory_mb: list[float], is_over: threading.Event) -> None:
    """Append the memory of the node about twice a second: buffers come and go, so one sample is no measure."""
    while not is_over.wait(0.47):
        memory_mb.append(node.measure_memory())


def fill_queues(node: Node, camera: Camera, shots: list[Any]) -> None:
    """Stop the process while pictures arrive, so that all queues have been full once."""
    for _ in range(STOPS):
        node.process.send_signal(signal.SIGSTOP)
        play(camera, shots, round(STOP_S * HZ), HZ)
        node.process.send_signal(signal.SIGCONT)
        play(camera, shots, round(BETWEEN_S * HZ), HZ)


@pytest.mark.long
@pytest.mark.parametrize("quality", ["reliable", "sensor_data"])
@pytest.mark.parametrize("size", [(768, 492), (640, 480)])
def test_minutes_without_loss_and_growth(camera: Camera, start: Start, size: tuple[int, int], quality: str) -> None:
    shots: list[Any] = render_drive(size, 20)
    node, subscriber = start(Node, "live", qos=quality), start(Subscriber, "/fathom/image", quality)
    wait_until(lambda: play(camera, shots, 1, HZ) and subscriber.list_arrivals(), "the first picture arrives")
    play(camera, shots, 2 * HZ, HZ)
    fresh_mb = node.measure_memory()
    fill_queues(node, camera, shots)
    camera.diagnostics.forget()
    memory_mb: list[float] = []
    is_over = threading.Event()
    sampling = threading.Thread(target=sample_memory, args=(node, memory_mb, is_over))
    sampling.start()
    begun_cpu = node.measure_cpu()
    before = {name: camera.diagnostics.read_total(name) for name in TOTALS}
    stamps = play(camera, shots, round(60 * MINUTES * HZ), HZ)
    time.sleep(3)
    counted = {name: camera.diagnostics.read_total(name) - before[name] for name in TOTALS}
    cpu_ms = 1e3 * (node.measure_cpu() - begun_cpu) / len(stamps)
    is_over.set()
    sampling.join()
    part = len(memory_mb) // 5
    begun_mb, ended_mb = np.median(memory_mb[part : 2 * part]), np.median(memory_mb[-part:])
    arrivals = {arrival.stamp_ns: arrival for arrival in subscriber.list_arrivals()}
    latencies = [arrivals[stamp].latency_ms for stamp in stamps if stamp in arrivals]
    lost = len(stamps) - len(latencies)
    medians = camera.diagnostics.list_medians()
    conversion = sum(medians[part] for part in CONVERSION)
    chain = medians["chain CPU"]
    print(
        f"{size[0]}×{size[1]} {quality}, {MINUTES:g} min at {HZ} Hz: {lost} of {len(stamps)} lost, latency "
        f"median {np.median(latencies):.1f} ms, p99 {np.percentile(latencies, 99):.1f} ms, memory {fresh_mb:.1f} MB "
        f"after 2 s, {begun_mb:.1f} MB with full queues, {ended_mb:.1f} MB at the end, CPU {cpu_ms:.1f} ms a frame: "
        f"conversion {conversion:.1f}, chain {chain:.1f}, transport and the rest {cpu_ms - conversion - chain:.1f}; "
        f"counts of the node: {counted}"
    )
    assert counted["failed"] == 0
    # The goals of a machine of its own are none lost and 120 ms; a shared one delays some frames.
    assert lost <= 0.01 * len(stamps)
    assert ended_mb - begun_mb < GROWTH_MB
