"""What can be wrong with a set, the message and the exit status of each. The table in docs/reference/sharded-datasets.md is made of these.

Wrong credentials, a store without conditional writes, wrong buckets and servers that are away are in test_s3.py; a full
store is a unit test of the crate `sets`.
"""

import json
import os

import pytest
from harness import Folder, job

FRAMES = 20


@pytest.fixture
def work(tmp_path):
    """A finished set of four shards."""
    work = Folder(tmp_path, job(FRAMES))
    assert work.render("--frames-per-shard", "5").code == 0
    return work


# Failure: another job is rendered into a set, or an engine would try it again.
def test_another_job_is_refused(work):
    work.job.write_text(json.dumps(job(FRAMES, seed=4)))
    refused = work.render()
    assert refused.code == 2
    assert "holds another job (digest " in refused.err


# Failure: a clock that is wrong by years changes the digest, keeps a shard from being done or from being swept, or
# sweeps what is young.
def test_nothing_depends_on_a_clock(work, expected):
    marker = work.path / "done/000001.json"
    text = json.loads(marker.read_text()) | {"created_ms": 4_102_444_800_000}
    marker.write_text(json.dumps(text))
    for name in [*work.names("shards"), *work.names("rows")]:
        path = next(work.path.glob(f"*/{name}"))
        stamp = 4_102_444_800 if name.startswith("000002") else 1
        os.utime(path, (stamp, stamp))
    (work.path / "done/000003.json").unlink()
    again = work.render()
    assert (again.code, again.digest) == (0, expected(FRAMES)), again.err
    assert again.out.startswith("1 shard with 5 frames")
    assert work.run("verify", "--render", "4").code == 0
    swept = work.run("gc", "--older", "1d")
    assert swept.out == "2 files removed\n", "the files of the shard that lost its marker are of 1970"
    assert (work.run("verify").code, work.run("seal").code) == (0, 0)


# Failure: a tar that was cut off, or a file that is gone, is not noticed, or is not made again as the message says.
@pytest.mark.parametrize("damage", ["cut", "gone", "rows"])
def test_damage_is_said_and_repaired_as_said(work, expected, damage):
    name = work.names("rows" if damage == "rows" else "shards")[1]
    path = work.path / ("rows" if damage == "rows" else "shards") / name
    if damage == "cut":
        path.write_bytes(path.read_bytes()[:1000])
    else:
        path.unlink()
    found = work.run("verify")
    assert found.code == 1
    assert ("has 1000 bytes, its marker says " if damage == "cut" else f"{name} is gone") in found.out
    assert "1 damaged; remove the marker of a damaged shard from done/ and render again" in found.err
    (work.path / "done/000001.json").unlink()
    again = work.render()
    assert (again.code, again.digest) == (0, expected(FRAMES)), again.err
    assert work.run("verify").code == 0


# Failure: a marker that cannot be read, or whose files are gone, counts as done without a word, or is sealed.
def test_a_marker_that_is_no_marker_is_said(work):
    (work.path / "done/000001.json").write_text('{"shard": 1}')
    for ended in (work.render(), work.run("verify"), work.run("seal")):
        assert ended.code == 1
        assert "done/000001.json cannot be read" in ended.out + ended.err
    (work.path / "done/000001.json").unlink()
    assert work.render().code == 0
    for part, command in [("shards", "seal"), ("rows", "seal"), ("rows", "render")]:
        name = work.names(part)[-1]
        path = work.path / part / name
        stored = path.read_bytes()
        path.unlink()
        ended = work.render() if command == "render" else work.run(command)
        assert ended.code == 1
        assert f"{part}/{name} is gone" in ended.err
        path.write_bytes(stored)
    assert work.run("seal").code == 0


# Failure: a set that is paused or cancelled is rendered, or both look the same to an engine.
def test_a_paused_set_is_tried_later_and_a_cancelled_one_is_not(work):
    (work.path / "done/000001.json").unlink()
    for state, code, message in [("paused", 5, "the set is paused"), ("cancelled", 2, "the set is cancelled")]:
        (work.path / "state.json").write_text(json.dumps({"state": state}))
        ended = work.render()
        assert ended.code == code
        assert message in ended.err
