"""Sets are opened with what everybody has: WebDataset, pyarrow and DuckDB."""

import hashlib
import json
from urllib.error import HTTPError, URLError
from urllib.parse import quote
from urllib.request import urlopen

import duckdb
import pyarrow.dataset
import pyarrow.parquet
import pytest
import webdataset
from harness import Folder, call, free_port, job, wait_until

FRAMES = 25
KINDS = ["rgb", "range", "instances", "enhanced.hscm"]
WHAT = {"enhance": ["hscm"], "metrics": ["uiqm", "entropy"], "artifacts": KINDS}


@pytest.fixture(scope="module")
def work(tmp_path_factory):
    """A set of several shards, the last one shorter."""
    work = Folder(tmp_path_factory.mktemp("read"), job(FRAMES, **WHAT))
    assert work.render("--frames-per-shard", "10").code == 0
    return work


# Failure: a member is missing, out of order, or has another name than its kind.
def test_webdataset_reads_all_members_in_order(work):
    tars = [str(work.path / "shards" / name) for name in work.names("shards")]
    samples = list(webdataset.WebDataset(tars, shardshuffle=False))
    assert [sample["__key__"] for sample in samples] == [f"{frame:012}" for frame in range(FRAMES)]
    for sample in samples:
        members = {name for name in sample if not name.startswith("__")}
        assert members == {"rgb.png", "range.png", "instances.png", "enhanced.hscm.png", "json"}
        record = json.loads(sample["json"])
        assert record["frame"] == int(sample["__key__"])
        for artifact in record["artifacts"]:
            assert hashlib.sha256(sample[artifact["kind"] + ".png"]).hexdigest() == artifact["digest"]


# Failure: the place in a row does not lead to the very bytes of the artifact.
def test_the_offsets_of_the_rows_lead_to_the_artifacts(work):
    rows = pyarrow.dataset.dataset(work.path / "rows").to_table().sort_by("frame").to_pylist()
    assert [row["frame"] for row in rows] == list(range(FRAMES))
    for row in rows:
        tar = work.read(row["tar"])
        for kind in KINDS:
            start, length = row[f"artifacts.{kind}.offset"], row[f"artifacts.{kind}.bytes"]
            assert hashlib.sha256(tar[start : start + length]).hexdigest() == row[f"artifacts.{kind}"]


# Failure: a column is called otherwise than the field that the catalogue is asked by.
def test_columns_are_called_like_the_fields_of_the_catalogue(work, tmp_path):
    schema = pyarrow.parquet.read_schema(work.path / "rows" / work.names("rows")[0])
    assert schema.metadata[b"fathom.job"].decode() == json.loads(work.read("job.json"))["digest"]
    only_in_sets = {"tar", "record", *(f"artifacts.{kind}{end}" for kind in KINDS for end in ("", ".offset", ".bytes"))}
    assert only_in_sets < set(schema.names)
    port = free_port()
    service = call("serve", "--listen", f"127.0.0.1:{port}", "--data", tmp_path / "data", "--workers", 0)
    try:
        ask = f"http://127.0.0.1:{port}/v1/images?limit=1&order_by="
        wait_until(lambda: reply(ask + "frame") == 200, "the service listens")
        unknown = [name for name in schema.names if name not in only_in_sets and reply(ask + quote(name)) != 200]
    finally:
        service.terminate()
        service.communicate()
    assert not unknown
    assert len(schema.names) - len(only_in_sets) > 50, "too few to prove anything"


def reply(url):
    """The status of a response; None if there is none."""
    try:
        return urlopen(url).status
    except HTTPError as error:
        return error.code
    except URLError:
        return None


# Failure: a query over a glob counts otherwise than the job, or compares other values than the record has.
def test_duckdb_queries_a_glob(work):
    glob = str(work.path / "rows" / "*.parquet")
    query = f"""select count(*), count(distinct digest), min("uiqm"), max("hscm.uiqm"), any_value("water.optics.preset")
        from '{glob}' where "camera.width" = 40"""
    (found,) = duckdb.sql(query).fetchall()
    records = [json.loads(row) for (row,) in duckdb.sql(f"select record from '{glob}'").fetchall()]
    least = min(record["measurements"]["rgb"]["uiqm"] for record in records)
    most = max(record["measurements"]["hscm"]["uiqm"] for record in records)
    assert found == (FRAMES, FRAMES, least, most, records[0]["optics"]["preset"])
