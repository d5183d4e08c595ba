from __future__ import annotations

import json
import pickle
from pathlib import Path

import fathom
import numpy as np
import pytest
from conftest import description


def test_a_job_is_a_mapping_or_a_file(tmp_path: Path) -> None:
    path = tmp_path / "job.json"
    path.write_text(json.dumps(description()))
    assert fathom.Job(path) == fathom.Job(str(path)) == fathom.Job(description())
    assert len(fathom.Job(path)) == 8


def test_numpy_values_stand_for_numbers() -> None:
    given = description(seed=np.int64(7), water={"optics": "jerlov-1C", "range_scale": {"uniform": np.array((0.2, 1))}})
    plain = description(water={"optics": "jerlov-1C", "range_scale": {"uniform": [0.2, 1.0]}})
    assert fathom.Job(given) == fathom.Job(plain)


def test_all_errors_of_a_job_come_together() -> None:
    wrong = description(
        count=0,
        seed=-1,
        alpha=1.5,
        camera={"width": 0, "height": "tall", "hfov_deg": 500},
        water={"optics": "jerlov-9Z", "range_scale": float("nan"), "depth": 3},
        metrics=["uiqmm"],
        artifacts=["depth"],
        fidelity={"tolerance": float("inf")},
    )
    with pytest.raises(fathom.InvalidJob) as caught:
        fathom.Job(wrong)
    errors = {error.pointer: error for error in caught.value.errors}
    assert set(errors) == {
        "/count",
        "/seed",
        "/alpha",
        "/camera/width",
        "/camera/height",
        "/camera/hfov_deg",
        "/water/optics",
        "/water/range_scale",
        "/water/depth",
        "/metrics/0",
        "/artifacts/0",
        "/fidelity/tolerance",
    }
    assert errors["/metrics/0"].did_you_mean == "uiqm"
    assert errors["/water/range_scale"].value == "nan"
    assert "rgb" in errors["/artifacts/0"].allowed
    assert errors["/alpha"].limit is not None
    assert caught.value.status == 422
    assert caught.value.detail == "12 errors"
    assert "/alpha" in str(caught.value)
    assert isinstance(caught.value, ValueError)


def test_exceptions_survive_the_way_between_processes() -> None:
    with pytest.raises(fathom.InvalidJob) as caught:
        fathom.Job({"scene": 3, "alpha": 2})
    copy = pickle.loads(pickle.dumps(caught.value))
    assert copy.errors == caught.value.errors
    error = pickle.loads(pickle.dumps(fathom.RenderError("no", 3)))
    assert (str(error), error.frame) == ("frame 3: no", 3)


def test_a_pickled_job_is_the_same_job(job: fathom.Job) -> None:
    copy = pickle.loads(pickle.dumps(job))
    assert copy == job
    assert copy.digest == job.digest
    assert (copy.read(3, ["rgb"]).rgb == job.read(3, ["rgb"]).rgb).all()


def test_an_index_beyond_the_job_is_refused(job: fathom.Job) -> None:
    for index in (8, -9):
        with pytest.raises(IndexError, match="8 frames"):
            job.resolve(index)
    assert job.resolve(-1) == job.resolve(7)


def test_an_endless_job_has_the_same_first_frames() -> None:
    grid = description(count=2, water={"optics": {"grid": ["jerlov-IB", "jerlov-1C", "jerlov-3C"]}})
    job = fathom.Job(grid)
    endless = job.endless()
    assert len(endless) > 99_000_000
    assert [endless.resolve(i) for i in range(6)] == [job.resolve(i) for i in range(6)]
    assert endless.resolve(99_000_000)["scene"] != endless.resolve(0)["scene"]


def test_every_name_is_listed(job: fathom.Job) -> None:
    names = fathom.names()
    assert names["categories"][:3] == ["background", "seabed", "pile"]
    assert {"rgb", "enhanced.hscm"} <= set(names["artifacts"])
    assert "jerlov-1C/williamson2022" in names["waters"]
    assert set(names) == {
        "artifacts",
        "categories",
        "enhancements",
        "families",
        "findings",
        "metrics",
        "sites",
        "styles",
        "waters",
    }


def test_a_plan_names_every_stage(job: fathom.Job) -> None:
    planned = fathom.plan(job, 3)
    stages = {line["stage"]: line for line in planned["plan"]}
    assert {"forward_scatter.r", "style"} <= set(stages)
    assert stages["forward_scatter.r"]["cost_ms"] > 0


def test_a_plan_promises_what_its_record_promises(job: fathom.Job) -> None:
    promise = fathom.plan(job, 3)["promise"]
    assert 0 < promise["bound"] <= promise["tolerance"]
    assert fathom.render(job, 3, metrics=False).record["promise"] == promise
