"""Workers that a broker hands shards to: whatever is killed, stopped or wiped, the set is that of one `fathom render`.

Above each test stands what counts as failure.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from nats_server import NatsServer, start_cluster

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
FATHOM = str(TARGET / "release" / "fathom")
FRAMES_PER_SHARD = 5
# Long enough for a busy machine, short enough for a test.
LEASE_S = "3"
PATIENCE_S = 180


def job(frames: int) -> dict[str, object]:
    return {
        "dataset": "sets",
        "count": frames,
        "seed": 3,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 64, "height": 48, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"},
        "artifacts": ["rgb", "range"],
    }


class Work:
    """A job, the folder of its set, and the processes that render it."""

    def __init__(self, folder: Path, frames: int) -> None:
        self.folder = folder
        self.store = folder / "store"
        self.set = self.store / "set"
        self.spec = folder / "job.json"
        self.spec.write_text(json.dumps(job(frames)))
        self.processes: list[subprocess.Popen[str]] = []

    def run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [FATHOM, *arguments], capture_output=True, text=True, cwd=ROOT, timeout=PATIENCE_S, check=False
        )

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [FATHOM, *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=ROOT,
            start_new_session=True,
        )
        self.processes.append(process)
        return process

    def worker(self, engine: str, *arguments: str, lease_s: str = LEASE_S, store: Path | None = None) -> subprocess.Popen[str]:
        place = str(store or self.store)
        return self.start("worker", "--engine", engine, "--store", place, "--lease-s", lease_s, *arguments)

    def render(self, engine: str, *arguments: str, lease_s: str = LEASE_S) -> subprocess.Popen[str]:
        shards = ["--frames-per-shard", str(FRAMES_PER_SHARD)]
        out = ["--out", f"file://{self.set}"]
        return self.start("render", str(self.spec), *out, *shards, "--engine", engine, "--lease-s", lease_s, *arguments)

    def markers(self) -> int:
        return len(list((self.set / "done").glob("*.json")))

    def wait_for_markers(self, count: int) -> None:
        deadline = time.monotonic() + PATIENCE_S
        while self.markers() < count:
            assert time.monotonic() < deadline, f"{self.markers()} of {count} shards"
            time.sleep(0.02)

    def set_state(self, state: str) -> None:
        (self.set / "state.json").write_text(json.dumps({"state": state}))

    def expected_digest(self) -> str:
        rendered = self.run("render", str(self.spec), "--out", str(self.folder / "plain"))
        return digest_in(rendered.stdout)

    def check(self, rendering: subprocess.Popen[str], expected: str) -> None:
        """The run ended well, with this digest; every frame is there once, and of each shard one winner."""
        output, _ = rendering.communicate(timeout=PATIENCE_S)
        assert rendering.returncode == 0, output
        assert digest_in(output) == expected
        assert self.run("verify", str(self.set)).returncode == 0
        self.stop()
        assert self.run("gc", str(self.set), "--older", "0s").returncode == 0
        for folder in ("shards", "rows"):
            assert len(list((self.set / folder).iterdir())) == self.markers()

    def stop(self) -> None:
        for process in self.processes:
            if process.poll() is None:
                kill(process)


def digest_in(output: str) -> str:
    lines = [line for line in output.splitlines() if line.startswith("digest ")]
    assert lines, output
    return lines[0]


def kill(process: subprocess.Popen[str]) -> None:
    """SIGKILL to a process alone: its child must end by itself."""
    process.send_signal(signal.SIGKILL)
    process.wait()


@pytest.fixture
def broker(tmp_path: Path) -> Iterator[NatsServer]:
    server = NatsServer(tmp_path / "broker").start()
    yield server
    server.kill()


@pytest.fixture
def work(tmp_path: Path) -> Iterator[Work]:
    work = Work(tmp_path, 60)
    yield work
    work.stop()


def test_workers_of_a_broker_make_what_one_render_makes(work: Work, broker: NatsServer) -> None:
    """Failure: another digest, a frame twice, or a worker that does not end when it is told to."""
    expected = work.expected_digest()
    rendering = work.render(broker.url)
    workers = [work.worker(broker.url) for _ in range(2)]
    output, _ = rendering.communicate(timeout=PATIENCE_S)
    assert rendering.returncode == 0, output
    assert digest_in(output) == expected
    for worker in workers:
        worker.send_signal(signal.SIGTERM)
        assert worker.wait(timeout=30) == 0
    assert work.run("verify", str(work.set)).returncode == 0


def test_killed_workers_cost_only_time(work: Work, broker: NatsServer) -> None:
    """Failure: a shard of a killed worker is never rendered, or a frame differs."""
    expected = work.expected_digest()
    chance = random.Random(7)
    rendering = work.render(broker.url)
    workers = [work.worker(broker.url) for _ in range(2)]
    for _ in range(6):
        time.sleep(0.2 + chance.random())
        kill(workers.pop(chance.randrange(len(workers))))
        workers.append(work.worker(broker.url))
    work.check(rendering, expected)


def test_a_wiped_broker_costs_only_time(work: Work, broker: NatsServer) -> None:
    """Failure: what the broker forgot is never rendered, or a frame differs."""
    expected = work.expected_digest()
    rendering = work.render(broker.url, "--window", "3")
    work.worker(broker.url)
    for markers in (2, 5):
        work.wait_for_markers(markers)
        broker.wipe()
    work.check(rendering, expected)


def test_a_worker_that_was_stopped_past_its_lease_changes_nothing(work: Work, broker: NatsServer) -> None:
    """Failure: its shard waits for it, or what it writes late counts twice."""
    expected = work.expected_digest()
    rendering = work.render(broker.url)
    sleeper = work.worker(broker.url)
    work.wait_for_markers(2)
    os.killpg(sleeper.pid, signal.SIGSTOP)
    work.worker(broker.url)
    work.wait_for_markers(60 // FRAMES_PER_SHARD)
    os.killpg(sleeper.pid, signal.SIGCONT)
    time.sleep(2)
    work.check(rendering, expected)


def test_a_worker_that_is_told_to_end_hands_its_shard_back_at_once(work: Work, broker: NatsServer) -> None:
    """Failure: the shard comes back only when the lease has run out."""
    rendering = work.render(broker.url, lease_s="600")
    leaver = work.worker(broker.url, lease_s="600")
    work.wait_for_markers(2)
    leaver.send_signal(signal.SIGTERM)
    assert leaver.wait(timeout=30) == 0
    work.worker(broker.url, lease_s="600")
    output, _ = rendering.communicate(timeout=PATIENCE_S)
    assert rendering.returncode == 0, output


def test_a_set_is_paused_and_cancelled_by_its_state(work: Work, broker: NatsServer) -> None:
    """Failure: a paused set goes on, or one that was cancelled is finished or left in the broker."""
    rendering = work.render(broker.url, "--window", "2")
    work.worker(broker.url)
    work.wait_for_markers(1)
    work.set_state("paused")
    time.sleep(4)
    paused_at = work.markers()
    time.sleep(3)
    assert work.markers() == paused_at < 60 // FRAMES_PER_SHARD
    assert rendering.poll() is None
    work.set_state("cancelled")
    output, _ = rendering.communicate(timeout=PATIENCE_S)
    assert rendering.returncode == 2, output
    assert "cancelled" in output


def test_what_cannot_work_says_why(work: Work, broker: NatsServer, tmp_path: Path) -> None:
    """Failure: another exit status, a message that does not name the cause, or a set outside of the store is touched."""
    nowhere = "nats://me:hush@127.0.0.1:1"
    away = work.run("worker", "--engine", nowhere, "--store", str(work.store))
    assert away.returncode == 5 and "no broker responds at nats://127.0.0.1:1" in away.stderr, away.stderr
    assert "hush" not in away.stderr + away.stdout
    storeless = work.run("worker", "--engine", broker.url)
    assert storeless.returncode == 2 and "--store" in storeless.stderr
    rendering = work.render(broker.url)
    stranger = work.worker(broker.url, store=tmp_path / "elsewhere")
    time.sleep(6)
    kill(stranger)
    kill(rendering)
    assert "does not lie in" in (stranger.stdout.read() if stranger.stdout else "")
    assert work.markers() == 0


@pytest.mark.long
def test_three_servers_of_which_one_is_away_at_a_time(tmp_path: Path) -> None:
    """Failure: the loss of one server of three stops the work or changes a frame."""
    work = Work(tmp_path, 200)
    expected = work.expected_digest()
    servers = start_cluster(tmp_path / "broker")
    engine = ",".join(server.url for server in servers)
    try:
        rendering = work.render(engine, "--replicas", "3")
        for _ in range(4):
            work.worker(engine, "--replicas", "3")
        for number, server in enumerate(servers):
            work.wait_for_markers(5 * (number + 1))
            server.kill()
            time.sleep(3)
            server.start()
        work.check(rendering, expected)
    finally:
        work.stop()
        for server in servers:
            server.kill()


@pytest.mark.long
@pytest.mark.parametrize("count", [1, 4, 16])
def test_any_number_of_workers_makes_the_same(tmp_path: Path, broker: NatsServer, count: int) -> None:
    """Failure: another digest."""
    work = Work(tmp_path, 200)
    expected = work.expected_digest()
    rendering = work.render(broker.url)
    for _ in range(count):
        work.worker(broker.url)
    work.check(rendering, expected)
