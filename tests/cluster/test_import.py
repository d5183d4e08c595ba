"""Sets in a bucket, shown by a service. Above each test stands what counts as failure."""

import hashlib
import json

import pytest
from harness import Bucket, end, job, wait_until
from service import Service

FRAMES = 20
OPTIONS = ("--frames-per-shard", "5")


@pytest.fixture
def bucket(tmp_path, moto, request):
    """An empty prefix of the bucket."""
    return Bucket(tmp_path, moto, job(FRAMES), prefix=f"imported/{request.node.name}")


@pytest.fixture
def serve(tmp_path, bucket):
    """Starts services that end with the test."""
    services = []

    def start(*options, data="data", **env):
        services.append(Service(tmp_path / data, *options, env=bucket.env | env))
        return services[-1]

    yield start
    for service in services:
        service.kill()


def records(service, name):
    """The record of every frame of a job."""
    return [service.json(f"/v1/images/{name}/{frame}") for frame in range(FRAMES)]


def check_artifacts(service, name):
    """Every artifact has the bytes that its record names; returns how many there are."""
    count = 0
    for frame, record in enumerate(records(service, name)):
        for artifact in record["artifacts"]:
            status, found = service.ask(f"/v1/images/{name}/{frame}/artifacts/{artifact['kind']}")
            assert status == 200, found
            assert hashlib.sha256(found).hexdigest() == artifact["digest"]
            count += 1
    return count


def imported(bucket, tmp_path):
    """Imports into the data folder; returns the job."""
    ended = bucket.run("import", "--json", "--data", tmp_path / "data")
    assert ended.code == 0, ended.err
    return json.loads(ended.out)["job"]


def test_a_data_folder_shows_the_images_of_a_bucket(bucket, serve, expected, tmp_path):
    """Failure: an artifact differs, one that is gone is not said to be, or a secret is printed."""
    assert bucket.render(*OPTIONS).code == 0
    row = imported(bucket, tmp_path)
    assert (row["state"], row["digest"], row["set"]) == ("done", expected(FRAMES), bucket.url)
    assert imported(bucket, tmp_path) == row
    service = serve()
    assert check_artifacts(service, row["id"]) == 2 * FRAMES
    first = json.loads(bucket.read("done/000000.json"))["attempt"]
    key = f"{bucket.prefix}/shards/000000-{first}.tar"
    bucket.server.client().delete_object(Bucket=bucket.server.BUCKET, Key=key)
    status, problem = service.ask(f"/v1/images/{row['id']}/0/artifacts/rgb")
    assert (status, json.loads(problem)["type"]) == (410, "/problems/set-changed")
    assert service.ask(f"/v1/images/{row['id']}/5/artifacts/rgb")[0] == 200
    assert service.stop() == 0
    away = serve(AWS_ENDPOINT_URL="http://127.0.0.1:9")
    status, problem = away.ask(f"/v1/images/{row['id']}/5/artifacts/rgb")
    assert (status, json.loads(problem)["type"]) == (502, "/problems/set-unreachable")
    assert "hush" not in problem.decode() + "".join(away.said)


def test_a_running_service_follows_a_bucket_that_fills(bucket, serve, expected):
    """Failure: a shard is missed or counted twice, whatever is killed, or the job differs from one that was rendered here."""
    assert bucket.render(*OPTIONS, "--shard", "0/4").code == 0
    service = serve("--store", f"s3://{bucket.server.BUCKET}/imported")
    there = service.json("/v1/sets", {"url": bucket.url})
    assert there["url"] == bucket.url and there["followed"]
    service.wait_for(there["job"], done=5)
    assert service.json("/v1/sets", {"url": bucket.url})["job"] == there["job"]
    assert bucket.render(*OPTIONS, "--shard", "1/4").code == 0
    service.wait_for(there["job"], done=10)
    service.kill()
    rendering = bucket.start(*OPTIONS)
    service = serve("--store", f"s3://{bucket.server.BUCKET}/imported")
    row = service.wait_for(there["job"], state="done", done=FRAMES)
    assert end(rendering).code == 0
    assert row["digest"] == expected(FRAMES)
    assert check_artifacts(service, there["job"]) == 2 * FRAMES
    wait_until(lambda: not service.json(f"/v1/sets/{there['job']}")["followed"], "the service looks no further")


def test_only_what_lies_in_a_store_is_read(bucket, serve, tmp_path):
    """Failure: a set elsewhere is read, or what is refused leaves a job behind."""
    assert bucket.render(*OPTIONS).code == 0
    service = serve("--store", f"s3://{bucket.server.BUCKET}/other", "--store", tmp_path / "sets")
    for url in [bucket.url, f"s3://{bucket.server.BUCKET}/other/../{bucket.prefix}", "s3://else/set", "/etc", "gs://a/b"]:
        status, problem = service.ask("/v1/sets", {"url": url})
        assert (status, json.loads(problem)["errors"][0]["pointer"]) == (422, "/url"), problem
    assert service.json("/v1/jobs")["items"] == []
    status, problem = service.ask("/v1/sets", {"url": f"s3://{bucket.server.BUCKET}/other/none"})
    assert status == 422 and "holds no set" in problem.decode()
