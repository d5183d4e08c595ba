from __future__ import annotations

import pickle
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import fathom
import numpy as np
import pytest
from conftest import description
from fathom import _native
from fathom.client import AsyncSubmitted, Dataset, Rows, Submitted

STATE = {
    "id": "job_" + "0" * 32,
    "dataset": "<b>&tour",
    "state": "running",
    "frames": 9,
    "done": 3,
    "failed": 1,
    "created_at": "2026-01-01T00:00:00Z",
    "digest": None,
}
NOWHERE = "http://user:secret@127.0.0.1:9"


class Tags(HTMLParser):
    """The names of all tags; closed in order."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.names: set[str] = set()
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.add(tag)
        if tag != "img":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_only_public_names_are_listed() -> None:
    from fathom import client

    assert dir(fathom) == sorted(fathom.__all__)
    assert dir(client) == sorted(client.__all__)
    for name in dir(fathom):
        assert getattr(fathom, name) is not None


def _shown() -> dict[str, tuple[Any, str]]:
    client = fathom.Client(NOWHERE, token="hidden")
    dataset = Dataset(NOWHERE, "hidden", [{"job": "job_1", "frame": 0}], name="<b>")
    return {
        "client": (client, "<fathom.Client http://user:***@127.0.0.1:9>"),
        "async client": (fathom.AsyncClient(NOWHERE), "<fathom.AsyncClient http://user:***@127.0.0.1:9>"),
        "dataset": (dataset, "<fathom.Dataset <b>: 1 images of http://user:***@127.0.0.1:9>"),
        "frames": (
            fathom.Frames(dataset, ["rgb", "range"]),
            "<fathom.Frames: 1 frames with rgb, range of <fathom.Dataset <b>: 1 images of http://user:***@127.0.0.1:9>>",
        ),
        "submitted": (
            Submitted(client, STATE),
            f"<fathom.Submitted {STATE['id']}: <b>&tour, running, 3 of 9 frames, 1 failed>",
        ),
        "async submitted": (
            AsyncSubmitted(fathom.AsyncClient(NOWHERE), STATE),
            f"<fathom.AsyncSubmitted {STATE['id']}: <b>&tour, running, 3 of 9 frames, 1 failed>",
        ),
    }


def _image_rows(count: int) -> Rows:
    """Make rows with the usual columns and sixty others."""
    others = {f"column_{number}": number / 7 for number in range(60)}
    usual = {"dataset": "<b>tour", "water.optics": "jerlov-1C", "water.style": None, "uiqm": 0.123456789}
    return Rows(others | usual | {"job": "job_1", "frame": frame} for frame in range(count))


def test_rows_are_shown_as_a_short_table() -> None:
    rows = _image_rows(12)
    assert repr(rows) == (
        "<fathom.Rows: 12 rows with job, dataset, frame, water.optics, water.style, uiqm and 60 more>"
    )
    html = rows._repr_html_()
    assert Tags(html).names == {"div", "table", "caption", "tr", "th", "td"}
    assert "12 rows; 5 of 66 columns" in html
    assert "&lt;b&gt;tour" in html
    assert "0.1235" in html
    assert "column_3" not in html
    assert len(html) < 4000


def test_only_the_first_of_many_rows_are_shown() -> None:
    rows = _image_rows(1000)
    assert rows._repr_html_().count("<tr>") == 21
    assert "1000 rows, the first 20 shown" in rows._repr_html_()
    assert len(repr(rows)) < 100
    assert repr(rows[:1]).startswith("<fathom.Rows: 1 row with job")
    assert rows[3]["frame"] == 3
    assert [row["frame"] for row in pickle.loads(pickle.dumps(rows[-2:]))] == [998, 999]


def test_rows_of_other_lists_show_all_their_columns() -> None:
    rows = Rows([{"name": "tour", "images": 24, "bytes": 18_706_982, "jobs": 1}])
    assert repr(rows) == "<fathom.Rows: 1 row with name, images, bytes, jobs>"
    assert "<caption>1 row</caption>" in rows._repr_html_()
    assert "18706982" in rows._repr_html_()
    assert repr(Rows()) == "<fathom.Rows: 0 rows>"
    assert Tags(Rows()._repr_html_()).names == {"div", "table", "caption", "tr"}


@pytest.mark.parametrize("name", list(_shown()))
def test_parts_of_a_client_are_shown_without_network_and_secrets(name: str) -> None:
    shown, text = _shown()[name]
    assert repr(shown) == text
    html = shown._repr_html_()
    assert Tags(html).names == {"div", "table", "caption", "tr", "th", "td"}
    assert len(html) < 3000
    assert not re.search("secret|hidden", repr(shown) + html)


def test_a_job_is_shown_as_a_table() -> None:
    job = fathom.Job(description(labels={"site": "<script>"}))
    assert repr(job) == f"<fathom.Job {job.digest[:12]}: 8 frames of python>"
    html = job._repr_html_()
    assert "script" not in Tags(html).names
    for text in ("96×64", "jerlov-1C/williamson2022", "procedural structure", job.digest, "transmittance"):
        assert text in html
    assert Tags(fathom.Job({"scene": {"kind": "procedural", "family": "shaft"}})._repr_html_()).names


def test_a_frame_is_shown_as_a_picture(job: fathom.Job) -> None:
    frame = job.read(0)
    png = frame._repr_png_()
    assert png is not None
    assert (_native.decode(png) == frame.rgb).all()
    html = frame._repr_html_()
    assert Tags(html).names == {"div", "img", "table", "caption", "tr", "th", "td"}
    assert "uint16 64×96" in html
    bare = job.read(0, ["range", "boxes"])
    assert bare._repr_png_() is None
    assert "img" not in Tags(bare._repr_html_()).names


@pytest.mark.parametrize("shape", [(2000, 3001, 3), (481, 2, 3), (1, 5000, 3)])
def test_a_large_picture_is_shown_small(shape: tuple[int, ...]) -> None:
    picture = np.full(shape, 70, np.uint8)
    png = fathom.Frame(0, {"rgb": picture}, "{}")._repr_png_()
    assert png is not None
    small = _native.decode(png)
    assert small.dtype == np.uint8
    assert (small == 70).all()
    assert max(small.shape) <= 480 or min(shape[:2]) < 3


def test_frames_show_their_source(job: fathom.Job, rendered: Path) -> None:
    assert repr(fathom.Frames(job)) == f"<fathom.Frames: 8 frames of {job!r}>"
    stored = fathom.open(rendered)
    assert str(rendered) in repr(stored)
    assert str(rendered) in stored._repr_html_()


@pytest.mark.parametrize(
    ("kinds", "message"),
    [
        (["rgbb"], "artifact kind `rgbb` does not exist \\(did you mean `rgb`\\?\\); the kinds are rgb, rgb_right"),
        ("rgb", '`kinds` is the string "rgb"; must be a list: kinds=\\["rgb"\\]'),
        (["rgb", 3], "`kinds` contains 3"),
    ],
)
def test_wrong_kinds_fail_in_the_constructor(job: fathom.Job, kinds: Any, message: str) -> None:
    from fathom.torch import Endless

    nowhere = fathom.Client("http://127.0.0.1:9")
    calls: list[Any] = [
        lambda: fathom.Frames(job, kinds),
        lambda: Endless(job, kinds),
        lambda: fathom.render(job, 0, kinds),
        lambda: job.read(0, kinds),
    ]
    calls += [lambda: nowhere.frame("job_1", 0, kinds), lambda: next(nowhere.frames([], kinds))]
    for call in calls:
        with pytest.raises(fathom.InvalidArgument, match=message) as caught:
            call()
        assert isinstance(caught.value, ValueError)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_a_string_is_no_list_of_names(job: fathom.Job, tmp_path: Path) -> None:
    nowhere: Any = fathom.Client("http://127.0.0.1:9")
    picture = np.zeros((32, 32, 3), np.uint8)
    calls: list[Any] = [
        lambda: nowhere.images(fields="frame"),
        lambda: nowhere.stats("tour", metrics="uiqm"),
        lambda: nowhere.stats("tour", by="alpha"),
        lambda: nowhere.export("tour", tmp_path, kinds="rgb"),
        lambda: fathom.measure(picture, "uiqm"),
    ]
    for call in calls:
        with pytest.raises(fathom.InvalidArgument, match="must be a list"):
            call()
    # Stored frames may have enhancements of another version.
    assert fathom.Frames(Dataset("http://127.0.0.1:9", None, []), ["enhanced.later"]).kinds == ("enhanced.later",)
