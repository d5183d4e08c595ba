"""Kills at random: whatever dies when, the digest is that of a plain render, and only winners stay."""

import os
import random
import signal
import time

from harness import Bucket, Folder, Wire, children, end, job, kill, wait_until

FRAMES = 240
KILLS = int(os.environ.get("FATHOM_KILLS", "20"))
RACERS = 3
SEED = 20261122


def finish(work, expected):
    """Ends the work and checks what is there."""
    again = work.render()
    assert (again.code, again.digest) == (0, expected(FRAMES)), again.err
    verified = work.run("verify", "--render", "2")
    assert verified.code == 0, verified.out + verified.err
    status = work.status()
    assert (status["frames_done"], status["failed"], status["alarms"]) == (FRAMES, 0, 0)
    assert work.run("gc", "--older", "0s").code == 0
    for part in ("shards", "rows"):
        assert len(work.names(part)) == status["shards"]
    return again.digest


def race(work, chance, wanted):
    """Lets three processes race for a set, and kills them and their children; returns how many were killed."""
    racers = [work.start("--frames-per-shard", "6") for _ in range(RACERS)]
    killed = 0
    while killed < wanted and all(racer.poll() in (None, -signal.SIGKILL) for racer in racers):
        time.sleep(chance.uniform(0.01, 0.25))
        number = chance.randrange(RACERS)
        victims = [racers[number].pid] if chance.random() < 0.5 else children(racers[number])
        killed += sum(kill(victim) for victim in victims)
        for number, racer in enumerate(racers):
            if racer.poll() == -signal.SIGKILL:
                racer.communicate()
                racers[number] = work.start()
    for racer in racers:
        ended = end(racer)
        assert ended.code in (0, -signal.SIGKILL), ended.err
    return killed


def kill_and_compare(sets, expected):
    """Races in one set after the other until enough was killed; returns the digest and the number of kills."""
    chance, killed = random.Random(SEED), 0
    while killed < KILLS:
        work = next(sets)
        killed += race(work, chance, KILLS - killed)
        digest = finish(work, expected)
    return digest, killed


# Failure: after any of the kills the digest differs, a frame is missing or twice there, or gc leaves a loser's file.
def test_racing_processes_are_killed_in_a_folder(tmp_path, expected, figure):
    def folders():
        for number in range(KILLS):
            (place := tmp_path / str(number)).mkdir()
            yield Folder(place, job(FRAMES))

    digest, killed = kill_and_compare(folders(), expected)
    figure("folder, three racing processes", digest, f"{killed} kills")


# Failure: as above, in a bucket.
def test_racing_processes_are_killed_in_a_bucket(tmp_path, moto, expected, figure):
    buckets = (Bucket(tmp_path, moto, job(FRAMES), prefix=f"killed/{number}") for number in range(KILLS))
    digest, killed = kill_and_compare(buckets, expected)
    figure("S3, three racing processes", digest, f"{killed} kills")


# Failure: a process that slept while others did its shard overwrites them, fails, or leaves its files.
def test_a_paused_process_wakes_up_past_its_place(tmp_path, moto, expected, figure):
    for work in (Folder(tmp_path, job(FRAMES)), Bucket(tmp_path, moto, job(FRAMES), prefix="paused")):
        sleeper = work.start("--frames-per-shard", "120")
        wait_until(lambda process=sleeper: children(process), "a child renders")
        os.kill(sleeper.pid, signal.SIGSTOP)
        assert work.status()["done"] == 0, "it was too fast to be paused"
        other = work.render()
        assert (other.code, other.digest) == (0, expected(FRAMES)), other.err
        os.kill(sleeper.pid, signal.SIGCONT)
        late = end(sleeper)
        assert (late.code, late.digest) == (0, expected(FRAMES)), late.err
        assert len(work.names("shards")) == len(work.names("rows")) == 2
    figure("one process stopped past its place", late.digest, "folder and S3")


# Failure: an outage of the store between kills changes anything.
def test_the_store_goes_away_while_processes_are_killed(tmp_path, moto, expected, figure):
    wire = Wire(moto)
    work = Bucket(tmp_path, moto, job(FRAMES), prefix="outage")
    work.env |= moto.env(wire.url)
    racers = [work.start("--frames-per-shard", "6") for _ in range(RACERS)]
    wait_until(lambda: work.names("done"), "a marker")
    kill(racers[0].pid)
    wire.cut()
    time.sleep(1)
    kill(racers[1].pid)
    wire.mend()
    assert end(racers[2]).code == 0
    for racer in racers[:2]:
        racer.communicate()
    digest = finish(work, expected)
    wire.cut()
    figure("S3, a second of outage", digest, "2 kills")
