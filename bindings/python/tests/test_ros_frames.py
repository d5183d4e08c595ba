from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import fathom
import numpy as np
import pytest
from fathom.messages.errors import MessageError
from fathom.messages.pairing import Pair
from fathom.ros.diagnostics import Topics
from fathom.ros.frames import FrameRenderer, NoCamera
from fathom.ros.settings import read_settings
from fathom.ros.transforms import NoPose, Transforms

TOPICS = Topics("/image", "/depth", "/info")
JOB = {"water": {"optics": "jerlov-3C"}}
RGB = np.random.default_rng(1).integers(0, 255, (48, 64, 3), np.uint8)
METERS = np.linspace(0.5, 5, 48 * 64, dtype=np.float32).reshape(48, 64)
K = [60.0, 0.0, 31.5, 0.0, 60.0, 23.5, 0.0, 0.0, 1.0]


def make_image(pixels: Any, encoding: str) -> Any:
    return SimpleNamespace(
        header=SimpleNamespace(frame_id="camera"),
        height=pixels.shape[0],
        width=pixels.shape[1],
        encoding=encoding,
        is_bigendian=0,
        step=pixels.strides[0],
        data=pixels.tobytes(),
    )


def make_info(**fields: Any) -> Any:
    roi = SimpleNamespace(x_offset=0, y_offset=0, width=0, height=0)
    return SimpleNamespace(
        **{"width": 64, "height": 48, "k": K, "d": [], "binning_x": 0, "binning_y": 0, "roi": roi} | fields
    )


PAIR = Pair(7, make_image(RGB, "rgb8"), make_image(METERS, "32FC1"), 0)


def make_renderer(**settings: Any) -> FrameRenderer:
    return FrameRenderer(read_settings(settings), fathom.Stream(JOB), TOPICS, Transforms())


def test_a_pair_renders_as_its_arrays_do() -> None:
    renderer = make_renderer()
    renderer.camera_info = make_info()
    rendered = renderer.render(PAIR)
    expected = fathom.Stream(JOB)(RGB, z_depth=METERS, camera=K, stamp_ns=7)
    assert (rendered.frame.rgb == expected.rgb).all()
    assert rendered.header is PAIR.image.header
    assert set(rendered.times_ms) == {"conversion", "conversion CPU", "pose", "chain", "chain CPU"}
    bgr = Pair(7, make_image(np.ascontiguousarray(RGB[:, :, ::-1]), "bgr8"), PAIR.depth, 0)
    assert (renderer.render(bgr).frame.rgb == expected.rgb).all()


def test_other_settings_and_streams_apply_to_the_next_frame() -> None:
    renderer = make_renderer(use_camera_info=False)
    before = renderer.render(PAIR).frame.rgb
    renderer.replace(read_settings({"use_camera_info": False}), fathom.Stream({"water": {"optics": "jerlov-9C"}}))
    assert (renderer.render(PAIR).frame.rgb != before).any()


def test_a_picture_without_depth_has_no_distances() -> None:
    rendered = make_renderer(use_camera_info=False).render(Pair(7, PAIR.image, None, None))
    assert rendered.frame.range_m is None
    assert any("water" in warning for warning in rendered.frame.warnings)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 0, -1])
def test_a_depth_without_any_distance_is_a_warning(value: float) -> None:
    renderer = make_renderer(use_camera_info=False)
    empty = renderer.render(Pair(7, PAIR.image, make_image(np.full_like(METERS, value), "32FC1"), 0))
    assert "/depth: no pixel has a distance above 0; all are rendered as open water" in empty.warnings
    assert empty.frame.range_m is not None
    assert np.isnan(empty.frame.range_m).all()
    # One pixel is enough, and it need not be among those that are looked at first.
    one = np.full_like(METERS, value)
    one[5, 3] = 2
    warnings = renderer.render(Pair(7, PAIR.image, make_image(one, "32FC1"), 0)).warnings
    assert not any("no pixel" in warning for warning in warnings)


def test_missing_and_contradictory_messages_are_errors() -> None:
    renderer = make_renderer()
    with pytest.raises(NoCamera, match="no camera_info was received"):
        renderer.render(PAIR)
    renderer.camera_info = make_info(width=640)
    with pytest.raises(MessageError, match="/info: describes pictures of 640×48"):
        renderer.render(PAIR)
    with pytest.raises(NoPose, match="no transform from `camera` towards `map`"):
        make_renderer(use_camera_info=False, world_frame="map").render(PAIR)
    short = Pair(7, PAIR.image, make_image(METERS[:-1], "32FC1"), 0)
    with pytest.raises(fathom.InvalidArgument, match="`z_depth` is 64×47 but `rgb` is 64×48"):
        make_renderer(use_camera_info=False).render(short)


@pytest.mark.filterwarnings("ignore:.*small_tiles")
def test_enhancement_needs_neither_depth_nor_camera() -> None:
    renderer = FrameRenderer(
        read_settings({"mode": "enhance"}), fathom.Stream({"enhance": ["hscm"]}), TOPICS, Transforms()
    )
    rendered = renderer.render(Pair(7, PAIR.image, None, None))
    assert rendered.camera_info is None
    assert (rendered.frame.enhanced["hscm"] == fathom.enhance(RGB, "hscm")).all()
    renderer.camera_info = make_info(width=640)
    assert renderer.render(Pair(8, PAIR.image, None, None)).camera_info is renderer.camera_info
