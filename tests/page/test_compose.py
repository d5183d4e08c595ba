"""Compose: any valid job can be submitted, and every control of the form changes the job."""

import json
import signal
import subprocess
import urllib.parse

import pytest
from conftest import FATHOM, JOB, Service, drag, until

COLLECTION = {"dataset": "dock-water", "count": 2, "scene": {"kind": "collection", "name": "dock", "each": True},
              "water": {"optics": "jerlov-1C"}, "artifacts": ["rgb", "range"]}


def compose(visit, job, **how):
    page = visit("compose?job=" + urllib.parse.quote(json.dumps(job)), **how)
    page.wait_for_selector(".compose-form details")
    return page


def job_of(page):
    return json.loads(page.input_value("#json"))


def ready(page):
    until(page, "!document.querySelector('button.primary').disabled && document.querySelectorAll('.frames canvas').length > 0")
    until(page, "document.querySelectorAll('.frames canvas.waiting').length === 0")


def test_a_job_over_a_collection_has_previews_and_can_be_submitted(visit, service, dock):
    page = compose(visit, COLLECTION)
    ready(page)
    page.wait_for_selector("text=Plan of this frame")
    until(page, "JSON.parse(document.querySelector('[data-speed]').dataset.speed || '{}').isFull")
    assert page.locator(".frames canvas").count() == 4
    assert page.locator(".problem").count() == 0
    page.click("text=Submit")
    until(page, "location.hash.startsWith('#/jobs/job_')")
    until(page, "document.querySelector('.big')?.textContent.includes('done')")
    job = service.ask("/v1/jobs?dataset=dock-water")["items"][0]
    assert (job["frames"], job["failed"]) == (4, 0)


SMALL = {"width": 96, "height": 64}
OWN_SITE = {"name": "quay-7", "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 9]}}, "water": {"optics": "jerlov-5C"}}
SPOT = {"kind": "spot", "position_m": [0, 0, 0], "intensity": [{"uniform": [2, 4]}, 3, 3]}
VALID = {
    "a drawn scene of a collection": {"count": 3, "scene": {"kind": "collection", "name": "dock", "each": False}, "artifacts": ["rgb"]},
    "a collection in a site": {"count": 1, "site": "shaft", "scene": {"kind": "collection", "name": "dock", "each": True},
                               "camera": {"hfov_deg": None}, "artifacts": ["rgb"]},
    "every site of a mix": {"count": 2, "site": {"grid": ["shaft", "tank"]}, "camera": SMALL},
    "a site in the job": {"count": 3, "site": OWN_SITE, "camera": SMALL},
    "a site without lights": {"count": 3, "site": "harbour-wall", "camera": SMALL, "water": {"snow": None}, "lights": []},
    "a path": {"count": 3, "scene": {"kind": "procedural", "family": "structure", "seed": 4}, "camera": {**SMALL, "path": {"frames": 3}}, "artifacts": ["rgb"]},
    "random lights": {"count": 3, "scene": {"kind": "procedural", "family": "structure"}, "camera": SMALL, "lights": {"choice": [[], [SPOT]]}, "artifacts": ["rgb"]},
}


@pytest.mark.parametrize("name", VALID)
def test_any_valid_job_has_previews_and_can_be_submitted(visit, dock, name):
    refused = []
    page = visit()
    page.on("response", lambda response: refused.append(response.url) if response.status >= 400 else None)
    page.goto(page.url.split("#")[0] + "#/compose?job=" + urllib.parse.quote(json.dumps(VALID[name])))
    page.wait_for_selector(".compose-form details")
    ready(page)
    page.wait_for_selector("text=Plan of this frame")
    until(page, "JSON.parse(document.querySelector('[data-speed]').dataset.speed || '{}').isFull")
    assert page.locator("button.primary", has_text="Submit").is_enabled()
    assert refused == []


def test_an_image_of_a_collection_opens_in_compose_as_one_scene(visit, service, dock):
    job = service.render({**COLLECTION, "dataset": "dock-image"})["id"]
    page = visit(f"image/{job}/0")
    page.click("text=Open in Compose")
    ready(page)
    assert job_of(page)["scene"] == {"kind": "uploaded", "id": dock[0], "lighting": "in_air"}


def test_json_that_is_not_valid_cannot_be_submitted(visit):
    page = compose(visit, {**JOB, "dataset": "kept"})
    ready(page)
    posted = []
    page.on("request", lambda request: posted.append(request.url) if request.url.endswith("/v1/jobs") else None)
    page.fill("#json", '{"dataset": "kept", ')
    assert page.locator("button.primary", has_text="Submit").is_disabled()
    page.wait_for_timeout(600)
    assert page.locator("button.primary", has_text="Submit").is_disabled()
    assert "JSON" in page.locator(".view-side .wrong").inner_text()
    page.fill("#json", json.dumps({**JOB, "dataset": "kept"}))
    ready(page)
    assert posted == []


def test_json_with_comments_is_read(visit):
    page = compose(visit, JOB)
    page.fill("#json", '// frames\n{"site": "tank", // a "tank"\n "labels": {"url": "http://a//b"}}')
    until(page, "document.querySelector('[aria-label=Site]').value === 'tank'")
    assert page.get_attribute("#json", "aria-invalid") is None
    page.fill("#f-dataset", "bath")
    assert job_of(page) == {"site": "tank", "labels": {"url": "http://a//b"}, "dataset": "bath"}


def test_a_preview_that_fails_leaves_submit_enabled(visit):
    page = compose(visit, {**JOB, "dataset": "unseen"})
    ready(page)
    page.route("**/v1/renders", lambda route: route.fulfill(status=500, content_type="application/problem+json", body='{"title": "Broken", "detail": "broken"}'))
    page.fill("[data-pointer='/alpha'] input[type=text], [data-pointer='/alpha'] input[type=number] >> nth=0", "0.2")
    page.wait_for_selector("text=The job is valid and can be submitted.")
    assert page.locator("button.primary", has_text="Submit").is_enabled()


def test_without_a_worker_the_remedy_is_shown_until_one_connects(visit, tmp_path):
    service = Service(str(tmp_path), workers=0)
    worker = None
    try:
        page = visit("compose", to=service)
        page.wait_for_selector("text=No worker is connected")
        assert f"fathom worker --server {service.address}" in page.locator(".view-side .problem").inner_text()
        assert "Rendering" not in page.locator("[data-speed]").inner_text()
        until(page, "!document.querySelector('button.primary').disabled")
        worker = subprocess.Popen([FATHOM, "worker", "--server", service.address], stderr=subprocess.DEVNULL)
        page.wait_for_selector("text=No worker is connected", state="detached")
        until(page, "JSON.parse(document.querySelector('[data-speed]').dataset.speed || '{}').isFull")
        # The worker signs off before its service ends.
        worker.send_signal(signal.SIGTERM)
        worker.wait(60)
    finally:
        if worker:
            worker.kill()
        service.stop()


def test_the_first_job_is_a_site_whose_values_can_be_replaced(visit):
    page = visit("compose")
    until(page, "!document.querySelector('button.primary').disabled && document.querySelectorAll('details.lamp').length === 4")
    assert job_of(page)["site"] == "shaft"
    scale = page.locator("[data-pointer='/water/range_scale']")
    assert "from the site" in scale.inner_text()
    scale.locator("input[type=number]").fill("0.5")
    until(page, "JSON.parse(document.getElementById('json').value).water?.range_scale === 0.5")
    page.get_by_label("Site", exact=True).select_option("tank")
    until(page, "JSON.parse(document.getElementById('json').value).site === 'tank'")
    assert "water" not in job_of(page)
    page.get_by_label("Site", exact=True).select_option("")
    until(page, "JSON.parse(document.getElementById('json').value).scene?.family === 'structure'")


def test_labels_are_words_with_units_and_help(visit):
    page = compose(visit, JOB)
    text = page.locator("[data-pointer='/water/depth_m']").inner_text()
    assert "Depth of the camera, m" in text and "water.depth_m" in text and "below the surface" in text


def test_every_part_of_a_spot_has_a_control(visit):
    job = {**JOB, "lights": [{"kind": "spot", "position_m": [0.4, -0.3, 0.0], "intensity": [6, 6, 6], "cone_deg": 35}]}
    page = compose(visit, job)
    page.wait_for_selector("details.lamp[open]")
    lamp = "[data-pointer='/lights/0/%s']"
    page.locator(lamp % "direction/0" + " input[type=number]").fill("-0.5")
    page.locator(lamp % "intensity" + " input[type=number]").fill("12")
    page.locator(lamp % "intensity" + " input[type=color]").fill("#ff0000")
    page.locator(lamp % "cone_deg" + " input[type=number]").fill("20")
    page.locator(lamp % "position_m/2" + " input[type=number]").fill("0.5")
    light = job_of(page)["lights"][0]
    assert light == {"kind": "spot", "position_m": [0.4, -0.3, 0.5], "intensity": [12, 0, 0], "direction": [-0.5, 0, 1], "cone_deg": 20}


def test_the_direction_of_a_spot_is_dragged_in_the_picture(visit):
    job = {**JOB, "lights": [{"kind": "spot", "position_m": [0, 0, 0], "intensity": [6, 6, 6], "direction": [0, 0, 1]}]}
    page = compose(visit, job)
    page.wait_for_selector(".handle.direction")
    until(page, "!document.querySelector('button.primary').disabled")
    drag(page, ".handle.direction", (0.5, 0.5), (5, 0.5))
    direction = job_of(page)["lights"][0]["direction"]
    assert direction[0] > 0.05 and abs(direction[1]) < 0.01 and direction[2] == 1
    before = direction[0]
    page.focus(".handle.direction")
    page.keyboard.press("ArrowLeft")
    assert job_of(page)["lights"][0]["direction"][0] < before


def test_a_light_of_a_site_is_moved_without_losing_the_others(visit):
    page = visit("compose")
    page.wait_for_selector(".handle.position")
    page.focus(".handle.position")
    page.keyboard.press("ArrowRight")
    until(page, "JSON.parse(document.getElementById('json').value).lights?.length === 4")


def test_uploaded_scenes_and_collections_can_be_chosen(visit, dock):
    page = visit("compose")
    page.wait_for_selector("#scene-source")
    until(page, "!document.querySelector('button.primary').disabled")
    page.select_option("#scene-source", "collection")
    until(page, "JSON.parse(document.getElementById('json').value).scene?.name === 'dock'")
    ready(page)
    page.select_option("#scene-source", "uploaded")
    until(page, "JSON.parse(document.getElementById('json').value).scene?.kind === 'uploaded'")
    page.get_by_label("Uploaded scene", exact=True).select_option(dock[0])
    until(page, "(id) => JSON.parse(document.getElementById('json').value).scene.id === id", arg=dock[0])
    ready(page)
    page.select_option("#scene-source", "procedural")
    until(page, "JSON.parse(document.getElementById('json').value).scene === undefined")
    ready(page)
