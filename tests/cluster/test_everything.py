"""Everything at once: services, workers, three brokers and a store, all of which are killed at random until FATHOM_KILLS are dead."""

import json
import os
import random
import signal
import threading
import time
from collections import Counter

import pytest
from harness import Bucket, KeptServer, call, children, job, kill, wait_until
from nats_server import start_cluster
from service import Service

KILLS = int(os.environ.get("FATHOM_KILLS", "100"))
SEED = 20261123
FRAMES = 1500
SIZE = {"width": 64, "height": 48}
LEASE_S = 4
# Who is killed how often, of a hundred.
SHARES = {"worker": 24, "child": 20, "service": 16, "store": 16, "broker 0": 8, "broker 1": 8, "broker 2": 8}
WORKERS = 2


class Everything:
    """A store, three servers of a broker, two services and workers."""

    def __init__(self, folder):
        self.folder = folder
        self.store = KeptServer(folder / "store")
        self.env = self.store.env()
        self.brokers = start_cluster(folder / "broker")
        self.services = [self.serve(number) for number in range(2)]
        self.workers = [self.work() for _ in range(WORKERS)]
        self.stopped, self.ended = [], Counter()

    def place(self):
        engine = ",".join(broker.url for broker in self.brokers)
        store = f"s3://{self.store.BUCKET}/jobs"
        return ["--engine", engine, "--store", store, "--lease-s", str(LEASE_S), "--replicas", "3"]

    def serve(self, number):
        return Service(self.folder / f"service{number}", *self.place(), env=self.env)

    def work(self):
        # Where it writes nobody reads; a full pipe would stop it.
        worker = call("worker", *self.place(), env=self.env)
        for pipe in (worker.stdout, worker.stderr):
            threading.Thread(target=pipe.read, daemon=True).start()
        return worker

    def strike(self, victim, chance):
        """Kills one; returns whether it was there."""
        if victim == "worker":
            number = chance.randrange(WORKERS)
            kill(self.workers[number].pid)
            return True
        if victim == "child":
            return any([kill(pid) for pid in children(chance.choice(self.workers))])
        if victim == "service":
            number = chance.randrange(2)
            self.services[number].kill()
            self.services[number] = self.serve(number)
            return True
        server = self.store if victim == "store" else self.brokers[int(victim[-1])]
        server.kill()
        time.sleep(chance.uniform(0.2, 2))
        server.start()
        return True

    def stop_a_worker(self):
        """Stops a worker with its child until others have its shard."""
        worker = self.workers[0]
        pids = [worker.pid, *children(worker)]
        for pid in pids:
            os.kill(pid, signal.SIGSTOP)
        self.stopped.append((time.monotonic() + 2 * LEASE_S, worker, pids))
        self.workers[0] = self.work()

    def wipe(self):
        """The brokers forget everything."""
        for broker in self.brokers:
            broker.kill()
        for broker in self.brokers:
            broker.wipe()

    def heal(self):
        """Wakes those who have slept enough, and replaces who has ended: by SIGKILL, because store or broker were away, or told to."""
        for entry in [entry for entry in self.stopped if entry[0] < time.monotonic()]:
            self.stopped.remove(entry)
            for pid in entry[2]:
                os.kill(pid, signal.SIGCONT)
            self.workers.append(entry[1])
        for number, worker in reversed(list(enumerate(self.workers))):
            if worker.poll() is None:
                continue
            assert worker.returncode in (0, 5, -signal.SIGKILL), worker.returncode
            self.ended[worker.returncode] += 1
            del self.workers[number]
        while len(self.workers) < WORKERS:
            self.workers.append(self.work())
        for extra in self.workers[WORKERS:]:
            extra.terminate()

    def end(self):
        """Kills what still runs."""
        for process in [*self.workers, *(entry[1] for entry in self.stopped)]:
            kill(process.pid)
            process.wait()
        for service in self.services:
            service.kill()
        for broker in self.brokers:
            broker.kill()
        self.store.kill()


def plan(chance):
    """Who is struck, in which order."""
    victims = [victim for victim, share in SHARES.items() for _ in range(max(1, share * KILLS // 100))]
    chance.shuffle(victims)
    for third, event in [(4, "stop"), (3, "wipe"), (2, "stop"), (1, "wipe")]:
        victims.insert(third * len(victims) // 5, event)
    return victims


def submit(everything, key):
    """Submits the job to a service that may be starting; returns its id."""
    found = []

    def taken():
        description = job(FRAMES, **SIZE)
        try:
            status, text = everything.services[0].ask("/v1/jobs?again=true", description, headers=[("idempotency-key", key)])
        except OSError:
            return False
        if status < 300:
            found.append(json.loads(text)["id"])
        return bool(found)

    wait_until(taken, "a service takes the job")
    return found[0]


@pytest.mark.long
def test_everything_is_killed_and_nothing_is_lost(tmp_path, expected, figure):
    """Failure: a digest differs from that of one undisturbed render, a frame is missing, or a loser's file stays after gc."""
    digest, chance = expected(FRAMES, **SIZE), random.Random(SEED)
    everything, killed, jobs = Everything(tmp_path), Counter(), []
    try:
        jobs.append(submit(everything, "0"))
        for victim in plan(chance):
            until = time.monotonic() + chance.uniform(0.3, 3)
            while time.monotonic() < until:
                everything.heal()
                time.sleep(0.05)
            if victim == "stop":
                everything.stop_a_worker()
            elif victim == "wipe":
                everything.wipe()
            else:
                wait_until(lambda victim=victim: everything.heal() or everything.strike(victim, chance), f"a {victim} dies")
            killed[victim] += 1
            if done(everything, jobs[-1]):
                jobs.append(submit(everything, str(len(jobs))))
        wait_until(lambda: everything.heal() or all(done(everything, name) for name in jobs), "every job is done")
        check(everything, tmp_path, jobs, digest)
    finally:
        everything.end()
    deaths = sum(count for victim, count in killed.items() if victim not in ("stop", "wipe"))
    figure(f"NATS (three servers), S3 server, two services, {len(jobs)} jobs of {FRAMES}", digest, f"{deaths} kills")
    print(dict(killed), dict(everything.ended))


def done(everything, name):
    """Whether both services show all frames of a job."""
    try:
        return all(service.job(name)["done"] == FRAMES for service in everything.services)
    except (OSError, AssertionError):
        # It is starting, or its store is.
        return False


def check(everything, folder, jobs, digest):
    """Both services and the store have every frame once, and gc leaves winners."""
    for name in jobs:
        for service in everything.services:
            row = service.wait_for(name, state="done", done=FRAMES)
            assert (row["digest"], row["failed"]) == (digest, 0)
    for worker in everything.workers:
        kill(worker.pid)
    for name in jobs:
        work = Bucket(folder, everything.store, job(FRAMES, **SIZE), prefix=f"jobs/{name}")
        verified = work.run("verify")
        assert verified.code == 0, verified.err
        status = work.status()
        assert (status["frames_done"], status["failed"], status["alarms"]) == (FRAMES, 0, 0)
        assert work.run("gc", "--older", "0s").code == 0
        for part in ("shards", "rows"):
            assert len(work.names(part)) == len(work.names("done")) == status["shards"]
