"""The content of the views: scenes, jobs, legends, columns, waters, charts and words."""

import json
import re
import urllib.parse

import pytest
from conftest import FRAMES, ROOT, until

PICTURE = (ROOT / "services/api/page/picture.js").read_text()
COLORS = (ROOT / "services/cli/src/colors.rs").read_text()


def table_of(source, name):
    """The rows of a constant with colors, in JavaScript or Rust."""
    body = re.search(name + r"[^=]*=\s*\[(.*?)\];", source, re.S)[1]
    return [tuple(map(int, row)) for row in re.findall(r"\[(\d+), (\d+), (\d+)\]", body)]


@pytest.mark.parametrize("name", ["CATEGORY_COLORS", "FINDING_COLORS", "RAMP"])
def test_the_palette_is_that_of_the_contact_sheets(service, name):
    colors = table_of(PICTURE, name)
    assert len(colors) > 5 and colors == table_of(COLORS, name)
    names = {"CATEGORY_COLORS": "categories", "FINDING_COLORS": "findings"}
    if name in names:
        assert len(service.ask(f"/v1/lists/{names[name]}")["items"]) == len(colors)


def test_colors_of_objects_are_those_of_the_contact_sheets(visit):
    page = visit("dataset/reef")
    found = page.evaluate("import('/assets/picture.js').then(({ instanceColor }) => [1, 2, 77].map(instanceColor))")
    expected = []
    for number in (1, 2, 77):
        hue = number * 0.61803398875 % 1 * 6
        light = 175 if number % 2 else 235
        places = [(offset + hue) % 6 for offset in (5, 3, 1)]
        expected.append([int(light * (1 - 0.75 * min(1, max(0, min(place, 4 - place))))) for place in places])
    assert found == expected


def test_an_overlay_has_a_legend(visit, service):
    page = visit("dataset/reef?overlay=semantics")
    until(page, "document.querySelectorAll('.legend-line i').length > 1")
    known = {one["name"] for one in service.ask("/v1/lists/categories")["items"]}
    shown = re.split(r"\s{1,}", page.locator(".legend-line").inner_text().strip())
    assert set(shown) <= known and "background" not in shown
    page.get_by_label("Overlay", exact=True).select_option("range")
    page.wait_for_selector(".legend-line .ramp")
    page.get_by_label("Overlay", exact=True).select_option("boxes")
    until(page, "document.querySelector('.legend-line').textContent.includes('dashed')")


def test_the_layers_of_an_image_have_legends(visit, service):
    job = service.ask("/v1/jobs?dataset=reef")["items"][0]["id"]
    page = visit(f"image/{job}/0?left=range&right=semantics")
    page.wait_for_selector(".layers .ramp")
    until(page, "document.querySelectorAll('.layers .legend i:not(.ramp)').length > 1")
    assert re.search(r"\d\.\d\d m", page.locator(".layers").inner_text())


def test_columns_without_values_are_not_suggested(visit):
    page = visit("dataset/reef")
    page.wait_for_selector(".cell a")
    page.get_by_label("Order", exact=True).focus()
    names = "[...document.querySelector('.tools datalist').options].map((option) => option.value)"
    until(page, f"{names}.length > 5")
    suggested = page.evaluate(names)
    assert {"job and frame", "alpha", "uiqm", "water.range_scale"} <= set(suggested)
    assert "camera.path.frames" not in suggested and len(suggested) < 100
    page.keyboard.type("alpha")
    page.keyboard.press("Enter")
    until(page, "location.hash.includes('order=alpha')")
    page.get_by_label("Order", exact=True).fill("nonsense")
    page.keyboard.press("Enter")
    assert page.get_by_label("Order", exact=True).get_attribute("aria-invalid") is not None
    page.get_by_label("Order", exact=True).fill("job and frame")
    page.keyboard.press("Enter")
    until(page, "!location.hash.includes('order')")
    assert page.locator(".cell").count() == FRAMES


def test_scenes_and_collections_are_cards_to_compose_with(visit, dock):
    page = visit("scenes")
    page.wait_for_selector("text=2 uploaded scenes")
    until(page, "document.querySelectorAll('canvas.scene').length === 4 && document.querySelectorAll('canvas.scene.waiting').length === 0")
    text = page.locator("main").inner_text()
    assert "dock / view-0" in text and "192×123 · range · mask · 80° wide" in text and "2 scenes · range · masks" in text
    page.locator("article", has_text="2 scenes").get_by_text("Compose with it").click()
    until(page, "!document.querySelector('button.primary')?.disabled && document.querySelectorAll('.frames canvas').length === 2")
    assert json.loads(page.input_value("#json"))["scene"] == {"kind": "collection", "name": "dock", "each": True}
    page.go_back()
    page.locator("article", has_text=dock[1]).get_by_text("Compose with it").click()
    until(page, "!document.querySelector('button.primary')?.disabled && document.querySelectorAll('.frames canvas').length > 0")
    assert json.loads(page.input_value("#json"))["scene"] == {"kind": "uploaded", "id": dock[1]}


def test_a_job_shows_its_images_and_description(visit, service):
    job = service.ask("/v1/jobs?dataset=reef")["items"][0]["id"]
    page = visit(f"jobs/{job}")
    until(page, "document.querySelectorAll('.tiles img').length === 12")
    description = json.loads(page.locator("pre[aria-label='The job as JSON']").inner_text())
    assert description == service.ask(f"/v1/jobs/{job}/description")
    page.click("text=Compose from this")
    until(page, "!document.querySelector('button.primary')?.disabled")
    assert json.loads(page.input_value("#json"))["alpha"] == {"uniform": [0.1, 0.9]}


def test_waters_are_grouped_and_searched(visit, service):
    page = visit("waters")
    page.wait_for_selector("details.origin")
    assert page.locator("details.origin").count() > 3
    assert page.locator("details.origin[open] article").count() < len(service.ask("/v1/waters")["items"])
    page.fill("#filter", "jerlov 3c williamson")
    assert page.locator("article:visible h3").all_inner_texts() == ["jerlov-3C/williamson2022"]
    assert page.locator("details.origin:visible").count() == 1
    page.fill("#filter", "no such water")
    page.wait_for_selector("text=No water matches.")


def test_the_speed_chart_has_axes_and_names_the_point_under_the_pointer(visit):
    page = visit("speed")
    page.wait_for_selector(".chart circle")
    for side in ("x", "y"):
        assert page.locator(f".chart text.tick.{side}").count() >= 4
    titles = " ".join(page.locator(".chart text.title").all_text_contents())
    assert "ms" in titles and "largest error" in titles
    page.locator(".chart circle.strong").hover()
    assert re.search(r"[\d.]+ ms, error ", page.locator(".chart .readout").inner_text())
    page.mouse.move(0, 0)
    assert page.locator(".chart .readout").inner_text() == ""


@pytest.mark.parametrize(("view", "width"), [("speed", 390), ("speed", 1280), ("waters", 390), ("waters", 1280)])
def test_the_text_of_a_chart_can_be_read(visit, view, width):
    page = visit(view, width=width)
    page.wait_for_selector(".chart text.tick.x")
    sizes = page.locator("svg.curves").evaluate_all("""(plots) => plots.filter((plot) => plot.clientWidth > 0)
        .map((plot) => parseFloat(getComputedStyle(plot.querySelector("text.tick")).fontSize) * plot.clientWidth / plot.viewBox.baseVal.width)""")
    assert min(sizes) >= 11.5
    boxes = page.locator("svg.curves").first.locator("text.tick.x").evaluate_all("(all) => all.map((one) => one.getBoundingClientRect()).map(({ left, right }) => [left, right])")
    assert len(boxes) >= 3
    assert all(right < left for (_, right), (left, _) in zip(boxes, boxes[1:]))


def test_a_chart_is_drawn_again_when_the_window_becomes_narrow(visit):
    page = visit("speed")
    page.wait_for_selector(".chart text.tick.x")
    shape = "document.querySelector('svg.curves').viewBox.baseVal.width"
    assert page.evaluate(shape) > 500
    page.set_viewport_size({"width": 390, "height": 800})
    until(page, f"{shape} < 390")


def test_former_addresses_of_datasets_work(visit):
    page = visit("set/reef?" + urllib.parse.urlencode({"filter": "frame < 5"}))
    until(page, "document.querySelectorAll('.cell a').length === 5")
    assert page.locator("header nav a[aria-current]").inner_text() == "Datasets"


@pytest.mark.parametrize("view", ["", "dataset/reef", "jobs", "job", "image", "speed", "compare?a=reef&b=reef"])
def test_a_collection_of_images_is_called_a_dataset(visit, service, view):
    job = service.ask("/v1/jobs?dataset=reef")["items"][0]["id"]
    page = visit({"job": f"jobs/{job}", "image": f"image/{job}/0"}.get(view, view))
    page.wait_for_load_state("networkidle")
    words = page.locator("body").inner_text() + " ".join(page.locator("[aria-label]").evaluate_all("(all) => all.map((one) => one.ariaLabel)"))
    assert re.findall(r"\b[Ss]ets?\b(?! the)", words) == []
