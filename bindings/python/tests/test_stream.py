from __future__ import annotations

import json
import resource
import threading
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from fathom import _native
from numpy.typing import NDArray

HEIGHT, WIDTH = 48, 64
CAMERA = [[60.0, 0.0, 31.5], [0.0, 60.0, 23.5], [0.0, 0.0, 1.0]]
JOB: dict[str, Any] = {
    "seed": 3,
    "water": {"optics": "jerlov-3C", "style": "muddy"},
    "alpha": 0.5,
    "lights": [
        {"kind": "point", "position_m": [0.3, -0.2, 0], "intensity": [4, 4, 4]},
        {"kind": "haze", "x": 0.3, "y": 1, "size": 0.1, "intensity": 0.4},
    ],
    "camera": {"sensor": {}},
    "enhance": ["hscm"],
}


def make_picture(seed: int = 1, height: int = HEIGHT, width: int = WIDTH) -> NDArray[np.uint8]:
    return np.random.default_rng(seed).integers(0, 255, (height, width, 3), np.uint8)


def make_range(height: int = HEIGHT, width: int = WIDTH) -> NDArray[np.float32]:
    meters = np.linspace(0.8, 6, height * width, dtype=np.float32).reshape(height, width)
    meters[0, 0] = np.nan
    return meters


RGB, RANGE_M = make_picture(), make_range()


def test_a_frame_equals_that_of_a_job_over_the_same_files(tmp_path: Path) -> None:
    (tmp_path / "rgb.png").write_bytes(_native.encode_png(RGB))
    np.save(tmp_path / "range.npy", RANGE_M)
    scene = {"kind": "files", "rgb": str(tmp_path / "rgb.png"), "range": str(tmp_path / "range.npy")}
    expected = fathom.render(JOB | {"scene": scene, "artifacts": ["rgb", "range", "enhanced.hscm"]}, 0)
    out = fathom.Stream(JOB)(RGB, range_m=RANGE_M, stamp_ns=0)
    assert (out.rgb == expected.rgb).all()
    assert (out.enhanced["hscm"] == expected["enhanced.hscm"]).all()
    assert out.range_m is not None
    assert np.array_equal(out.range_m, expected.range_m, equal_nan=True)
    assert out.plan == expected.record["plan"]
    promise = expected.record["promise"]
    assert out.error_bound == promise["bound"] + promise["relative"]
    assert out.elapsed_ms > 0


@pytest.mark.filterwarnings("ignore:.*replace `scene`")
def test_the_same_stamps_give_the_same_bytes(tmp_path: Path) -> None:
    path = tmp_path / "job.json"
    path.write_text(json.dumps(JOB))
    played = [
        [stream(make_picture(stamp), range_m=RANGE_M, stamp_ns=10**18 + stamp).rgb for stamp in order]
        for stream, order in ((fathom.Stream(path), [1, 2, 3]), (fathom.Stream(JOB), [3, 2, 1]))
    ]
    for first, second in zip(played[0], reversed(played[1]), strict=True):
        assert (first == second).all()
    stream = fathom.Stream(fathom.Job(JOB | {"scene": {"kind": "procedural", "family": "structure"}}))
    assert "replace `scene`" in stream.warnings[0]
    assert (stream(RGB, range_m=RANGE_M, stamp_ns=1).rgb != stream(RGB, range_m=RANGE_M, stamp_ns=2).rgb).any()


def test_arrays_of_any_strides_and_orders_of_channels_are_read_as_they_are() -> None:
    stream = fathom.Stream({"water": {"optics": "jerlov-3C"}})
    expected = stream(RGB, range_m=RANGE_M, stamp_ns=0).rgb
    alpha = np.full((HEIGHT, WIDTH, 1), 7, np.uint8)
    doubled = np.repeat(np.repeat(RGB, 2, axis=0), 2, axis=1)
    pictures: list[tuple[NDArray[Any], Any]] = [
        (np.asfortranarray(RGB), "rgb"),
        (doubled[::2, ::2], "rgb"),
        (RGB[::-1].copy()[::-1], "rgb"),
        (np.ascontiguousarray(RGB[..., ::-1]), "bgr"),
        (RGB[..., ::-1], "bgr"),
        (np.concatenate([RGB, alpha], axis=2), "rgba"),
        (np.concatenate([RGB[..., ::-1], alpha], axis=2), "bgra"),
    ]
    for picture, channels in pictures:
        assert (stream(picture, range_m=RANGE_M, stamp_ns=0, channels=channels).rgb == expected).all(), channels
    depths = [np.asfortranarray(RANGE_M), np.repeat(RANGE_M, 2, axis=1)[:, ::2], RANGE_M[..., None]]
    for meters in depths:
        assert (stream(RGB, range_m=meters, stamp_ns=0).rgb == expected).all()
    gray = np.ascontiguousarray(RGB[..., 0])
    alike = np.repeat(gray[..., None], 3, axis=2)
    mono = stream(gray, range_m=RANGE_M, stamp_ns=0, channels="mono").rgb
    assert (mono == stream(alike, range_m=RANGE_M, stamp_ns=0).rgb).all()
    assert (make_picture() == RGB).all()


def test_linear_light_and_millimeters_are_read() -> None:
    stream = fathom.Stream({"water": {"optics": "jerlov-3C"}})
    codes = np.arange(256, dtype=np.float64) / 255
    curve = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4).astype(np.float32)
    whole = np.nan_to_num(RANGE_M * 1000).astype(np.uint16)
    meters = np.where(whole == 0, np.nan, whole * 0.001).astype(np.float32)
    assert (stream(curve[RGB], range_m=whole).rgb == stream(RGB, range_m=meters).rgb).all()
    holes = meters.copy()
    holes[0, :4] = [np.inf, 0, -1, np.nan]
    out = stream(RGB, range_m=holes)
    assert out.range_m is not None
    assert np.isnan(out.range_m[0, :4]).all()
    along_axis = stream(RGB, z_depth=meters, camera=CAMERA).range_m
    assert along_axis is not None
    rays = np.hypot(np.hypot((np.arange(WIDTH) - 31.5) / 60, ((np.arange(HEIGHT) - 23.5) / 60)[:, None]), 1)
    np.testing.assert_allclose(along_axis, meters * rays, rtol=1e-6)


def test_a_frame_without_distances_skips_the_water_alone() -> None:
    stream = fathom.Stream(JOB)
    wet = stream(RGB, range_m=RANGE_M, stamp_ns=1)
    dry = stream(RGB, stamp_ns=1)
    assert dry.range_m is None
    assert "the scene has no range: the water's optics are skipped" in dry.warnings
    lights = [light for light in JOB["lights"] if light["kind"] == "haze"]
    plain = fathom.Stream(JOB | {"water": {"style": "muddy"}, "lights": lights})(RGB, stamp_ns=1)
    assert (dry.rgb == plain.rgb).all()
    assert (dry.rgb != wet.rgb).any()
    assert (stream(RGB, range_m=RANGE_M, stamp_ns=1).rgb == wet.rgb).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"rgb": RGB[..., :2]},
            r"`rgb` has the shape \(48, 64, 2\); must be \(height, width, 3\) with `channels` \"rgb\"",
        ),
        ({"channels": "rgba"}, r"must be \(height, width, 4\)"),
        ({"channels": "mono"}, r"must be \(height, width\)"),
        ({"channels": "rgbd"}, r"`channels` is \"rgbd\"; must be one of rgb, bgr, rgba, bgra, mono"),
        ({"rgb": RGB / 255}, "`rgb` has the dtype float64; must be uint8"),
        ({"rgb": RGB.tolist()}, "`rgb` is a list; must be a NumPy array"),
        ({"rgb": RGB[:0]}, "`rgb` is 64×0; must be at least 1×1"),
        ({"range_m": RANGE_M[:9]}, "`range_m` is 64×9 but `rgb` is 64×48"),
        ({"range_m": RANGE_M.astype(np.float64)}, "`range_m` has the dtype float64; must be float32"),
        ({"range_m": None, "z_depth": RANGE_M[0]}, r"`z_depth` has the shape \(64,\)"),
        ({"z_depth": RANGE_M}, "`z_depth` and `range_m` are both given"),
        ({"camera": [[60, 0, 700], [0, 60, 23], [0, 0, 1]]}, "cx 700, outside of the picture of 64×48"),
        ({"camera": [[60, 0, 31], [0, 90, 23], [0, 0, 1]]}, "focal lengths 60 and 90 px; must agree within 1 %"),
        ({"camera": [1, 2, 3]}, r"`camera` has the shape \(3,\); must be \(3, 3\)"),
        ({"camera": [["a"]]}, "`camera` is .* must be a 3×3 matrix of numbers"),
        ({"pose": np.eye(4) * 2}, "`pose` is not a matrix from camera axes to the world"),
        ({"stamp_ns": -1}, "`stamp_ns` is -1; must be 0 to"),
        ({"stamp_ns": 0.5}, "`stamp_ns` is 0.5; must be a whole number"),
    ],
)
def test_wrong_arguments_are_clear_and_the_stream_continues(arguments: dict[str, Any], message: str) -> None:
    stream = fathom.Stream({"water": {"optics": "jerlov-3C"}})
    good: dict[str, Any] = {"rgb": RGB, "range_m": RANGE_M, "stamp_ns": 4}
    before = stream(**good)
    with pytest.raises(ValueError, match=message) as raised:
        stream(**(good | arguments))
    assert isinstance(raised.value, fathom.FathomError)
    assert (stream(**good).rgb == before.rgb).all()


def test_wrong_jobs_are_refused_when_the_stream_opens() -> None:
    with pytest.raises(fathom.InvalidJob) as refused:
        fathom.Stream({"water": {"optics": "jerlov-9"}, "artifacts": ["boxes"], "alpha": 2})
    assert [error.pointer for error in refused.value.errors] == ["/water/optics", "/alpha", "/artifacts/0"]
    with pytest.raises(fathom.InvalidArgument, match='`vary` is "call"; must be "stream" or "frame"'):
        fathom.Stream({}, vary="call")  # type: ignore[arg-type]
    with pytest.raises(fathom.InvalidArgument, match="belong to the job"):
        fathom.Stream(fathom.Job(JOB | {"scene": {"kind": "procedural", "family": "shaft"}}), styles="styles")


def test_one_call_puts_a_picture_into_water() -> None:
    lamp = {"kind": "point", "position_m": [0, 0, 0], "intensity": [2, 2, 2]}
    wet = fathom.apply(RGB, range_m=RANGE_M, water="jerlov-3C", lights=[lamp])
    stream = fathom.Stream({"water": {"optics": "jerlov-3C"}, "lights": [lamp]})
    assert (wet == stream(RGB, range_m=RANGE_M).rgb).all()
    with pytest.warns(UserWarning, match="no range: the water's optics are skipped"):
        assert np.array_equal(fathom.apply(RGB, water="jerlov-3C"), RGB)
    with pytest.warns(UserWarning, match="`enhance` does not change the picture"):
        assert np.array_equal(fathom.apply(RGB, enhance=["hscm"]), RGB)


def test_metrics_and_other_artifacts_come_on_request() -> None:
    job = {"water": {"optics": "jerlov-3C"}, "metrics": ["uciqe"], "artifacts": ["clean", "transmittance"]}
    out = fathom.Stream(job, metrics=True)(RGB, range_m=RANGE_M)
    assert list(out.record["measurements"]["rgb"]) == ["uciqe"]
    assert np.array_equal(out["clean"], RGB)
    assert "transmittance" in out
    assert fathom.Stream(job)(RGB, range_m=RANGE_M).record["measurements"] == {}
    with pytest.raises(KeyError, match="the frame has no `backscatter` but"):
        out["backscatter"]


def test_other_threads_run_while_a_frame_renders_and_may_not_use_its_stream() -> None:
    stream = fathom.Stream(JOB | {"metrics": []})
    picture, meters = make_picture(1, 480, 640), make_range(480, 640)
    stream(picture, range_m=meters)
    ended = threading.Event()
    ticks = 0
    errors: list[str] = []

    def render() -> None:
        for stamp in range(4):
            while True:
                try:
                    stream(picture, range_m=meters, stamp_ns=stamp)
                    break
                except RuntimeError:
                    time.sleep(0.001)
        ended.set()

    thread = threading.Thread(target=render)
    thread.start()
    while not ended.is_set():
        ticks += 1
        try:
            stream(RGB[:2, :2], stamp_ns=0)
        except RuntimeError as error:
            errors.append(str(error))
        time.sleep(0.001)
    thread.join()
    # Were the interpreter held, this thread would hardly run meanwhile.
    assert ticks >= 5
    assert errors
    assert all("in another thread; open one stream for each thread" in error for error in errors)


def measure_growth_kb() -> int:
    stream = fathom.Stream(JOB)
    picture, meters = make_picture(1, 180, 240), make_range(180, 240)
    for stamp in range(10):
        stream(picture, range_m=meters, stamp_ns=stamp)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for stamp in range(50):
        stream(picture, range_m=meters if stamp % 3 else None, stamp_ns=stamp)
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before


def test_memory_stays_flat() -> None:
    # In this process, memory freed by other tests would hide growth.
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        growth_kb = pool.submit(measure_growth_kb).result()
    # One frame kept by every call would add more than 20 MB.
    assert growth_kb < 5 * 1024
