"""A service with a small set, and a browser beside it."""

import json
import os
import signal
import socket
import subprocess
import tempfile
import time
import urllib.request
from pathlib import Path

import axe_core_python
import pytest
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).resolve().parents[2]
FATHOM = os.environ.get("FATHOM", str(ROOT / "target/release/fathom"))
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
AXE = (Path(axe_core_python.__file__).parent / "axe.min.js").read_text()

# Were any of them read as markup, a script would run or an element would appear.
HOSTILE = "<img src=x onerror=\"window.hacked=1\"><script>window.hacked=1</script>'\"&lt;"

FRAMES = 12
JOB = {
    "dataset": "reef",
    "count": FRAMES,
    "seed": 7,
    "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1000]}},
    "camera": {"width": 192, "height": 123},
    "water": {"optics": {"choice": ["jerlov-IB", "jerlov-1C"]}, "range_scale": {"uniform": [0.1, 0.6]}, "style": "atlantic"},
    "alpha": {"uniform": [0.1, 0.9]},
    "artifacts": ["rgb", "clean", "direct", "range", "instances", "semantics", "boxes", "normals"],
    "metrics": ["uiqm", "entropy"],
    "labels": {"note": HOSTILE},
}


def pytest_addoption(parser):
    parser.addoption("--pictures", action="store_true", help="draw the pictures of the documentation again")


def until(page, expression, arg=None, timeout=60_000):
    """Waits for an expression to become true; that of Playwright is stopped by the policy of the page."""
    end = time.monotonic() + timeout / 1000
    while time.monotonic() < end:
        if page.evaluate(expression, arg):
            return
        page.wait_for_timeout(50)
    raise TimeoutError(expression)


def drag(page, selector, begin, end):
    """Drags over an element, between shares of its sides."""
    page.locator(selector).scroll_into_view_if_needed()
    box = page.locator(selector).bounding_box()
    at = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in (begin, end)]
    page.mouse.move(*at[0])
    page.mouse.down()
    page.mouse.move(*at[1], steps=5)
    page.mouse.up()


class Service:
    """A `fathom serve` that can be ended and started again at the same address."""

    def __init__(self, folder, token=None, workers=1):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.address = f"http://127.0.0.1:{self.port}"
        self.folder = folder
        self.token = token
        self.workers = workers
        self.start()

    def start(self, patience_s=60):
        command = [FATHOM, "serve", "--data", self.folder, "--listen", f"127.0.0.1:{self.port}", "--slots", "1", "--workers", str(self.workers)]
        environment = {**os.environ, **({"FATHOM_TOKEN": self.token} if self.token else {})}
        self.process = subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL)
        for _ in range(10 * patience_s):
            try:
                urllib.request.urlopen(f"{self.address}/livez").close()
                return
            except OSError:
                time.sleep(0.1)
        raise TimeoutError("the service did not start")

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(60)

    def ask(self, path, body=None):
        headers = {"content-type": "application/json"}
        if self.token:
            headers["authorization"] = f"Bearer {self.token}"
        data = None if body is None else json.dumps(body).encode()
        with urllib.request.urlopen(urllib.request.Request(self.address + path, data, headers)) as response:
            return json.load(response)

    def upload(self, files, **fields):
        """Uploads a scene; `files` maps part names to paths."""
        boundary = "fathom-page-test"
        parts = [f'--{boundary}\r\ncontent-disposition: form-data; name="{name}"\r\n\r\n{value}\r\n'.encode() for name, value in fields.items()]
        for name, path in files.items():
            head = f'--{boundary}\r\ncontent-disposition: form-data; name="{name}"; filename="{path.name}"\r\n\r\n'
            parts.append(head.encode() + path.read_bytes() + b"\r\n")
        body = b"".join([*parts, f"--{boundary}--\r\n".encode()])
        request = urllib.request.Request(self.address + "/v1/scenes", body, {"content-type": f"multipart/form-data; boundary={boundary}"})
        with urllib.request.urlopen(request) as response:
            return json.load(response)

    def render(self, job):
        """Submits a job and waits for it."""
        identity = self.ask("/v1/jobs", job)["id"]
        for _ in range(20):
            row = self.ask(f"/v1/jobs/{identity}?wait=30")
            if row["state"] in ("done", "done_with_failures"):
                return row
        raise TimeoutError(row)


@pytest.fixture(scope="session")
def service():
    with tempfile.TemporaryDirectory() as folder:
        service = Service(folder)
        assert service.render(JOB)["failed"] == 0
        yield service
        service.stop()


@pytest.fixture(scope="session")
def dock(service, tmp_path_factory):
    """A collection `dock` of two uploaded scenes with range and mask, rendered in air. Returns their ids."""
    folder = tmp_path_factory.mktemp("dock")
    dry = {"dataset": "dry", "count": 2, "scene": {"kind": "procedural", "family": "structure", "lighting": "in_air", "seed": {"int": [0, 99]}},
           "camera": {"width": 192, "height": 123}, "artifacts": ["rgb", "range", "instances"], "metrics": []}
    job = service.render(dry)["id"]
    ids = []
    for frame in range(2):
        files = {}
        for kind in ("rgb", "range", "instances"):
            files[kind] = folder / f"{frame}-{kind}.png"
            with urllib.request.urlopen(f"{service.address}/v1/images/{job}/{frame}/artifacts/{kind}") as response:
                files[kind].write_bytes(response.read())
        uploaded = service.upload(files, unit_m=0.001, invalid_code=0, hfov_deg=80, collection="dock", name=f"view-{frame}")
        ids.append(uploaded["id"])
    return ids


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def visit(browser, service):
    """Opens views in new tabs, and afterwards requires that nothing was complained about and no text became a script."""
    opened = []

    def visit(view="", *, scheme="light", width=1280, height=800, to=service):
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme)
        page = context.new_page()
        page.complaints = []
        page.on("pageerror", lambda error: page.complaints.append(str(error)))
        page.on("console", lambda message: complain(page, message))
        page.goto(f"{to.address}/#/{view}")
        page.wait_for_selector("main h1")
        opened.append(page)
        return page

    yield visit
    for page in opened:
        if not page.is_closed():
            assert page.evaluate("window.hacked") is None
            assert page.complaints == []
            page.context.close()


def complain(page, message):
    # A browser notes each response that is no success, even one that the page expects and shows.
    if message.type == "error" and "Failed to load resource" not in message.text:
        page.complaints.append(message.text)
