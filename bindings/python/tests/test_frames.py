from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import KINDS


def test_frames_are_a_sequence_with_slices(job: fathom.Job) -> None:
    frames = fathom.Frames(job, kinds=["rgb", "semantics"])
    assert len(frames) == 8
    assert set(frames[0]) == {"rgb", "semantics"}
    assert (frames.read(-1).rgb == job.read(7, ["rgb"]).rgb).all()
    part = frames[6:1:-2]
    assert len(part) == 3
    assert [part.read(i).index for i in range(3)] == [6, 4, 2]
    assert len(list(frames[:2])) == 2
    with pytest.raises(IndexError):
        frames[8]


def test_pickled_frames_are_the_same(job: fathom.Job) -> None:
    frames = fathom.Frames(job, kinds=["rgb"])[2:4]
    copy = pickle.loads(pickle.dumps(frames))
    assert len(copy) == 2
    assert (copy.read(0).rgb == frames.read(0).rgb).all()


def _digest(frames: fathom.Frames, index: int) -> tuple[int, bytes]:
    rgb = frames[index]["rgb"]
    assert isinstance(rgb, np.ndarray)
    return os.getpid(), rgb.tobytes()


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_worker_processes_make_the_same_frames(job: fathom.Job, method: str) -> None:
    frames = fathom.Frames(job, kinds=["rgb"])
    # The parent has slots with caches, which a fork inherits.
    expected = [_digest(frames, i)[1] for i in range(8)]
    with multiprocessing.get_context(method).Pool(2) as pool:
        made = pool.starmap(_digest, [(frames, i) for i in range(8)], chunksize=1)
    assert [rgb for _, rgb in made] == expected
    assert os.getpid() not in {process for process, _ in made}


def _render_for_ever(frames: fathom.Frames) -> None:
    while True:
        for i in range(len(frames)):
            _ = frames[i]


def test_a_killed_worker_harms_nobody(job: fathom.Job) -> None:
    frames = fathom.Frames(job, kinds=["rgb"])
    expected = _digest(frames, 3)[1]
    process = multiprocessing.get_context("fork").Process(target=_render_for_ever, args=(frames,))
    process.start()
    process.join(0.3)
    assert process.pid is not None
    os.kill(process.pid, signal.SIGKILL)
    process.join(10)
    assert process.exitcode == -signal.SIGKILL
    assert _digest(frames, 3)[1] == expected


def test_rendered_folders_open_as_the_same_frames(job: fathom.Job, rendered: Path) -> None:
    stored = fathom.open(rendered)
    assert len(stored) == 8
    live, read = fathom.Frames(job)[5], stored[5]
    assert list(read) == KINDS
    for kind in ("rgb", "semantics", "instances", "normals", "transmittance"):
        assert np.array_equal(live[kind], read[kind]), kind
    assert live["boxes"] == read["boxes"]
    one, other = job.read(5, ["range"]).range_m, stored.read(5).range_m
    near = one < 65
    assert np.abs(one[near] - other[near]).max() <= 0.00051
    assert (np.isnan(one) == np.isnan(other)).all()
    assert stored.read(5).record["frame"] == 5
    with pytest.raises(fathom.RenderError, match=r"frame 1: there is no artifact `clean`; there is rgb"):
        fathom.Frames(stored, ["clean"])[1]
    assert len(pickle.loads(pickle.dumps(stored))[2:4]) == 2


def test_what_is_no_dataset_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"neither records\.jsonl nor metadata\.jsonl"):
        fathom.open(tmp_path)
    (tmp_path / "metadata.jsonl").write_text('{"file_name": "rgb/../../secret.png", "frame": 0}\n')
    with pytest.raises(fathom.RenderError, match="outside of the folder"):
        fathom.open(tmp_path)[0]


def _worker(endless: Any, worker: int, workers: int, count: int) -> list[bytes]:
    from torch.utils import data

    data.begin_worker(worker, workers)
    frames: Iterator[dict[str, np.ndarray]] = iter(endless)
    return [frame["rgb"].tobytes() for frame in islice(frames, count)]


def test_each_torch_worker_takes_its_own_frames_for_ever(job: fathom.Job) -> None:
    from fathom.torch import Endless

    endless = Endless(job, kinds=["rgb"])
    whole = fathom.Frames(job.endless(), ["rgb"])
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        made = pool.starmap(_worker, [(endless, worker, 2, 6) for worker in range(2)])
    for worker in range(2):
        # Twelve frames in all, of a job of eight.
        assert made[worker] == [_digest(whole, worker + 2 * i)[1] for i in range(6)]


def test_the_state_of_endless_data_is_one_integer(job: fathom.Job) -> None:
    from fathom.torch import Endless

    endless = Endless(job, kinds=["rgb"])
    taken = [frame["rgb"] for frame in islice(iter(endless), 3)]
    assert endless.state_dict() == {"taken": 3}
    other = Endless(job, kinds=["rgb"])
    other.load_state_dict({"taken": 2})
    assert np.array_equal(next(iter(other))["rgb"], taken[2])
