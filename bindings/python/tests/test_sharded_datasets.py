from __future__ import annotations

import io
import json
import multiprocessing
import pickle
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import KINDS, description

MORE_KINDS = [*KINDS, "semantics.visible", "enhanced.hscm", "enhanced.hscm.mask"]
FRAMES = 8


def _render(job: Path, out: Path | str, *options: str) -> None:
    command = [sys.executable, "-m", "fathom", "render", str(job), "--out", str(out), "--slots", "1", *options]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Render a job into a plain folder and into a sharded dataset of three shards."""
    place = tmp_path_factory.mktemp("sharded dataset")
    job = place / "job.json"
    job.write_text(json.dumps(description(artifacts=MORE_KINDS, enhance=["hscm"], labels={"run": "first"})))
    _render(job, place / "plain")
    _render(job, place / "set", "--shard", "0/1", "--frames-per-shard", "3")
    return place / "plain", place / "set"


@pytest.fixture
def sharded(folders: tuple[Path, Path], tmp_path: Path) -> Path:
    """Copy the sharded dataset for a test that changes it."""
    return Path(shutil.copytree(folders[1], tmp_path / "set"))


def _check_same(frames: fathom.Frames, plain: fathom.Frames, numbers: list[int]) -> None:
    assert [frames.read(i).index for i in range(len(frames))] == numbers
    for position, number in enumerate(numbers):
        read, expected = frames.read(position), plain.read(number)
        assert list(read.artifacts) == list(expected.artifacts) == MORE_KINDS
        for kind in MORE_KINDS:
            one, other = read[kind], expected[kind]
            if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
                assert one.dtype == other.dtype
                assert np.array_equal(one, other, equal_nan=one.dtype.kind == "f"), kind
            else:
                assert one == other
        for part in ("frame", "parameters", "artifacts"):
            assert read.record[part] == expected.record[part]


def test_a_sharded_dataset_has_the_pixels_of_a_folder(folders: tuple[Path, Path]) -> None:
    plain = fathom.open(folders[0])
    for place in (folders[1], str(folders[1]), folders[1].as_uri()):
        frames = fathom.open(place)
        assert len(frames) == FRAMES
        _check_same(frames, plain, list(range(FRAMES)))
    assert "%20" in folders[1].as_uri()
    assert repr(frames.source) == f"<sharded dataset {folders[1]}: 8 frames, 3 of 3 shards>"
    assert [list(frame) for frame in fathom.Frames(frames.source, ["rgb"])[2:7:2]] == [["rgb"]] * 3
    assert frames.read(-1).index == 7
    with pytest.raises(IndexError):
        frames[8]
    with pytest.raises(fathom.RenderError, match="frame 4: there is no artifact `clean`"):
        frames.read(4, ["clean"])


def test_a_plain_folder_url_opens_too(folders: tuple[Path, Path]) -> None:
    assert len(fathom.open(folders[0].as_uri())) == FRAMES


def test_the_complete_shards_of_a_dataset_open(folders: tuple[Path, Path], sharded: Path) -> None:
    (sharded / "done" / "000001.json").unlink()
    frames = fathom.open(sharded)
    assert repr(frames.source).endswith("5 frames, 2 of 3 shards>")
    _check_same(frames, fathom.open(folders[0]), [0, 1, 2, 6, 7])
    _render(folders[0].parent / "job.json", sharded, "--shard", "0/1", "--frames-per-shard", "3")
    assert len(frames) == 5
    _check_same(fathom.open(sharded), fathom.open(folders[0]), list(range(FRAMES)))
    shutil.rmtree(sharded / "done")
    assert len(fathom.open(sharded)) == 0
    assert list(fathom.open(sharded)) == []


def test_frames_without_an_image_are_left_out(folders: tuple[Path, Path], sharded: Path) -> None:
    (marker,) = [path for path in (sharded / "done").iterdir() if path.name == "000001.json"]
    fields = json.loads(marker.read_text())
    tar = sharded / "shards" / f"000001-{fields['attempt']}.tar"
    with tarfile.open(tar) as file:
        members = [member for member in file if not member.name.startswith("000000000004")]
        contents = [file.extractfile(member) for member in members]
        kept = [content.read() for content in contents if content is not None]
    with tarfile.open(tar, "w", format=tarfile.USTAR_FORMAT) as file:
        for member, content in zip(members, kept, strict=True):
            file.addfile(member, io.BytesIO(content))
    with pytest.raises(fathom.RenderError, match="has 2 images, its marker 3"):
        fathom.open(sharded).read(3)
    marker.write_text(json.dumps(fields | {"images": 2, "failed": [4]}))
    _check_same(fathom.open(sharded), fathom.open(folders[0]), [0, 1, 2, 3, 5, 6, 7])


def _read(frames: fathom.Frames, index: int) -> tuple[int, bytes]:
    frame = frames.read(index)
    return frame.index, frame.rgb.tobytes()


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_worker_processes_read_the_same_frames(folders: tuple[Path, Path], method: str) -> None:
    frames = fathom.open(folders[1])
    expected = [_read(frames, i) for i in range(FRAMES)]
    assert len(pickle.dumps(frames)) < 4000
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.starmap(_read, [(frames, i) for i in range(FRAMES)], chunksize=1) == expected


def test_tars_are_indexed_when_they_are_needed(sharded: Path) -> None:
    frames = fathom.open(sharded)
    for tar in (sharded / "shards").glob("000002-*.tar"):
        tar.unlink()
    assert frames.read(5).index == 5
    with pytest.raises(fathom.RenderError, match=r"000002-.*is gone"):
        frames.read(6)


@pytest.mark.parametrize("length", [0, 512, 700, 5000])
def test_a_damaged_tar_is_an_error(sharded: Path, length: int) -> None:
    (tar,) = (sharded / "shards").glob("000000-*.tar")
    tar.write_bytes(tar.read_bytes()[:length])
    with pytest.raises(fathom.RenderError, match=f"{tar.name} "):
        fathom.open(sharded).read(2)
    tar.write_bytes(b"\x01" * 4096)
    with pytest.raises(fathom.RenderError, match="damaged at byte 0"):
        fathom.open(sharded).read(2)


@pytest.mark.parametrize(
    ("file", "text", "message"),
    [
        ("job.json", '{"format": 2}', "has the format 2; this version of fathom reads 1"),
        ("done/000001.json", "{", r"done/000001\.json cannot be read; delete it"),
        ("done/000001.json", '{"shard": 1, "attempt": "../../a", "images": 3}', r"the attempt `\.\./\.\./a`"),
    ],
)
def test_unreadable_descriptions_are_errors(sharded: Path, file: str, text: str, message: str) -> None:
    (sharded / file).write_text(text)
    with pytest.raises(fathom.FathomError, match=message):
        fathom.open(sharded)


def test_a_sharded_dataset_opens_at_a_url(folders: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    fsspec = pytest.importorskip("fsspec")
    files: Any = fsspec.filesystem("memory")
    with pytest.raises(FileNotFoundError, match=r"memory://bucket/sharded holds neither"):
        fathom.open("memory://bucket/sharded")
    files.put(str(folders[1]) + "/", "/bucket/sharded/", recursive=True)
    frames = fathom.open("memory://bucket/sharded/")
    _check_same(frames, fathom.open(folders[0]), list(range(FRAMES)))
    files.rm("/bucket/sharded/done/000000.json")
    monkeypatch.setattr("fathom.places.Remote.read_ahead", 512)
    _check_same(fathom.open("memory://bucket/sharded"), fathom.open(folders[0]), list(range(3, FRAMES)))
