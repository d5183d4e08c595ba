"""Every view shows what the service has, as text, and for those who cannot see it."""

import re
import urllib.error
import urllib.parse
import urllib.request

import pytest
from conftest import AXE, FRAMES, HOSTILE, ROOT, drag, until

VIEWS = ["", "dataset/reef", "dataset/reef?overlay=semantics&order=-uiqm&x=alpha&y=uiqm", "image", "jobs", "job", "compose", "scenes", "waters", "styles",
         "speed", "compare?a=reef&b=reef"]

# `scripts/write_webp.py` converts them for docs/pictures.
PICTURES = ROOT / "target/docs"


def address(service, view):
    """The address of a view, with the first image or job of the service where it needs one."""
    job = service.ask("/v1/jobs?dataset=reef")["items"][0]["id"]
    return {"image": f"image/{job}/0?boxes=1", "job": f"jobs/{job}"}.get(view, view)


def settled(page):
    page.wait_for_load_state("networkidle")
    until(page, "!document.querySelector('[aria-busy]')")


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("view", VIEWS)
def test_a_view_has_no_fault_of_accessibility_and_fits(visit, service, dock, view, width):
    page = visit(address(service, view), width=width)
    settled(page)
    page.evaluate(AXE)
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")
        assert [(scheme, one["id"], one["nodes"][0]["html"][:200]) for one in found["violations"]] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= page.viewport_size["width"]
    assert page.locator("details.same").count() == 1


def test_a_dataset_shows_its_images_and_a_filter_fewer(visit, service):
    page = visit("dataset/reef")
    page.wait_for_selector(".cell img")
    assert page.locator(".cell").count() == FRAMES
    until(page, "[...document.querySelectorAll('.cell img')].every((image) => image.naturalWidth > 0)")
    page.fill("#filter", "frame < 5")
    page.press("#filter", "Enter")
    until(page, "document.querySelectorAll('.cell a').length === 5")
    until(page, "document.querySelector('.counts').textContent.startsWith('5 of')")
    assert urllib.parse.parse_qs(page.url.split("?")[1])["filter"] == ["frame < 5"]
    other = visit(page.url.split("#/")[1])
    until(other, "document.querySelectorAll('.cell a').length === 5")


def test_a_wrong_filter_says_where_and_offers_the_right_name(visit):
    page = visit("dataset/reef?filter=alpha%20%3E%200%20and%20uiqmm%20%3E%200")
    page.wait_for_selector(".wrong mark")
    assert page.locator(".wrong mark").inner_text() == "uiqmm"
    page.click(".wrong button")
    page.wait_for_selector(".cell a")
    assert page.input_value("#filter") == "alpha > 0 and uiqm > 0"


def test_a_drag_over_a_histogram_and_a_density_becomes_a_filter(visit):
    page = visit("dataset/reef?column=alpha&x=alpha&y=uiqm")
    page.wait_for_selector("svg.histogram .bar")
    drag(page, "svg.histogram", (0.1, 0.5), (0.6, 0.5))
    until(page, "document.getElementById('filter').value.startsWith('alpha between')")
    until(page, "document.querySelector('.counts').textContent.includes(' of ')")
    page.click("text=Clear")
    until(page, "document.querySelector('canvas.density').getAttribute('aria-label').startsWith('Density:')")
    drag(page, "canvas.density", (0.05, 0.05), (0.95, 0.95))
    until(page, "document.getElementById('filter').value.includes(' and uiqm between')")


def test_an_image_shows_its_layers_numbers_and_hostile_labels_as_text(visit, service):
    page = visit(address(service, "image"))
    page.wait_for_selector("canvas.right:not(.waiting)")
    assert HOSTILE in page.locator("main").inner_text()
    assert page.locator("main img[src=x]").count() == 0
    for kind in ("range", "normals", "direct", "semantics"):
        page.get_by_label("Right", exact=True).select_option(kind)
        until(page, "(kind) => document.querySelector('canvas.right:not(.waiting)')?.getAttribute('aria-label').includes(kind)", arg=kind)
        painted = "(canvas) => new Set(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data).size"
        assert page.locator("canvas.right").evaluate(painted) > 4
    page.click("text=Render again and compare")
    page.wait_for_selector("text=The bytes are the same.", timeout=120_000)


def test_parameters_of_an_image_fit_and_can_be_searched(visit, service):
    page = visit(address(service, "image"))
    page.wait_for_selector(".group table")
    names = page.locator(".group[open] th[scope=row]").evaluate_all("(cells) => cells.map((cell) => cell.getBoundingClientRect().width)")
    assert min(names) >= 80
    assert page.evaluate("document.documentElement.scrollHeight") <= 3000
    heads = page.locator("[data-group=water] thead th").all_inner_texts()
    assert heads == ["parameter", "value", "distribution"]
    assert page.locator("[data-group=camera] thead th").count() == 2
    assert page.locator("[data-group=camera] table").is_hidden()
    page.fill("[aria-label='Find a parameter']", "hfov")
    assert page.locator(".group th[scope=row]:visible").all_inner_texts() == ["hfov_deg"]
    page.fill("[aria-label='Find a parameter']", "")
    assert page.locator("[data-group=camera] table").is_hidden()


def test_hostile_names_in_the_address_are_text(visit):
    page = visit("dataset/" + urllib.parse.quote(HOSTILE, safe=""))
    page.wait_for_selector(".problem")
    assert page.locator("main h1").inner_text() == HOSTILE


def test_a_job_goes_on_before_the_eyes_and_can_be_cancelled(visit, service):
    job = service.ask("/v1/jobs", {**JOB_OF_MANY, "labels": {"note": HOSTILE}})["id"]
    page = visit(f"jobs/{job}")
    done = "Number(document.querySelector('progress').value)"
    until(page, f"{done} > 0", timeout=60_000)
    first = page.evaluate(done)
    until(page, f"{done} > {first}", timeout=60_000)
    page.click("text=Pause")
    page.wait_for_selector("text=Resume")
    page.click("text=Cancel")
    until(page, "document.querySelector('.big').textContent.includes('cancelled')")
    assert service.ask(f"/v1/jobs/{job}")["state"] == "cancelled"


JOB_OF_MANY = {"dataset": "many", "count": 100_000, "scene": {"kind": "procedural", "family": "shaft", "seed": 1},
               "camera": {"width": 96, "height": 64}, "artifacts": ["rgb"], "metrics": []}


def test_everything_comes_from_the_service_under_a_strict_policy(service):
    with urllib.request.urlopen(service.address + "/") as response:
        policy = response.headers["content-security-policy"]
        tag = response.headers["etag"]
        start = response.read().decode()
    assert "default-src 'none'" in policy and "unsafe" not in policy
    assert not re.search(r"https?://|<script>|style=|onclick", start)
    again = urllib.request.Request(service.address + "/", headers={"if-none-match": tag})
    with pytest.raises(urllib.error.HTTPError, match="304"):
        urllib.request.urlopen(again)


@pytest.mark.skipif("not config.getoption('--pictures')")
def test_pictures_of_the_documentation(visit, service):
    sites = {"dataset": "sites", "site": {"choice": ["harbour-wall", "shaft", "pipeline"]}, "count": 60, "seed": 2,
             "camera": {"width": 384, "height": 246}, "artifacts": ["rgb", "range", "semantics", "boxes"], "metrics": ["uiqm"]}
    service.render(sites)
    page = visit("dataset/sites?order=-uiqm&x=instances.count&y=uiqm", width=1280, height=860)
    settled(page)
    page.screenshot(path=PICTURES / "page-dataset.png")
    page = visit("compose", width=1280, height=860)
    until(page, "document.querySelectorAll('.frames canvas').length === 12 && document.querySelectorAll('.frames canvas.waiting').length === 0", timeout=120_000)
    page.screenshot(path=PICTURES / "page-compose.png")
