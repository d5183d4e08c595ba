"""Sets in a bucket, on an S3 server of another maker. Above each test stands what counts as failure."""

import json
import signal
import time

import pytest
from harness import Bucket, Moto, Wire, call, end, job, kill, wait_until

FRAMES = 60
OPTIONS = ("--frames-per-shard", "5")


@pytest.fixture
def bucket(tmp_path, moto, request):
    """An empty prefix of the bucket."""
    return Bucket(tmp_path, moto, job(FRAMES), prefix=f"sets/{request.node.name}")


# Failure: two processes leave out a frame, make another digest than a plain render, or a command on the set fails.
def test_two_processes_render_into_a_bucket(bucket, expected, figure):
    halves = [bucket.start(*OPTIONS, "--shard", part) for part in ("0/2", "1/2")]
    for half in map(end, halves):
        assert half.code == 0, half.err
    again = bucket.render()
    assert again.out.startswith("0 shards with 0 frames"), again.out
    assert again.digest == expected(FRAMES)
    status = bucket.status()
    assert (status["done"], status["frames_done"], status["orphans"], status["alarms"]) == (12, FRAMES, 0, 0)
    verified = bucket.run("verify", "--render", "2")
    assert verified.code == 0, verified.out + verified.err
    manifest = json.loads(bucket.run("seal").out)
    assert (manifest["digest"], manifest["images"]) == (expected(FRAMES), FRAMES)
    assert bucket.run("gc", "--older", "0s").out == "0 files removed\n"
    assert len(bucket.names("shards")) == len(bucket.names("rows")) == 12
    figure("S3, two processes", again.digest)


# Failure: a file above the size of one request is not uploaded in parts, or comes back with other bytes.
def test_a_large_tar_is_uploaded_in_parts(tmp_path, moto):
    bucket = Bucket(tmp_path, moto, job(24, width=768, height=492), prefix="large")
    assert bucket.render().code == 0
    marker = json.loads(bucket.read("done/000000.json"))
    name = f"shards/000000-{marker['attempt']}.tar"
    assert marker["tar"]["bytes"] > 8 << 20, "too small to prove anything"
    head = moto.client().head_object(Bucket=moto.BUCKET, Key=f"large/{name}")
    assert "-" in head["ETag"], "it was uploaded in one piece"
    assert bucket.run("verify").code == 0


# Failure: what a killed process leaves counts, stays after gc, or changes the digest.
def test_a_killed_process_costs_only_time(bucket, expected):
    run = bucket.start(*OPTIONS)
    wait_until(lambda: bucket.names("done"), "a marker")
    kill(run.pid)
    run.communicate()
    aborted = bucket.render(FATHOM_FAULTS="shard.files_written=abort@1")
    assert aborted.code == -signal.SIGABRT
    # Two of the second attempt, and what the first one had uploaded.
    assert bucket.status()["unfinished"] in (2, 3, 4)
    again = bucket.render()
    assert (again.code, again.digest) == (0, expected(FRAMES)), again.err
    assert bucket.run("gc", "--older", "0s").code == 0
    assert len(bucket.names("shards")) == len(bucket.names("rows")) == 12


# Failure: several attempts at one shard have two winners, or a loser leaves its files.
def test_of_attempts_at_the_same_shard_one_wins(bucket, expected):
    racers = [bucket.start("--frames-per-shard", "20") for _ in range(3)]
    for racer in map(end, racers):
        assert (racer.code, racer.digest) == (0, expected(FRAMES)), racer.err
    assert len(bucket.names("done")) == len(bucket.names("shards")) == len(bucket.names("rows")) == 3
    winners = {json.loads(bucket.read(f"done/{name}"))["attempt"] for name in bucket.names("done")}
    assert {name.split("-")[1].split(".")[0] for name in bucket.names("shards")} == winners


# Failure: a bucket that has another job or does not exist is rendered into, or an engine would try it again.
def test_another_job_and_a_wrong_bucket_are_refused(bucket, tmp_path, moto):
    assert bucket.render(*OPTIONS, "--shard", "0/12").code == 0
    other = tmp_path / "other"
    other.mkdir()
    refused = Bucket(other, moto, job(FRAMES + 1), prefix=bucket.prefix).render()
    assert refused.code == 2
    assert "holds another job (digest " in refused.err
    bucket.url = "s3://nowhere/set"
    for ended in (bucket.render(), bucket.run("status")):
        assert ended.code == 2
        assert "s3://nowhere/set: the bucket does not exist" in ended.err


# Failure: a store that nobody serves is given up for good, or a secret is printed.
def test_a_store_that_is_not_there_is_tried_again_later(bucket):
    bucket.env |= {"AWS_ENDPOINT_URL": "http://127.0.0.1:9"}
    for ended in map(end, [bucket.start(), call("status", bucket.url, env=bucket.env)]):
        assert ended.code == 5, ended.err
        assert "does not respond" in ended.err
        assert "hush" not in ended.err


# Failure: credentials that the store refuses are tried again, or printed.
def test_credentials_that_are_refused_end_the_call(tmp_path):
    server = Moto(INITIAL_NO_AUTH_ACTION_COUNT="1")
    refused = Bucket(tmp_path, server, job(5)).render()
    server.kill()
    assert refused.code == 2, refused.err
    assert "check AWS_ACCESS_KEY_ID" in refused.err
    assert "hush" not in refused.err


# Failure: a store that overwrites what was to be created only if absent is written to.
def test_a_store_without_conditional_writes_is_refused(bucket, moto):
    wire = Wire(moto, lambda data: data.replace(b"if-none-match", b"x-none-match2"))
    bucket.env |= moto.env(wire.url)
    refused = bucket.render()
    wire.cut()
    assert refused.code == 2
    assert "overwrites an object that was to be created only if absent" in refused.err
    assert not bucket.names("done") and not bucket.names("shards")


# Failure: a server that restarts ends the work.
def test_an_outage_of_two_seconds_costs_only_time(bucket, moto, expected):
    wire = Wire(moto)
    bucket.env |= moto.env(wire.url)
    run = bucket.start(*OPTIONS)
    wait_until(lambda: bucket.names("done"), "a marker")
    wire.cut()
    time.sleep(2)
    wire.mend()
    ended = end(run)
    wire.cut()
    assert (ended.code, ended.digest) == (0, expected(FRAMES)), ended.err


# Failure: after an outage in the middle the call does not ask to be repeated, or the next one does not finish the work.
def test_a_server_that_comes_back_with_its_data(bucket, moto, expected):
    wire = Wire(moto)
    bucket.env |= moto.env(wire.url)
    run = bucket.start("--frames-per-shard", "3")
    wait_until(lambda: bucket.names("done"), "a marker")
    wire.cut()
    ended = end(run)
    assert ended.code == 5, ended.err
    before = len(bucket.names("done"))
    assert 0 < before < FRAMES / 3
    wire.mend()
    again = bucket.render()
    wire.cut()
    assert (again.code, again.digest) == (0, expected(FRAMES)), again.err
    assert again.out.startswith(f"{FRAMES // 3 - before} shards"), again.out


# Failure: a server that is killed and has lost everything leaves a process that believes in markers that are gone.
def test_a_server_that_is_killed_and_comes_back_empty(tmp_path, expected):
    server = Moto()
    bucket = Bucket(tmp_path, server, job(FRAMES))
    run = bucket.start("--frames-per-shard", "3")
    wait_until(lambda: bucket.names("done"), "a marker")
    server.kill()
    ended = end(run)
    assert ended.code == 5, ended.err
    server.start()
    again = bucket.render(*OPTIONS)
    server.kill()
    assert (again.code, again.digest) == (0, expected(FRAMES)), again.err
