"""The state of the node as a diagnostic: a level, a sentence, and values by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fathom.ros.counts import FAILED, NO_CAMERA, NO_DEPTH, NO_POSE, Report

OK, WARN, ERROR, STALE = range(4)
"""Levels of `diagnostic_msgs/DiagnosticStatus`."""


@dataclass(frozen=True)
class Topics:
    """Full names of the subscribed topics."""

    image: str
    depth: str
    camera_info: str


def judge(report: Report, topics: Topics) -> tuple[int, str]:
    """Return level and message of an interval."""
    if FAILED in report.dropped:
        return ERROR, f"{report.dropped[FAILED]} pictures failed: {report.problem}"
    if not report.received and not report.rendered:
        return STALE, f"no pictures on {topics.image}"
    missing = {
        NO_DEPTH: f"no depth on {topics.depth} within `slop_s`; set `use_depth` to false to render without distances",
        NO_CAMERA: f"no message on {topics.camera_info}; set `use_camera_info` to false to use camera.hfov_deg",
        NO_POSE: report.problem,
    }
    problems = []
    if report.dropped:
        listed = ", ".join(f"{count} {reason}" for reason, count in report.dropped.items())
        remedy = next((f": {missing[reason]}" for reason in missing if reason in report.dropped), "")
        problems.append(f"pictures dropped: {listed}{remedy}")
    if report.late:
        came = f"{report.late} depths on {topics.depth} came after their pictures were dropped"
        problems.append(f"{came}: raise `depth_wait_s`, and publish depths in the order of their stamps")
    if problems:
        return WARN, "; ".join(problems)
    return OK, f"{report.rendered / report.seconds:.1f} frames per second"


def list_values(
    report: Report, record: Mapping[str, Any] | None, error_bound: float | None, more: Mapping[str, Any]
) -> list[tuple[str, str]]:
    """Return the values of an interval and of its last frame, whose record has plan and stages."""
    values = [("frames per second", f"{report.rendered / report.seconds:.2f}")]
    values += [(f"total {name}", str(count)) for name, count in report.totals.items()]
    for part, (median, largest) in report.times_ms.items():
        values += [(f"{part}, median ms", f"{median:.1f}"), (f"{part}, largest ms", f"{largest:.1f}")]
    if record is not None:
        values += [(f"stage {stage}, ms", f"{spent:.1f}") for stage, spent in record.get("timings_ms", {}).items()]
        values.append(("plan", describe_plan(record.get("plan", []))))
        values.append(("error bound", "none" if error_bound is None else f"{error_bound:.3g}"))
    values += [(name, str(value)) for name, value in more.items()]
    return values


def describe_plan(plan: Sequence[Mapping[str, Any]]) -> str:
    """Return the stages of a plan that run, each with its variant."""
    return ", ".join(f"{stage['stage']} {stage['variant']}" for stage in plan if stage.get("variant") != "skip")
