from __future__ import annotations

import threading
from typing import Any

import pytest
from fathom.ros.counts import BUSY, FAILED, LATE, NO_CAMERA, NO_DEPTH, NO_POSE, Counts
from fathom.ros.diagnostics import ERROR, OK, STALE, WARN, Topics, describe_plan, judge, list_values
from fathom.ros.worker import NewestWorker

TOPICS = Topics("/image", "/depth", "/info")


def test_a_report_has_its_interval_and_all_totals() -> None:
    counts = Counts()
    for ms in (10.0, 30.0, 20.0):
        counts.receive()
        counts.render({"chain": ms})
    counts.drop(BUSY)
    first = counts.report(1.5)
    assert (first.received, first.rendered, first.dropped) == (3, 3, {BUSY: 1})
    assert first.times_ms == {"chain": (20.0, 30.0)}
    counts.drop(BUSY)
    second = counts.report(1.0)
    assert (second.received, second.dropped, second.totals[BUSY], second.totals["rendered"]) == (0, {BUSY: 1}, 2, 3)
    assert second.times_ms == {}


@pytest.mark.parametrize(
    ("reasons", "level", "message"),
    [
        ([], OK, "2.0 frames per second"),
        ([BUSY], WARN, "pictures dropped: 1 replaced by a newer one"),
        (
            [NO_DEPTH] * 2,
            WARN,
            "pictures dropped: 2 without depth: no depth on /depth within `slop_s`; set `use_depth`",
        ),
        ([NO_CAMERA], WARN, "no message on /info; set `use_camera_info` to false"),
        ([NO_POSE], WARN, "1 without pose: why"),
        ([BUSY, FAILED], ERROR, "1 pictures failed: why"),
    ],
)
def test_dropped_pictures_are_judged(reasons: list[str], level: int, message: str) -> None:
    counts = Counts()
    counts.receive()
    counts.render({})
    counts.render({})
    for reason in reasons:
        counts.drop(reason, "why")
    judged = judge(counts.report(1.0), TOPICS)
    assert judged[0] == level
    assert message in judged[1]


def test_late_depths_are_a_warning_of_their_interval_and_a_total() -> None:
    counts = Counts()
    counts.receive()
    counts.drop(NO_DEPTH, "why")
    counts.add_late_depth()
    first = counts.report(1.0)
    level, message = judge(first, TOPICS)
    assert level == WARN
    assert message.startswith("pictures dropped: 1 without depth: no depth on /depth")
    assert "; 1 depths on /depth came after their pictures were dropped: raise `depth_wait_s`" in message
    counts.receive()
    counts.render({})
    second = counts.report(1.0)
    assert judge(second, TOPICS) == (OK, "1.0 frames per second")
    assert dict(list_values(second, None, None, {}))[f"total {LATE}"] == "1"


def test_silence_is_stale() -> None:
    assert judge(Counts().report(1.0), TOPICS) == (STALE, "no pictures on /image")


def test_values_have_stages_plan_and_error_bound() -> None:
    record: dict[str, Any] = {
        "timings_ms": {"water": 12.34},
        "plan": [{"stage": "snow", "variant": "skip"}, {"stage": "haze", "variant": "overlay"}],
    }
    counts = Counts()
    counts.render({"chain": 5.0})
    values = dict(list_values(counts.report(0.5), record, 0.00123, {"mode": "water"}))
    assert values["stage water, ms"] == "12.3"
    assert values["plan"] == "haze overlay"
    assert values["error bound"] == "0.00123"
    assert values["frames per second"] == "2.00"
    assert (values["chain, median ms"], values["total rendered"], values["mode"]) == ("5.0", "1", "water")
    assert dict(list_values(counts.report(1.0), record, None, {}))["error bound"] == "none"
    assert "plan" not in dict(list_values(counts.report(1.0), None, None, {}))
    assert describe_plan([]) == ""


def test_the_newest_item_replaces_those_that_wait() -> None:
    entered, leave, done = threading.Event(), threading.Event(), []

    def work(item: int) -> None:
        entered.set()
        assert leave.wait(10)
        done.append(item)

    worker = NewestWorker(work)
    assert not worker.submit(1)
    assert entered.wait(10)
    assert [worker.submit(item) for item in (2, 3, 4)] == [False, True, True]
    entered.clear()
    leave.set()
    assert entered.wait(10)
    worker.stop()
    assert done == [1, 4]
