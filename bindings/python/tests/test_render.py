from __future__ import annotations

import json
import threading
import time
from pathlib import Path

import fathom
import numpy as np
import pytest
from conftest import KINDS, description
from fathom import _native


def test_a_frame_has_the_bytes_that_the_binary_stores(job: fathom.Job, rendered: Path) -> None:
    for index in (0, 5):
        frame = fathom.render(job, index)
        folder = rendered / str(index)
        # The files also name their kind in text, which arrays have not.
        assert (_native.decode((folder / "rgb.png").read_bytes()) == frame.rgb).all()
        assert (_native.decode((folder / "semantics.png").read_bytes()) == frame.semantics).all()
        assert (_native.decode((folder / "instances.png").read_bytes()) == frame.instances).all()
        assert (np.load(folder / "normals.npy") == frame.normals).all()
        assert (np.load(folder / "transmittance.npy") == frame.transmittance).all()
        assert json.loads((folder / "boxes.json").read_text())["instances"] == frame.boxes
        codes = _native.decode((folder / "range.png").read_bytes())
        meters = np.nan_to_num(frame.range_m.astype(np.float64))
        assert (np.minimum(np.round(meters * 1000), 65535) == codes).all()


def test_the_record_is_that_of_the_binary(job: fathom.Job, rendered: Path) -> None:
    ours = fathom.render(job, 4).record
    theirs = json.loads((rendered / "records.jsonl").read_text().splitlines()[4])
    for record in (ours, theirs):
        del record["timings_ms"], record["artifacts"]
    assert ours == theirs


def test_arrays_have_their_shapes_and_types_and_can_be_written(job: fathom.Job) -> None:
    frame = fathom.render(job, 1)
    expected = {
        "rgb": ((64, 96, 3), np.uint8),
        "range": ((64, 96), np.float32),
        "semantics": ((64, 96), np.uint8),
        "instances": ((64, 96), np.uint16),
        "normals": ((64, 96, 3), np.float32),
        "transmittance": ((64, 96, 3), np.float32),
    }
    for kind, (shape, dtype) in expected.items():
        array = frame[kind]
        assert isinstance(array, np.ndarray)
        assert (array.shape, array.dtype) == (shape, np.dtype(dtype))
        assert array.flags.c_contiguous
        assert array.flags["W"]
    assert frame.boxes[0]["number"] == 1
    assert set(frame.artifacts) == set(KINDS)


def test_motion_and_a_stereo_pair_are_arrays() -> None:
    camera = {"width": 96, "height": 64, "path": {"frames": 8}, "stereo": {"baseline_m": 0.2}}
    kinds = ["rgb", "range", "flow", "rgb_right", "disparity"]
    frame = fathom.render(fathom.Job(description(camera=camera, artifacts=kinds)), 1)
    assert frame.rgb_right.shape == frame.rgb.shape
    assert (frame.rgb_right != frame.rgb).any()
    for motion in (frame.flow, frame.disparity):
        assert (motion.shape, motion.dtype) == ((64, 96, 3), np.dtype(np.float32))
        assert (np.isnan(motion[..., 0]) == np.isnan(frame.range_m)).all()
        assert set(np.unique(motion[..., 2])) <= {0, 1}
    assert (frame.disparity[..., 0] >= 0).sum() == np.isfinite(frame.range_m).sum()


def test_only_what_is_asked_for_is_made(job: fathom.Job) -> None:
    frame = fathom.render(job, 2, ["rgb", "enhanced.clahe", "enhanced.hscm.mask"], metrics=False)
    assert list(frame.artifacts) == ["rgb", "enhanced.clahe", "enhanced.hscm.mask"]
    assert frame.record["measurements"] == {}
    assert fathom.render(job, 2, ["rgb"]).record["measurements"] != {}
    with pytest.raises(fathom.RenderError, match=r"there is no artifact `enhanced\.hscn`"):
        fathom.render(job, 2, ["enhanced.hscn"])
    with pytest.raises(KeyError, match="frame 2 has no `range`"):
        _ = frame.range_m


def test_what_cannot_be_made_is_refused(job: fathom.Job, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="artifact kind `depth` does not exist"):
        fathom.render(job, 0, ["depth"])
    with pytest.raises(fathom.RenderError, match=r"frame 0: scene `scn_0+` was uploaded to a service"):
        fathom.render(description(camera={}, scene={"kind": "uploaded", "id": "scn_" + "0" * 64}), 0)
    picture = tmp_path / "dry.png"
    picture.write_bytes(_native.encode_png(np.full((8, 8, 3), 9, np.uint8)))
    dry = description(camera={}, scene={"kind": "files", "rgb": str(picture)}, artifacts=["rgb", "range"])
    with pytest.raises(fathom.InvalidJob, match=r'the artifact "range" needs a range'):
        fathom.Job(dry)
    dry["artifacts"] = ["rgb"]
    with pytest.warns(UserWarning, match=r"`water\.optics` .* needs a range, .* rendered without it"):
        fathom.Job(dry)
    del dry["water"]
    with pytest.raises(fathom.RenderError, match="no artifact `range`: the scene has no range"):
        fathom.render(dry, 0, ["rgb", "range"])


def test_other_threads_go_on_while_a_frame_renders() -> None:
    job = fathom.Job(description(camera={"width": 768, "height": 492}))
    job.read(0, ["rgb"])
    ended = threading.Event()
    ticks = 0

    def render() -> None:
        job.read(1, KINDS)
        ended.set()

    thread = threading.Thread(target=render)
    begun = time.perf_counter()
    thread.start()
    while not ended.is_set():
        ticks += 1
        time.sleep(0.001)
    thread.join()
    # Were the interpreter held, this thread would hardly run between begin and end.
    assert ticks >= 5, f"{ticks} ticks in {time.perf_counter() - begun:.3f} s"


def test_threads_render_the_same_frames(job: fathom.Job) -> None:
    alone = [job.read(i, ["rgb"]).rgb for i in range(8)]
    together: dict[int, np.ndarray] = {}

    def render(first: int) -> None:
        for i in range(first, 8, 2):
            together[i] = job.read(i, ["rgb"]).rgb

    threads = [threading.Thread(target=render, args=(first,)) for first in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all((together[i] == alone[i]).all() for i in range(8))
