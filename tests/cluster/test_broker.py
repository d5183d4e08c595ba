"""Workers that a broker hands shards to: whatever is killed, stopped or wiped, the set is that of one `fathom render`.

Above each test stands what counts as failure.
"""

import json
import os
import random
import signal
import time

import pytest
from harness import Folder, call, children, end, job, wait_until
from nats_server import NatsServer, start_cluster

FRAMES_PER_SHARD = 5
SIZE = {"width": 64, "height": 48}
# Long enough for a busy machine, short enough for a test.
LEASE_S = "3"


class Work(Folder):
    """A set in a folder, and the processes that a broker joins to render it."""

    def __init__(self, folder, frames):
        super().__init__(folder, job(frames, **SIZE))
        self.store = folder
        self.shards = -(-frames // FRAMES_PER_SHARD)
        self.processes = []

    def begin(self, engine, *options, lease_s=LEASE_S):
        """Starts to hand out the shards."""
        shards = ["--frames-per-shard", FRAMES_PER_SHARD]
        return self.keep(self.start(*shards, "--engine", engine, "--lease-s", lease_s, *options))

    def worker(self, engine, *options, lease_s=LEASE_S, store=None):
        """Starts a worker."""
        place = ["--engine", engine, "--store", store or self.store]
        return self.keep(call("worker", *place, "--lease-s", lease_s, *options))

    def keep(self, process):
        """Remembers a process that must not outlive the test."""
        self.processes.append(process)
        return process

    def markers(self):
        """Number of finished shards."""
        return len(self.names("done"))

    def wait_for_markers(self, count):
        """Waits until so many shards are finished."""
        wait_until(lambda: self.markers() >= count, f"{count} shards")

    def set_state(self, state):
        """Writes the state that all processes look at."""
        (self.path / "state.json").write_text(json.dumps({"state": state}))

    def check(self, rendering, digest):
        """The run ended well, with this digest; every frame is there once, and of each shard one winner."""
        ended = end(rendering)
        assert ended.code == 0, ended.err
        assert ended.digest == digest
        assert self.run("verify").code == 0
        self.stop()
        assert self.run("gc", "--older", "0s").code == 0
        for part in ("shards", "rows"):
            assert len(self.names(part)) == self.markers()

    def stop(self):
        """Kills what still runs."""
        for process in self.processes:
            kill(process)


def kill(process):
    """SIGKILL to a process alone: its child must end by itself."""
    process.kill()
    process.wait()


@pytest.fixture
def broker(tmp_path):
    """A broker of one server."""
    server = NatsServer(tmp_path / "broker").start()
    yield server
    server.kill()


@pytest.fixture
def work(tmp_path):
    """A job of twelve shards."""
    work = Work(tmp_path, 60)
    yield work
    work.stop()


@pytest.fixture
def digest(expected):
    """The digest of that job."""
    return expected(60, **SIZE)


def test_workers_of_a_broker_make_what_one_render_makes(work, broker, digest, figure):
    """Failure: another digest, a frame twice, or a worker that does not end when it is told to."""
    rendering = work.begin(broker.url)
    workers = [work.worker(broker.url) for _ in range(2)]
    ended = end(rendering)
    assert (ended.code, ended.digest) == (0, digest), ended.err
    for worker in workers:
        worker.send_signal(signal.SIGTERM)
        assert worker.wait(timeout=30) == 0
    assert work.run("verify").code == 0
    figure("NATS, two workers", digest)


def test_killed_workers_cost_only_time(work, broker, digest):
    """Failure: a shard of a killed worker is never rendered, or a frame differs."""
    chance = random.Random(7)
    rendering = work.begin(broker.url)
    workers = [work.worker(broker.url) for _ in range(2)]
    for _ in range(6):
        time.sleep(0.2 + chance.random())
        kill(workers.pop(chance.randrange(len(workers))))
        workers.append(work.worker(broker.url))
    work.check(rendering, digest)


def test_a_wiped_broker_costs_only_time(work, broker, digest):
    """Failure: what the broker forgot is never rendered, or a frame differs."""
    rendering = work.begin(broker.url, "--window", "3")
    work.worker(broker.url)
    for markers in (2, 5):
        work.wait_for_markers(markers)
        broker.wipe()
    work.check(rendering, digest)


def test_a_worker_that_was_stopped_past_its_lease_changes_nothing(work, broker, digest):
    """Failure: its shard waits for it, or what it writes late counts twice."""
    rendering = work.begin(broker.url)
    sleeper = work.worker(broker.url)
    work.wait_for_markers(2)
    stopped = [sleeper.pid, *children(sleeper)]
    for pid in stopped:
        os.kill(pid, signal.SIGSTOP)
    work.worker(broker.url)
    work.wait_for_markers(work.shards)
    for pid in stopped:
        os.kill(pid, signal.SIGCONT)
    time.sleep(2)
    work.check(rendering, digest)


def test_a_worker_that_is_told_to_end_hands_its_shard_back_at_once(work, broker):
    """Failure: the shard comes back only when the lease has run out."""
    rendering = work.begin(broker.url, lease_s="600")
    leaver = work.worker(broker.url, lease_s="600")
    work.wait_for_markers(2)
    leaver.send_signal(signal.SIGTERM)
    assert leaver.wait(timeout=30) == 0
    work.worker(broker.url, lease_s="600")
    ended = end(rendering)
    assert ended.code == 0, ended.err


def test_a_set_is_paused_and_cancelled_by_its_state(work, broker):
    """Failure: a paused set goes on, or one that was cancelled is finished."""
    rendering = work.begin(broker.url, "--window", "2")
    work.worker(broker.url)
    work.wait_for_markers(1)
    work.set_state("paused")
    time.sleep(4)
    paused_at = work.markers()
    time.sleep(3)
    assert work.markers() == paused_at < work.shards
    assert rendering.poll() is None
    work.set_state("cancelled")
    ended = end(rendering)
    assert ended.code == 2 and "cancelled" in ended.err, ended.err


def test_what_cannot_work_says_why(work, broker, tmp_path):
    """Failure: another exit status, a message that does not name the cause, or a set outside of the store is touched."""
    nowhere = "nats://me:hush@127.0.0.1:1"
    away = end(call("worker", "--engine", nowhere, "--store", work.store))
    assert away.code == 5 and "no broker responds at nats://127.0.0.1:1" in away.err, away.err
    assert "hush" not in away.err + away.out
    storeless = end(call("worker", "--engine", broker.url))
    assert storeless.code == 2 and "--store" in storeless.err
    rendering = work.begin(broker.url)
    stranger = work.worker(broker.url, store=tmp_path / "elsewhere")
    time.sleep(6)
    stranger.kill()
    assert "does not lie in" in end(stranger).err
    kill(rendering)
    assert work.markers() == 0


@pytest.mark.long
def test_three_servers_of_which_one_is_away_at_a_time(tmp_path, expected):
    """Failure: the loss of one server of three stops the work or changes a frame."""
    work = Work(tmp_path, 200)
    digest = expected(200, **SIZE)
    servers = start_cluster(tmp_path / "broker")
    engine = ",".join(server.url for server in servers)
    try:
        rendering = work.begin(engine, "--replicas", "3")
        for _ in range(4):
            work.worker(engine, "--replicas", "3")
        for number, server in enumerate(servers):
            work.wait_for_markers(5 * (number + 1))
            server.kill()
            time.sleep(3)
            server.start()
        work.check(rendering, digest)
    finally:
        work.stop()
        for server in servers:
            server.kill()


@pytest.mark.long
@pytest.mark.parametrize("count", [1, 4, 16])
def test_any_number_of_workers_makes_the_same(tmp_path, broker, expected, figure, count):
    """Failure: another digest."""
    work = Work(tmp_path, 200)
    digest = expected(200, **SIZE)
    rendering = work.begin(broker.url)
    for _ in range(count):
        work.worker(broker.url)
    work.check(rendering, digest)
    figure(f"NATS, {count} workers", digest)
