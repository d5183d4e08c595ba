"""Measures the page of a running service in Chromium: python measure.py ADDRESS DATASET [FILTER].

First paint of the dataset and of a changed filter, until the first row of thumbnails has its rows; frames a second while a slider of
Compose is dragged. Prints the load of the machine with them.
"""

import json
import os
import sys
import time
import urllib.parse

from conftest import CHROMIUM, until
from playwright.sync_api import sync_playwright

ROWS = "document.querySelectorAll('.cell a').length > 0"
SPEED = "document.querySelector('[data-speed]')?.dataset.speed || '{}'"
DRAG_S = 5
# A job with a style, and the site that Compose opens with; the slider that is dragged in each.
STYLED = {"scene": {"kind": "procedural", "family": "structure", "seed": 11}, "camera": {"width": 768, "height": 492},
          "water": {"optics": "jerlov-1C", "range_scale": 0.4, "style": "atlantic"}, "alpha": 0.5}
DRAGS = [("a job with a style", STYLED, "f-alpha"), ("the site shaft", {"site": "shaft"}, "f-water-range_scale")]


# The browser's own clock, from the beginning of the navigation: none of what drives it counts.
WATCH = """new MutationObserver((_, watch) => {
  if (!document.querySelector('.cell a')) return;
  window.painted = performance.now();
  watch.disconnect();
}).observe(document, { subtree: true, childList: true })"""


def first_paint(browser, address, name):
    """Milliseconds from the address to the first thumbnails' rows, in a tab that is empty."""
    page = browser.new_page()
    page.add_init_script(WATCH)
    page.goto(f"{address}/#/dataset/{urllib.parse.quote(name)}")
    until(page, "window.painted !== undefined")
    painted = page.evaluate("window.painted")
    page.close()
    return painted


def filtered(browser, address, name, condition):
    """Milliseconds from Enter to the rows and the count of another filter."""
    page = browser.new_page()
    page.goto(f"{address}/#/dataset/{urllib.parse.quote(name)}")
    until(page, ROWS)
    page.wait_for_load_state("networkidle")
    page.fill("#filter", condition)
    begun = time.perf_counter()
    page.press("#filter", "Enter")
    page.wait_for_selector(".cell a")
    rows = 1000 * (time.perf_counter() - begun)
    page.locator(".counts", has_text=" of ").wait_for()
    counted = 1000 * (time.perf_counter() - begun)
    page.close()
    return rows, counted


def drag(browser, address, job, field):
    """Frames a second while the slider of a field moves, and the milliseconds and width of the last one."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.goto(f"{address}/#/compose?job={urllib.parse.quote(json.dumps(job))}")
    page.wait_for_selector(".frames canvas:not(.waiting)")
    until(page, "document.querySelectorAll('.frames canvas.waiting').length === 0")
    page.locator(f"[id='{field}']").scroll_into_view_if_needed()
    slider = page.locator(f"[id='{field}']").bounding_box()
    y = slider["y"] + slider["height"] / 2
    page.mouse.move(slider["x"] + slider["width"] / 2, y)
    page.mouse.down()
    before = json.loads(page.evaluate(SPEED))["drawn"]
    begun = time.perf_counter()
    step = 0
    while time.perf_counter() - begun < DRAG_S:
        step += 1
        page.mouse.move(slider["x"] + slider["width"] * (0.1 + 0.8 * (step % 100) / 100), y)
        page.wait_for_timeout(16)
    last = json.loads(page.evaluate(SPEED))
    rate = (last["drawn"] - before) / (time.perf_counter() - begun)
    page.mouse.up()
    page.close()
    return rate, last["ms"], last["width"]


def report(browser, address, name, condition):
    """Measures and prints."""
    paints = sorted(first_paint(browser, address, name) for _ in range(5))
    rows, counted = filtered(browser, address, name, condition)
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    print(f"first paint of {name}: median {paints[2]:.0f} ms, fastest {paints[0]:.0f} ms")
    print(f"filter {condition}: rows after {rows:.0f} ms, count after {counted:.0f} ms")
    for label, job, field in DRAGS:
        rate, ms, width = drag(browser, address, job, field)
        print(f"drag of {label}: {rate:.1f} frames/s, the last {width} px wide after {ms} ms, load {os.getloadavg()[0]:.1f}")


def main(address, name, condition="frame < 1000"):
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        report(browser, address, name, condition)
        browser.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
