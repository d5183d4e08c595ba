"""Services that share a store and a broker: each shows every job, whatever is killed, stopped or lost.

Above each test stands what counts as failure.
"""

import json
import shutil
import signal

import pytest
from harness import call, end, job, wait_until
from nats_server import NatsServer
from service import Service

FRAMES = 60
SIZE = {"width": 64, "height": 48}
# Long enough for a busy machine, short enough for a test.
LEASE_S = "3"


class Fleet:
    """A broker, workers and services around one store."""

    def __init__(self, folder, store, env=None):
        self.folder, self.store, self.env = folder, store, env or {}
        self.broker = NatsServer(folder / "broker").start()
        self.workers, self.services = [], {}

    def place(self):
        """Options that every process has."""
        return ["--engine", self.broker.url, "--store", self.store, "--lease-s", LEASE_S]

    def work(self, **env):
        """Starts a worker."""
        self.workers.append(call("worker", *self.place(), env=self.env | env))
        return self.workers[-1]

    def serve(self, name):
        """Starts a service; a name has one data folder."""
        self.services[name] = Service(self.folder / name, *self.place(), env=self.env)
        return self.services[name]

    def stop(self):
        """Kills what still runs."""
        for process in [*self.workers, *(service.process for service in self.services.values())]:
            process.kill()
            process.wait()
        self.broker.kill()


@pytest.fixture
def fleet(tmp_path):
    """A fleet over a folder."""
    fleet = Fleet(tmp_path, tmp_path / "store")
    yield fleet
    fleet.stop()


@pytest.fixture
def digest(expected):
    """The digest of the job."""
    return expected(FRAMES, **SIZE)


def submit(service, key=None):
    """Submits the job, whether its images are there or not; returns its id."""
    headers = [("idempotency-key", key)] if key else []
    return service.json("/v1/jobs?again=true", job(FRAMES, **SIZE), headers=headers)["id"]


def shows(service, name):
    """Whether a service has heard of a job."""
    return service.ask(f"/v1/jobs/{name}")[0] == 200


def check_whole(service, name, digest):
    """The job is done with this digest, and its artifacts can be had."""
    wait_until(lambda: shows(service, name), "the service hears of the job")
    row = service.wait_for(name, state="done", done=FRAMES)
    assert row["digest"] == digest
    for frame in (0, FRAMES // 2, FRAMES - 1):
        status, found = service.ask(f"/v1/images/{name}/{frame}/artifacts/rgb")
        assert status == 200 and found.startswith(b"\x89PNG"), found


def test_two_services_show_the_same_jobs(fleet, digest, figure):
    """Failure: a job of one is not in the other, a key makes two jobs, a digest differs, or a worker is not listed."""
    one, two = fleet.serve("one"), fleet.serve("two")
    name = submit(one, key="k")
    assert submit(two, key="k") == name == submit(one, key="k")
    status, problem = two.ask("/v1/jobs", job(FRAMES + 1, **SIZE), headers=[("idempotency-key", "k")])
    assert (status, json.loads(problem)["type"]) == (422, "/problems/idempotency-key-reused")
    other = submit(two)
    wait_until(lambda: shows(one, other), "the other service hears of a job")
    for _ in range(2):
        fleet.work()
    for service in (one, two):
        wait_until(lambda service=service: len(service.json("/v1/workers")["items"]) == 2, "workers are listed")
        for found in (name, other):
            check_whole(service, found, digest)
        status, complete = service.ask("/v1/jobs", job(FRAMES, **SIZE))
        assert (status, json.loads(complete)["id"] in (name, other)) == (200, True), "its images are there"
    assert one.json("/v1/jobs")["items"][0]["created_at"][:18] == two.json("/v1/jobs")["items"][0]["created_at"][:18]
    worker = one.json("/v1/workers")["items"][0]
    assert worker["slots"] == 1 and worker["silent_ms"] < 60_000 and worker["code_version"]
    for worker in fleet.workers:
        worker.send_signal(signal.SIGTERM)
        assert worker.wait(60) == 0
    figure("NATS, two services, two workers", digest)


def test_kills_and_a_lost_disk_cost_only_time(fleet, digest):
    """Failure: a killed worker or service, a wiped broker or a data folder that is gone costs a frame, or a job."""
    one = fleet.serve("one")
    first, second = submit(one), submit(one)
    workers = [fleet.work() for _ in range(2)]
    # A fast machine may have done it before it is looked at.
    wait_until(lambda: one.job(first)["state"] != "queued", "the first job is begun")
    workers[0].kill()
    fleet.work()
    one.kill()
    fleet.broker.wipe()
    one, two = fleet.serve("one"), fleet.serve("two")
    for service in (one, two):
        for name in (first, second):
            check_whole(service, name, digest)
    assert one.stop() == 0
    shutil.rmtree(fleet.folder / "one")
    one = fleet.serve("one")
    wait_until(lambda: shows(one, first) and shows(one, second), "the jobs are there again")
    for name in (first, second):
        check_whole(one, name, digest)


def test_a_change_at_one_service_is_one_at_all(fleet, digest):
    """Failure: a paused or cancelled job goes on, or another service does not show it so."""
    one, two = fleet.serve("one"), fleet.serve("two")
    name = submit(one)
    wait_until(lambda: shows(two, name), "the other service hears of the job")
    assert one.json(f"/v1/jobs/{name}/pause", {})["state"] == "paused"
    two.wait_for(name, state="paused")
    fleet.work()
    assert two.json(f"/v1/jobs/{name}/resume", {})["state"] in ("queued", "running")
    check_whole(one, name, digest)
    for worker in fleet.workers:
        worker.kill()
    stopped = submit(two)
    wait_until(lambda: shows(one, stopped), "the other service hears of the job")
    assert one.json(f"/v1/jobs/{stopped}/cancel", {})["state"] == "cancelled"
    two.wait_for(stopped, state="cancelled")
    assert two.ask(f"/v1/jobs/{stopped}/resume", {})[0] == 409
    assert one.ask(f"/v1/jobs/{stopped}", method="DELETE")[0] == 200
    one.kill()
    one = fleet.serve("one")
    wait_until(lambda: shows(one, name), "the service shows its jobs again")
    assert not shows(one, stopped)


def test_failed_frames_are_tried_again(fleet, digest):
    """Failure: a frame that failed is not listed, or is not rendered when it is asked for through another service."""
    one, two = fleet.serve("one"), fleet.serve("two")
    poisoned = fleet.work(FATHOM_FAULTS="frame=panic#3")
    name = submit(one)
    for service in (one, two):
        wait_until(lambda service=service: shows(service, name), "the service hears of the job")
        row = service.wait_for(name, state="done_with_failures")
        assert (row["done"], row["failed"]) == (FRAMES - 1, 1)
        status, failures = service.ask(f"/v1/jobs/{name}/errors")
        assert status == 200 and b"broken on purpose" in failures
    poisoned.send_signal(signal.SIGTERM)
    poisoned.wait(60)
    fleet.work()
    assert two.json(f"/v1/jobs/{name}/retry-failed", {})["failed"] == 0
    for service in (one, two):
        check_whole(service, name, digest)


def test_a_bucket_is_shared_as_a_folder_is(tmp_path, moto, digest):
    """Failure: over a bucket a job is lost, a digest differs, or a secret is printed."""
    fleet = Fleet(tmp_path, f"s3://{moto.BUCKET}/shared", moto.env())
    try:
        one, two = fleet.serve("one"), fleet.serve("two")
        name = submit(one, key="k")
        assert submit(two, key="k") == name
        fleet.work()
        for service in (one, two):
            check_whole(service, name, digest)
            assert "hush" not in "".join(service.said)
    finally:
        fleet.stop()


def test_what_cannot_work_says_why(fleet, tmp_path):
    """Failure: a service without a store starts, or one whose broker is away shows no jobs."""
    storeless = end(call("serve", "--listen", "127.0.0.1:0", "--data", tmp_path / "x", "--engine", fleet.broker.url))
    assert storeless.code == 2 and "needs exactly one `--store`" in storeless.err
    fleet.broker.kill()
    one = fleet.serve("one")
    name = submit(one)
    two = fleet.serve("two")
    wait_until(lambda: shows(two, name), "the other service hears of the job without a broker")
    assert any("no broker responds" in line for line in two.said)
