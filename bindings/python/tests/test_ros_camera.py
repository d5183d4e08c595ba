from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fathom.messages.cameras import has_distortion, read_camera
from fathom.messages.errors import MessageError

K = [100.0, 0.0, 79.5, 0.0, 110.0, 59.5, 0.0, 0.0, 1.0]
P = [90.0, 0.0, 80.0, 5.0, 0.0, 95.0, 60.0, 0.0, 0.0, 0.0, 1.0, 0.0]


def make_info(**fields: Any) -> SimpleNamespace:
    roi = {"x_offset": 0, "y_offset": 0, "width": 0, "height": 0} | fields.pop("roi", {})
    described = {"width": 160, "height": 120, "k": K, "p": P, "d": [], "binning_x": 0, "binning_y": 0}
    return SimpleNamespace(**described | fields, roi=SimpleNamespace(**roi))


def test_the_matrix_is_k_and_for_rectified_pictures_p() -> None:
    assert read_camera(make_info(), (160, 120), "/info", rectified=False).tolist() == np.reshape(K, (3, 3)).tolist()
    rectified = read_camera(make_info(), (160, 120), "/info", rectified=True)
    assert rectified.tolist() == [[90, 0, 80], [0, 95, 60], [0, 0, 1]]


def test_region_and_binning_move_and_scale_the_matrix() -> None:
    info = make_info(binning_x=2, binning_y=4, roi={"x_offset": 20, "y_offset": 40, "width": 100, "height": 80})
    matrix = read_camera(info, (50, 20), "/info", rectified=False)
    # The ray of column x of the full picture passes column (x - 20 + 1/2) / 2 - 1/2.
    assert matrix.tolist() == [[50, 0, 29.5], [0, 27.5, 4.5], [0, 0, 1]]


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"width": 320}, "/info: describes pictures of 320×120, but they are 160×120"),
        ({"binning_x": 2}, "/info: describes pictures of 80×120, but they are 160×120"),
        ({"k": [0.0] * 9}, "/info: `k` has the focal lengths 0 and 0 px; must be above 0"),
        ({"k": [float("nan"), *K[1:]]}, "/info: `k` has the focal lengths nan and 110 px"),
    ],
)
def test_a_camera_of_other_pictures_is_refused(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(MessageError, match=message):
        read_camera(make_info(**fields), (160, 120), "/info", rectified=False)


def test_a_lens_without_coefficients_has_no_distortion() -> None:
    assert not has_distortion(make_info())
    assert not has_distortion(make_info(d=[0.0] * 5))
    assert has_distortion(make_info(d=[0.0, 0.1]))
