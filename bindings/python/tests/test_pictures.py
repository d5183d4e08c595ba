from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]
PICTURE = np.random.default_rng(1).integers(0, 255, (48, 64, 3), np.uint8)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("method", [*fathom._native.names()["enhancements"], "ibla:refine=guided"])
def test_every_method_keeps_size_and_type(method: str) -> None:
    result = fathom.enhance(PICTURE, method)
    assert (result.shape, result.dtype) == (PICTURE.shape, np.dtype(np.uint8))
    # An array that is not contiguous is read as it is.
    assert (fathom.enhance(np.asfortranarray(PICTURE), method) == result).all()


def test_parameters_are_written_as_in_a_job_or_in_short() -> None:
    short = fathom.enhance(PICTURE, "hscm:cutoff=16,mask=paper")
    long = fathom.enhance(PICTURE, {"method": "hscm", "cutoff": 16, "mask": "paper"})
    assert (short == long).all()
    assert (short[0, 0] == 0).all()
    assert (fathom.enhance(PICTURE, "hscm")[0, 0] != 0).any()
    chain = {"name": "mine", "steps": [{"gray_world": {}}, {"clahe": {"clip": 3}}]}
    steps = fathom.enhance(fathom.enhance(PICTURE, "gray_world"), "clahe:clip=3")
    assert (fathom.enhance(PICTURE, chain) == steps).all()


def test_every_wrong_parameter_is_named() -> None:
    with pytest.raises(fathom.InvalidJob) as refused:
        fathom.enhance(PICTURE, "hscm:cutoff=0,cut=1")
    assert [error.pointer for error in refused.value.errors] == ["/cut", "/cutoff"]


def test_gray_and_sixteen_bit_pictures_are_taken() -> None:
    gray = PICTURE[..., 0].astype(np.uint16) * 257
    assert fathom.enhance(gray, "clahe").shape == (48, 64)


def test_a_method_warns_where_it_is_known_to_fail() -> None:
    with pytest.warns(UserWarning, match="clahe: constant"):
        fathom.enhance(np.full((64, 64, 3), 40, np.uint8), "clahe")


def test_metrics_have_the_names_that_were_asked_for() -> None:
    values = fathom.measure(PICTURE, ["uiqm@table1", "psnr"], clean=PICTURE // 2)
    assert list(values) == ["uiqm@table1", "psnr"]
    assert set(fathom.measure(PICTURE)) == {"entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"}


@pytest.mark.parametrize(
    ("image", "error", "message"),
    [
        (PICTURE / 255.0, TypeError, "dtype float64 but uint8 or uint16"),
        (np.full((4, 4, 3), np.nan, np.float32), TypeError, "dtype float32"),
        (PICTURE[None], ValueError, r"shape \[1, 48, 64, 3\] but"),
        (np.zeros((4, 4, 4), np.uint8), ValueError, r"shape \[4, 4, 4\]"),
        (np.zeros((0, 4, 3), np.uint8), ValueError, "at least 1×1"),
        (PICTURE.tolist(), TypeError, "a list but a NumPy array"),
    ],
)
def test_what_is_no_picture_is_refused(image: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        fathom.enhance(image, "clahe")
    with pytest.raises(error, match=message):
        fathom.measure(image)


def test_unknown_names_are_refused_with_those_that_there_are() -> None:
    with pytest.raises(ValueError, match=r"clache. is not a known enhancement method"):
        fathom.enhance(PICTURE, "clache")
    with pytest.raises(ValueError, match="metric `psrn` does not exist"):
        fathom.measure(PICTURE, ["psrn"])
    with pytest.raises(ValueError, match="psnr"):
        fathom.measure(PICTURE, ["psnr"])
    with pytest.raises(ValueError, match="the clean one is 64×20"):
        fathom.measure(PICTURE, ["psnr"], clean=PICTURE[:20])


@pytest.fixture
def networks(tmp_path: Path) -> Path:
    """Make a folder with the network of `muddy` as an enhancer."""
    network = (ROOT / "models/muddy.onnx").read_bytes()
    card = {"name": "mud", "role": "enhancer", "sha256": hashlib.sha256(network).hexdigest()}
    (tmp_path / "mud.onnx").write_bytes(network)
    (tmp_path / "mud.card.json").write_text(json.dumps(card))
    return tmp_path


def test_a_network_of_a_folder_enhances_a_picture(networks: Path) -> None:
    runtime = ROOT / ".onnxruntime/libonnxruntime.so"
    method = {"method": "onnx", "model": "mud", "mask": "paper"}
    first, again = (fathom.enhance(PICTURE, method, styles=networks, onnxruntime=runtime) for _ in range(2))
    assert (first.shape, first.dtype) == (PICTURE.shape, np.dtype(np.uint8))
    assert (first == again).all()
    assert (first[0, 0] == 0).all()
    assert (first[20, 30] != PICTURE[20, 30]).any()


def test_a_network_that_cannot_run_is_refused_with_the_reason(networks: Path) -> None:
    with pytest.raises(fathom.InvalidJob) as refused:
        fathom.enhance(PICTURE, {"method": "onnx", "model": "mut"}, styles=networks)
    assert [(error.pointer, error.allowed) for error in refused.value.errors] == [("/model", ("mud",))]
    with pytest.raises(ValueError, match=r"metric `net.mud` does not exist"):
        fathom.measure(PICTURE, ["net.mud"], styles=networks)
    with pytest.raises(ValueError, match="get-onnxruntime"):
        fathom.enhance(PICTURE, "onnx:model=mud", styles=networks, onnxruntime="/nowhere/libonnxruntime.so")


@pytest.mark.parametrize("with_range", [False, True])
def test_a_style_is_trained_from_an_array_and_used_at_once(tmp_path: Path, job: fathom.Job, with_range: bool) -> None:
    photo = fathom.render(job.description | {"camera": {"width": 200, "height": 160}}, 0, ["rgb"]).rgb
    style = fathom.train(photo, "bay", steps=1, range=with_range, progress=False)
    assert (style.card["name"], style.card["licence"]) == ("bay", "unknown")
    assert style.sheet.ndim == 3
    description = job.description
    description["water"] |= {"style": "bay"}
    styled = fathom.Job(description, styles=style.save(tmp_path / "styles"))
    assert (styled.read(0, ["rgb"]).rgb != job.read(0, ["rgb"]).rgb).any()


def test_a_photo_without_anything_to_learn_is_refused() -> None:
    with pytest.raises(fathom.CommandError, match="photo-0"):
        fathom.train(np.full((200, 200, 3), 7, np.uint8), "flat", steps=1, progress=False)
