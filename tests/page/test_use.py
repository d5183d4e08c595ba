"""What a person does: with the keyboard alone, while the service is away, with a token, and dragging."""

import json
import re
import urllib.parse
import urllib.request

from conftest import JOB, Service, until


def test_the_keyboard_alone_leads_from_the_datasets_to_an_image_and_back(visit):
    page = visit()
    page.wait_for_selector(".card h2 a")
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.textContent") == "reef":
            break
    page.keyboard.press("Enter")
    page.wait_for_selector(".cell a")
    page.keyboard.press("/")
    page.keyboard.type("al")
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    assert page.input_value("#filter") == "alpha "
    page.keyboard.type("> 0")
    page.keyboard.press("Enter")
    until(page, "document.querySelector('.counts').textContent.includes(' of ')")
    page.focus(".grid")
    page.keyboard.press("ArrowRight")
    until(page, "document.activeElement.closest('.cell')?.dataset.at === '0'")
    page.keyboard.press("ArrowRight")
    until(page, "document.activeElement.closest('.cell')?.dataset.at === '1'")
    page.keyboard.press("Enter")
    page.wait_for_selector("canvas.right:not(.waiting)")
    first = page.url
    page.wait_for_selector("a[rel=next]")
    page.keyboard.press("ArrowRight")
    until(page, "(first) => location.href !== first", arg=first)
    page.focus("input.wide")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("document.querySelector('.divider').style.left") == "50.5%"
    page.focus("header a")
    page.keyboard.press("?")
    page.wait_for_selector("dialog#keys[open]")
    assert "Scenes" in page.locator("#keys").inner_text()
    page.keyboard.press("Escape")
    page.wait_for_selector("dialog#keys[open]", state="hidden")
    for key, title in (("s", "Scenes"), ("d", "Datasets"), ("j", "Jobs")):
        page.keyboard.press("g")
        page.keyboard.press(key)
        until(page, "(title) => document.querySelector('h1')?.textContent === title", arg=title)


def test_a_service_that_dies_and_returns_is_waited_for(visit, browser, tmp_path):
    service = Service(str(tmp_path))
    try:
        service.render({**JOB, "count": 2})
        page = visit(to=service)
        page.wait_for_selector(".card h2 a")
        service.stop()
        page.click(".card h2 a")
        page.wait_for_selector("#gone:not([hidden])")
        service.start()
        page.wait_for_selector(".cell a", timeout=30_000)
        page.wait_for_selector("#gone", state="hidden")
    finally:
        service.stop()


def test_thumbnails_that_a_busy_service_refuses_are_requested_again(visit):
    refused = set()

    def refuse_once(route):
        if route.request.url in refused:
            route.continue_()
        else:
            refused.add(route.request.url)
            route.fulfill(status=503, headers={"retry-after": "1"}, content_type="application/problem+json", body='{"title": "Busy"}')

    page = visit()
    page.route("**/preview", refuse_once)
    page.click(".card h2 a")
    page.wait_for_selector(".cell img")
    until(page, "[...document.querySelectorAll('.cell img')].every((image) => image.naturalWidth > 0)")
    assert refused


def test_a_token_is_requested_once_and_survives_a_reload(visit, tmp_path):
    service = Service(str(tmp_path), token="s3cret")
    try:
        service.render({**JOB, "count": 2})
        page = visit(to=service)
        page.wait_for_selector("dialog[open]")
        page.fill("dialog input", "wrong")
        page.click("dialog button")
        until(page, "document.getElementById('token-why').textContent.includes('unknown')")
        page.fill("dialog input", "s3cret")
        page.click("dialog button")
        page.click(".card h2 a")
        until(page, "[...document.querySelectorAll('.cell img')].length === 2 && [...document.querySelectorAll('.cell img')].every((image) => image.naturalWidth > 0)")
        assert page.locator("dialog[open]").count() == 0
        kept = page.evaluate("JSON.stringify([{...localStorage}, document.cookie, location.href])")
        assert "s3cret" not in kept
        page.reload()
        until(page, "document.querySelectorAll('.cell img').length === 2")
        assert page.locator("dialog[open]").count() == 0
        other = visit(to=service)
        other.wait_for_selector("dialog[open]")
    finally:
        service.stop()


OWN = {**JOB, "dataset": "composed", "water": {"optics": "jerlov-1C", "range_scale": 0.4, "style": "atlantic"}, "alpha": 0.5, "labels": {}}


def test_a_drag_renders_again_and_a_wrong_value_is_told_at_its_field(visit):
    page = visit("compose?job=" + urllib.parse.quote(json.dumps(OWN)))
    until(page, "JSON.parse(document.querySelector('[data-speed]').dataset.speed || '{}').isFull", timeout=60_000)
    drawn = "JSON.parse(document.querySelector('[data-speed]').dataset.speed).drawn"
    before = page.evaluate(drawn)
    asked = []
    page.on("request", lambda request: asked.append(request.post_data_json) if request.url.endswith("/v1/renders") else None)
    slider = page.locator("[id='f-alpha']")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.5, box["y"] + box["height"] / 2)
    page.mouse.down()
    for step in range(30):
        page.mouse.move(box["x"] + box["width"] * (0.5 + step / 80), box["y"] + box["height"] / 2)
        page.wait_for_timeout(30)
    page.mouse.up()
    until(page, f"{drawn} > {before + 3}", timeout=60_000)
    until(page, "JSON.parse(document.querySelector('[data-speed]').dataset.speed).isFull", timeout=60_000)
    widths = {"rough": [], "exact": []}
    for frame in asked:
        kind = "rough" if frame.get("fidelity") == {"tolerance": 0.02} else "exact"
        if "encode" in frame:
            widths[kind].append(frame["camera"]["width"])
    # A drag renders small images to a loose tolerance; at rest follow the half and the full size, as exact as the job.
    assert len([width for width in widths["rough"] if width in (48, 72, 96)]) > 3
    assert widths["exact"][:2] == [96, 192]
    job = json.loads(page.input_value("#json"))
    assert job["alpha"] > 0.5
    page.fill("[data-pointer='/alpha'] input[type=number]", "3")
    page.wait_for_selector("[data-pointer='/alpha'] .wrong:not([hidden])")
    assert "must be 0..=1" in page.locator("[data-pointer='/alpha'] .wrong").inner_text()
    assert page.locator("button.primary", has_text="Submit").is_disabled()
    job["alpha"] = {"uniform": [0.1, 0.2]}
    job["count"] = 2
    job["camera"] = {"width": 96, "height": 64}
    page.fill("#json", json.dumps(job))
    page.wait_for_selector("[data-pointer='/alpha'] svg.law")
    until(page, "document.querySelector('.frames').children.length === 2")
    page.click("text=Submit")
    until(page, "location.hash.startsWith('#/jobs/job_')")
    until(page, "document.querySelector('.big')?.textContent.includes('done')", timeout=60_000)


def test_images_of_a_drag_become_larger_while_they_are_fast(visit):
    page = visit("compose")
    # Milliseconds of each image, and the share of the full size of the next one.
    sizes = """async (times) => {
      const { DragSize } = await import("/assets/live.js");
      const size = new DragSize();
      return [size.share, ...times.map((ms) => { size.note(ms); return size.share; })];
    }"""
    assert page.evaluate(sizes, [30, 50, 90, 90]) == [0.25, 0.375, 0.5, 0.5, 0.5]
    assert page.evaluate(sizes, [300, 80, 40, 150, 30, 30]) == [0.25, 0.25, 0.25, 0.375, 0.25, 0.25, 0.25]


def test_an_empty_service_shows_first_steps(visit, tmp_path):
    service = Service(str(tmp_path))
    try:
        for view, text in (("", "There are no images yet"), ("compare", "There are no images yet"), ("scenes", "No scenes are uploaded yet"),
                           ("jobs", "There are no jobs"), ("speed", "There are no datasets yet")):
            page = visit(view, to=service)
            page.wait_for_selector(f"text={text}")
            assert page.locator(".problem").count() == 0
            assert view == "speed" or page.locator("main a[href='#/compose']").count() == 1
    finally:
        service.stop()


def test_a_live_frame_has_the_bytes_of_a_job_and_is_none(service):
    frame = {"scene": {"kind": "procedural", "family": "structure", "seed": 3}, "camera": {"width": 96, "height": 64},
             "water": {"optics": "jerlov-1C", "range_scale": 0.3, "style": "atlantic"}, "alpha": 0.4, "artifacts": ["rgb"], "metrics": [],
             "encode": {"format": "jpeg", "quality": 82}}

    def picture(job):
        headers = {"content-type": "application/json", "accept": "image/*"}
        with urllib.request.urlopen(urllib.request.Request(service.address + "/v1/renders", json.dumps(job).encode(), headers)) as response:
            return response.headers["content-type"], response.read()

    def attempts():
        with urllib.request.urlopen(service.address + "/metrics") as response:
            return re.search(r"^fathom_attempts_total (\d+)", response.read().decode(), re.M)[1]

    before = attempts()
    live = [picture(frame) for _ in range(3)]
    assert attempts() == before
    stored = picture({**frame, "dataset": "beside"})
    assert attempts() != before
    assert live == [stored] * 3 and stored[0] == "image/jpeg"


def test_a_style_is_seen_while_it_learns(visit, tmp_path):
    service = Service(str(tmp_path))
    try:
        photo = tmp_path / "photo.jpg"
        frame = {"scene": {"kind": "procedural", "family": "structure", "seed": 5}, "camera": {"width": 320, "height": 240},
                 "water": {"optics": "jerlov-5C", "range_scale": 0.4}, "artifacts": ["rgb"], "metrics": []}
        request = urllib.request.Request(service.address + "/v1/renders", json.dumps(frame).encode(),
                                         {"content-type": "application/json", "accept": "image/*"})
        photo.write_bytes(urllib.request.urlopen(request).read())
        page = visit("styles", to=service)
        page.set_input_files(".drop input[type=file]", photo)
        page.fill(".drop input[type=text]", "pier")
        page.fill(".drop input[type=number]", "5000")
        page.click(".drop button")
        until(page, "document.querySelector('img.learning')?.naturalWidth > 0", timeout=120_000)
        first = page.get_attribute("img.learning", "src")
        until(page, "(first) => document.querySelector('img.learning').src.endsWith(first) === false", arg=first, timeout=120_000)
        until(page, "document.querySelector('img.learning').naturalWidth === 320")
        page.click("text=Stop")
        until(page, "document.querySelector('.drop').textContent.includes('cancelled')")
        assert page.locator("img.learning").count() == 1
    finally:
        service.stop()


def test_a_lamp_is_moved_in_the_picture(visit):
    page = visit("compose?job=" + urllib.parse.quote(json.dumps(OWN)))
    page.click("text=Add haze")
    page.wait_for_selector(".handle")
    page.focus(".handle")
    page.keyboard.press("ArrowLeft")
    until(page, "JSON.parse(document.getElementById('json').value).lights[0].x === 0.48")


def test_a_seed_of_64_bits_keeps_its_digits(visit, service):
    seed = 9007199254740993
    job = json.dumps({**JOB, "dataset": "exact", "count": 1, "seed": seed})
    page = visit(f"compose?job={urllib.parse.quote(job)}")
    until(page, "!document.querySelector('button.primary').disabled")
    assert f'"seed": {seed}' in page.input_value("#json")
    posted = []
    page.on("request", lambda request: posted.append(request.post_data) if request.url.endswith("/v1/jobs") else None)
    page.click("button.primary")
    until(page, "location.hash.startsWith('#/jobs')")
    assert f'"seed":{seed}' in posted[0]
    job = page.evaluate("decodeURIComponent(location.hash.split('/')[2])")
    with urllib.request.urlopen(f"{service.address}/v1/jobs/{job}/description") as response:
        assert json.load(response)["seed"] == seed
