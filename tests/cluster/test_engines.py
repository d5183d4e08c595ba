"""The recipes of examples/engines, run as they are: every engine must make what one process makes."""

import json
import os
import shutil
import subprocess
import sys
import threading

import kubernetes_validate
import pytest
import yaml
from harness import FATHOM, PATIENCE_S, ROOT, Bucket, Folder, end, job, wait_until

ENGINES = ROOT / "examples/engines"
FRAMES = 60
# A set is begun by whoever comes first; the division into shards is given here, so that four parts have work.
BEGIN = ("--frames-per-shard", "5", "--shard", "0/12")


@pytest.fixture
def work(tmp_path):
    """A set with one of twelve shards."""
    work = Folder(tmp_path, job(FRAMES))
    assert work.render(*BEGIN).code == 0
    return work


def environment(work):
    """What the recipes read."""
    return os.environ | work.env | {"FATHOM": FATHOM, "JOB": str(work.job), "SET": work.url, "PAUSE_S": "1"}


def recipe(work, *words):
    """Runs a recipe to its end."""
    ended = subprocess.run(
        [str(word) for word in words],
        env=environment(work),
        cwd=work.job.parent,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    return ended


def whole(work, expected):
    """Checks that nothing is left to do; returns the digest."""
    again = work.render()
    assert again.out.startswith("0 shards with 0 frames"), again.out
    assert (again.code, again.digest) == (0, expected(FRAMES))
    assert len(work.names("shards")) == len(work.names("rows")) == 12
    return again.digest


# Failure: a loop over parts makes another digest, or leaves a frame out.
def test_parallel(work, expected, figure):
    ended = recipe(work, "bash", ENGINES / "parallel.sh", 4)
    assert ended.returncode == 0, ended.stderr
    name = "GNU parallel" if shutil.which("parallel") else "xargs -P"
    figure(f"parallel.sh ({name})", whole(work, expected), "4 parts")


# Failure: a part that meets a store that is away is given up, or one that can never succeed is tried again.
def test_exit_status_5_is_tried_again_and_2_is_not(work):
    state = work.path / "state.json"
    state.write_text('{"state": "paused"}')
    threading.Timer(2, state.write_text, ['{"state": "running"}']).start()
    patient = recipe(work, "bash", ENGINES / "shard.sh", "1/4")
    assert patient.returncode == 0, patient.stderr
    assert "the set is paused" in patient.stderr
    state.write_text('{"state": "cancelled"}')
    refused = recipe(work, "bash", ENGINES / "shard.sh", "2/4")
    assert refused.returncode == 2
    assert refused.stderr.count("the set is cancelled") == 1


# Failure: tasks of a real server and worker make another digest.
def test_hyperqueue(work, expected, figure):
    from hyperqueue import LocalCluster
    from hyperqueue.cluster import WorkerConfig

    with LocalCluster(str(work.job.parent / "hq"), WorkerConfig(cores=2)) as cluster:
        folder = cluster.cluster.server_dir
        ended = recipe(work, sys.executable, ENGINES / "hyperqueue_parts.py", 4, folder)
        assert ended.returncode == 0, ended.stderr
        digest = whole(work, expected)
        work.job.write_text(json.dumps(job(FRAMES + 1)))
        assert recipe(work, sys.executable, ENGINES / "hyperqueue_parts.py", 2, folder).returncode == 1
    figure("HyperQueue, one server and worker", digest, "4 tasks")


# Failure: as above; Ray is large, so it is left out where it is not installed.
@pytest.mark.long
def test_ray(work, expected, figure):
    pytest.importorskip("ray", reason="SKIPPED: Ray is not installed here (pip install ray)")
    ended = recipe(work, sys.executable, ENGINES / "ray_parts.py", 4)
    assert ended.returncode == 0, ended.stderr
    figure("Ray", whole(work, expected), "4 tasks")


# Failure: an array of a real controller makes another digest, or a task that met a paused set is not queued again.
@pytest.mark.long
def test_slurm(work, expected, figure, slurm):
    def sbatch():
        submitted = recipe(work, "sbatch", "--export=ALL", "--parsable", ENGINES / "slurm-array.sbatch")
        assert submitted.returncode == 0, submitted.stderr
        return submitted.stdout.strip()

    def states(number):
        listed = recipe(work, "scontrol", "show", "job", number).stdout
        return [word.split("=")[1] for word in listed.split() if word.startswith("JobState=")]

    number = sbatch()
    wait_until(lambda: states(number) == ["COMPLETED"] * 4, "the array completes")
    figure("Slurm array", whole(work, expected), "--array=0-3%2")
    (work.path / "state.json").write_text('{"state": "paused"}')
    (work.path / "done/000003.json").unlink()
    number = sbatch()

    def is_queued_again():
        listed = recipe(work, "scontrol", "show", "job", f"{number}_3").stdout.split()
        return "Restarts=1" in listed and "JobState=PENDING" in listed

    wait_until(is_queued_again, "the task is queued again")
    (work.path / "state.json").unlink()
    # Slurm waits for two minutes by itself.
    recipe(work, "scontrol", "update", f"JobId={number}_3", "StartTime=now")
    wait_until(lambda: states(number) == ["COMPLETED"] * 4, "the array completes")
    work.run("gc", "--older", "0s")
    whole(work, expected)


# Failure: a manifest is not of the published schema, or the Indexed Job repeats what can never succeed.
@pytest.mark.parametrize("name", ["indexed-job.yaml", "workers.yaml"])
def test_kubernetes_manifests_are_valid(name):
    manifest = yaml.safe_load((ENGINES / "kubernetes" / name).read_text())
    kubernetes_validate.validate(manifest, kubernetes_validate.latest_version(), strict=True)
    wrong = json.loads(json.dumps(manifest).replace('"name"', '"nome"', 1))
    with pytest.raises(kubernetes_validate.ValidationError):
        kubernetes_validate.validate(wrong, kubernetes_validate.latest_version(), strict=True)
    (container,) = manifest["spec"]["template"]["spec"]["containers"]
    command = container["args"][0]
    usage = end(subprocess.Popen([FATHOM, command, "--help"], stdout=-1, stderr=-1, text=True)).out
    for option in (word.split("=")[0] for word in container["args"] if word.startswith("--")):
        assert f"{option} " in usage, f"fathom {command} has no {option}"


# Failure: the policy maps an exit status otherwise than the table in the README says.
def test_the_indexed_job_maps_exit_statuses():
    spec = yaml.safe_load((ENGINES / "kubernetes/indexed-job.yaml").read_text())["spec"]
    rules = spec["podFailurePolicy"]["rules"]
    actions = {code: rule["action"] for rule in rules for code in rule.get("onExitCodes", {}).get("values", [])}
    assert actions == {2: "FailIndex", 5: "Ignore"}
    assert f"--shard=$(JOB_COMPLETION_INDEX)/{spec['completions']}" in spec["template"]["spec"]["containers"][0]["args"]
    assert (spec["completionMode"], spec["template"]["spec"]["restartPolicy"]) == ("Indexed", "Never")


# Failure: parts of different engines on one bucket make another digest than one process.
def test_engines_share_a_bucket(tmp_path, moto, expected, figure):
    work = Bucket(tmp_path, moto, job(FRAMES), prefix="engines")
    assert work.render(*BEGIN).code == 0
    single = work.start("--shard", "1/2")
    loop = recipe(work, "bash", ENGINES / "parallel.sh", 3)
    assert loop.returncode == 0, loop.stderr
    assert end(single).code == 0
    figure("S3, a loop and a process", whole(work, expected), "3 parts and 1")
