"""The OpenAPI document of a service: valid, as strict as the parser, and enough for a stock client generator."""

from __future__ import annotations

import copy
import importlib
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fathom
import httpx
import pytest
from conftest import description

jsonschema = pytest.importorskip("jsonschema")

ROOT = Path(__file__).parents[3]
# Errors that no schema can express: fields that must fit together, names of users, missing numbers of a water,
# a missing scene without a site.
BEYOND_A_SCHEMA = {
    "black",
    "empty",
    "g-above-c",
    "haze-spaces",
    "inconsistent",
    "lamp-no-scatter",
    "missing-c",
    "missing-veil",
    "no-scene",
    "path-frame",
    "preset",
    "range-twice",
    "sky-and-veil",
    "snow-cover",
    "snow-mask",
    "snow-order",
    "too-many-frames",
    "too-many-pixels",
    "uploaded",
    "unrenderable",
}


@pytest.fixture(scope="module")
def document(server: str) -> Any:
    return httpx.get(f"{server}/openapi.json").json()


@pytest.fixture(scope="module")
def schema(document: Any) -> Any:
    """Make a validator of job descriptions."""
    root = {"$ref": "#/components/schemas/JobDescription", "components": document["components"]}
    return jsonschema.Draft202012Validator(root)


@pytest.fixture(scope="module")
def proof() -> Iterator[Any]:
    """Import the jobs, right and wrong, that the proof compares."""
    sys.path.insert(0, str(ROOT / "scripts" / "proof"))
    yield importlib.import_module("cases"), importlib.import_module("refusals")
    sys.path.pop(0)


def _is_accepted(job: Any) -> bool:
    try:
        fathom.Job(job)
    except fathom.InvalidJob:
        return False
    return True


def _objects(value: Any) -> Iterator[dict[str, Any]]:
    if isinstance(value, dict):
        yield value
    for inside in value.values() if isinstance(value, dict) else value if isinstance(value, list) else []:
        yield from _objects(inside)


def test_the_document_is_openapi(document: Any) -> None:
    validator = pytest.importorskip("openapi_spec_validator")
    assert document["openapi"].startswith("3.1")
    validator.validate(document)


def test_every_job_that_is_accepted_fits_the_schema(schema: Any, proof: Any) -> None:
    jobs = dict(proof[0].cases())
    jobs |= {path.name: json.loads(path.read_text()) for path in (ROOT / "examples").glob("*.json")}
    seen = 0
    for name, job in jobs.items():
        if _is_accepted(job):
            seen += 1
            errors = [f"{error.json_path}: {error.message}" for error in schema.iter_errors(job)]
            assert not errors, (name, errors)
    assert seen > 50


def test_every_job_with_a_wrong_form_is_refused_by_the_schema_too(schema: Any, proof: Any) -> None:
    wrong = proof[1].WRONG
    assert not [name for name, job in wrong.items() if _is_accepted(job)]
    assert {name for name, job in wrong.items() if schema.is_valid(job)} == BEYOND_A_SCHEMA


def test_the_schema_knows_required_and_unknown_fields_as_the_parser_does(schema: Any, document: Any) -> None:
    job = copy.deepcopy(document["components"]["schemas"]["JobDescription"]["examples"][0])
    # Along a path the scene stays what it is.
    job["scene"]["seed"] = 5
    job["lights"].append({"kind": "spot", "position_m": [0.1, 0, 0], "intensity": [{"uniform": [1, 2]}, 3, 3]})
    job["water"] |= {"snow": {"density_per_m3": 10}, "turbidity": {"contrast": 0.5}, "holes": {"range_m": 5}}
    job["camera"]["path"] = {"frames": 10, "sway_m": 0.1}
    assert _is_accepted(job)
    assert schema.is_valid(job)
    for place in _objects(job):
        for key in list(place):
            value = place.pop(key)
            assert schema.is_valid(job) or not _is_accepted(job), key
            place[key] = value
        place["unheard_of"] = 1
        assert schema.is_valid(job) == _is_accepted(job) == (place is job["labels"])
        del place["unheard_of"]


def _closed(document: Any, name: str) -> Any:
    """Make a validator of a response that refuses members which the document does not name."""
    components = copy.deepcopy(document["components"])
    inherited = {
        part["$ref"].split("/")[-1]
        for each in components["schemas"].values()
        for part in each.get("allOf", [])
        if "$ref" in part
    }
    for own, each in components["schemas"].items():
        if "properties" in each and own not in inherited:
            each.setdefault("additionalProperties", False)
    return jsonschema.Draft202012Validator({"$ref": f"#/components/schemas/{name}", "components": components})


def test_responses_are_what_the_document_says(server: str, document: Any) -> None:
    with fathom.Client(server, token="secret") as client:
        made = client.submit(description(dataset="responses", count=2)).wait(progress=False)
    with httpx.Client(base_url=server, headers={"Authorization": "Bearer secret"}) as http:
        for path, name in {
            f"/v1/jobs/{made.id}": "Job",
            "/v1/jobs": "Page_Job",
            "/v1/images?dataset=responses": "Page_ImageRow",
            f"/v1/images/{made.id}/0": "ImageRecord",
            "/v1/datasets": "Page_Dataset",
            "/v1/datasets/responses": "DatasetDetail",
            "/v1/datasets/responses/stats?metrics=uiqm": "Statistics",
            "/v1/datasets/responses/histogram?column=uiqm": "Histogram",
            "/v1/scenes": "Page_Scene",
            "/v1/waters": "Page_Water",
            "/v1/styles": "Page_StyleCard",
            "/v1/lists": "Page_List",
            "/v1/lists/findings": "Page_ListEntry",
            "/v1/workers": "Page_Worker",
            "/version": "Version",
            "/v1/jobs/none": "Problem",
            "/v1/images?filter=uiqm+is": "Problem",
        }.items():
            response = http.get(path).json()
            errors = [f"{error.json_path}: {error.message}" for error in _closed(document, name).iter_errors(response)]
            assert not errors, (path, errors)
        wrong = http.post("/v1/jobs", json=description(alpha=2, metrics=["uiqmm"], unheard_of=1))
        assert wrong.status_code == 422
        assert not list(_closed(document, "Problem").iter_errors(wrong.json()))
        preview = http.post("/v1/jobs/preview", json=description()).json()
        assert not list(_closed(document, "JobPreview").iter_errors(preview))


@pytest.fixture(scope="module")
def generated(document: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Generate a client with a stock generator, as a user would; every operation and schema must be in it."""
    pytest.importorskip("openapi_python_client")
    place = tmp_path_factory.mktemp("generated")
    (place / "openapi.json").write_text(json.dumps(document))
    # The generator knows few media types by itself.
    files = ["application/*", "application/x-tar", "image/jpeg", "image/png", "image/webp"]
    overrides = dict.fromkeys(files, "application/octet-stream") | {"application/x-ndjson": "text/plain"}
    (place / "config.json").write_text(json.dumps({"content_type_overrides": overrides, "post_hooks": []}))
    command = ["generate", "--path", "openapi.json", "--config", "config.json", "--meta", "none"]
    made = subprocess.run(
        [sys.executable, "-m", "openapi_python_client", *command, "--output-path", "generated_client"],
        cwd=place,
        capture_output=True,
        text=True,
    )
    said = made.stdout + made.stderr
    assert made.returncode == 0, said
    for word in ("warning", "skipping", "unable to", "cannot parse", "not be generated", "omitted"):
        assert word not in said.lower(), said
    methods = [method for path in document["paths"].values() for method in path if method != "parameters"]
    modules = [path for path in place.glob("generated_client/api/*/*.py") if path.name != "__init__.py"]
    assert len(modules) == len(methods)
    sys.path.insert(0, str(place))
    yield "generated_client"
    sys.path.pop(0)


def test_a_generated_client_submits_waits_lists_and_fetches(generated: str, server: str) -> None:
    def call(name: str) -> Any:
        return importlib.import_module(f"{generated}.api.{name}").sync

    models = importlib.import_module(f"{generated}.models")
    client = importlib.import_module(generated).AuthenticatedClient(base_url=server, token="secret", timeout=90)
    job = models.JobDescription(
        dataset="generated",
        count=2,
        seed=7,
        scene=models.ProceduralSceneDescription(
            kind="procedural", family=models.SceneFamily.SHAFT, seed=models.IntLaw([0, 1000])
        ),
        camera=models.CameraDescription(width=96, height=64),
        water=models.WaterDescription(optics="jerlov-1C", range_scale=models.UniformLaw([0.2, 1.0])),
        artifacts=[models.ArtifactKind.RGB, models.ArtifactKind.RANGE],
        metrics=[models.Metric.UIQM, models.Metric.UIQMTABLE1],
    )
    assert _is_accepted(job.to_dict())
    submitted = call("jobs.submit_job")(client=client, body=job)
    assert isinstance(submitted, models.Job)
    ended = call("jobs.get_job")(submitted.id, client=client, wait=60)
    assert (ended.state, ended.done) == (models.JobState.DONE, 2)
    page = call("images.list_images")(client=client, dataset="generated", order_by="-uiqm")
    assert [row["dataset"] for row in page.items] == ["generated", "generated"]
    assert {row.frame for row in page.items} == {0, 1}
    record = call("images.get_image")(submitted.id, 1, client=client)
    assert record.parameters["scene"]["family"] == "shaft"
    picture = call("images.get_artifact")(submitted.id, 1, models.ArtifactKind.RGB, client=client).payload.read()
    assert picture.startswith(b"\x89PNG")
    stored = next(entry for entry in record.artifacts if entry.kind == models.ArtifactKind.RGB)
    assert len(picture) == stored.bytes_
    bits = call("lists.get_list")(models.ListName.FINDINGS, client=client)
    assert [entry.number for entry in bits.items] == list(range(len(bits.items)))


def test_a_generated_client_gets_every_error_of_a_bad_job(generated: str, server: str) -> None:
    models = importlib.import_module(f"{generated}.models")
    submit = importlib.import_module(f"{generated}.api.jobs.submit_job")
    client = importlib.import_module(generated).AuthenticatedClient(base_url=server, token="secret")
    job = models.JobDescription.from_dict(description(alpha=2, water={"optics": "jerlov-9Z"}, count=0))
    problem = submit.sync(client=client, body=job)
    assert isinstance(problem, models.Problem)
    assert problem.type_ == models.ProblemType.VALIDATION
    errors = {error.pointer: error for error in problem.errors}
    assert set(errors) == {"/alpha", "/count", "/water/optics"}
    assert errors["/alpha"].limit == "0..=1"
    assert "jerlov-1C/williamson2022" in errors["/water/optics"].allowed
