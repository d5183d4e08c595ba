"""Measures a job whose workers and service are killed, and draws the finished frames over time for docs/guide/operations.md.

    FATHOM=target/release/fathom python tests/docs/draw_operations.py target/docs/operations docs/pictures/operations.svg
"""

import json
import os
import pathlib
import subprocess
import sys
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
FATHOM = pathlib.Path(os.environ.get("FATHOM", ROOT / "target/release/fathom")).resolve()
ADDRESS = "127.0.0.1:7467"
JOB = {
    "dataset": "operations", "count": 210, "seed": 1, "site": "tank",
    "camera": {"width": 192, "height": 123}, "artifacts": ["rgb", "range"],
}  # fmt: skip
# Seconds and events.
EVENTS = [(5, "worker B starts"), (12, "worker A is killed"), (18, "the service is killed"), (22, "the service starts again")]
WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 900, 420, 70, 60, 60, 30


def start(*arguments: object) -> subprocess.Popen:
    """Start a process of the program."""
    return subprocess.Popen([FATHOM, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def request(path: str, body: bytes | None = None) -> dict | None:
    """Return the response of the service, none while there is no service."""
    headers = {"Content-Type": "application/json"} if body else {}
    try:
        with urllib.request.urlopen(urllib.request.Request(f"http://{ADDRESS}{path}", body, headers), timeout=5) as response:
            return json.loads(response.read())
    except OSError:
        return None


def measure(work: pathlib.Path) -> tuple[list[tuple[float, int]], str]:
    """Return the finished frames over time and the digest of the job."""
    serve = ("serve", "--data", work / "data", "--listen", ADDRESS, "--workers", 0)
    worker = ("worker", "--server", f"http://{ADDRESS}", "--slots", 1, "--name")
    service = start(*serve)
    job = None
    while not job:
        time.sleep(0.1)
        job = request("/v1/jobs", json.dumps(JOB).encode())
    workers = [start(*worker, "a")]
    began = time.monotonic()
    events = dict(EVENTS)
    points = [(0.0, 0)]
    while True:
        seconds = time.monotonic() - began
        for due in [second for second in events if second <= seconds]:
            event = events.pop(due)
            if event.startswith("worker B"):
                workers.append(start(*worker, "b"))
            elif event.startswith("worker A"):
                workers[0].kill()
            elif event.endswith("killed"):
                service.kill()
            else:
                service = start(*serve)
        state = request(f"/v1/jobs/{job['id']}")
        if state:
            points.append((seconds, state["done"]))
        if state and state["state"] == "done":
            break
        time.sleep(0.2)
    for process in [*workers, service]:
        process.kill()
        process.wait()
    return points, state["digest"]


def draw(points: list[tuple[float, int]], target: pathlib.Path) -> None:
    """Write the chart as SVG."""
    last, frames = points[-1][0] * 1.04, JOB["count"]
    x = lambda seconds: LEFT + seconds / last * (WIDTH - LEFT - RIGHT)  # noqa: E731
    y = lambda done: HEIGHT - BOTTOM - done / frames * (HEIGHT - BOTTOM - TOP)  # noqa: E731
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="13">']
    parts.append(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>')
    for done in range(0, frames + 1, 30):
        parts.append(f'<path d="M{LEFT} {y(done):.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>')
        parts.append(f'<text x="{LEFT - 8}" y="{y(done) + 4:.1f}" text-anchor="end">{done}</text>')
    for seconds in range(0, int(last) + 1, 5):
        parts.append(f'<text x="{x(seconds):.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{seconds}</text>')
    for number, (seconds, event) in enumerate(EVENTS):
        parts.append(f'<path d="M{x(seconds):.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#b33" stroke-dasharray="4 3"/>')
        parts.append(f'<text x="{x(seconds):.1f}" y="{TOP - 32 + 18 * (number % 2)}" fill="#b33">{event}</text>')
    line = " ".join(f"{x(seconds):.1f},{y(done):.1f}" for seconds, done in points)
    parts.append(f'<polyline points="{line}" fill="none" stroke="#1f6fb4" stroke-width="2.5"/>')
    parts.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 16}" text-anchor="middle">seconds</text>')
    parts.append(f'<text x="18" y="{HEIGHT / 2}" transform="rotate(-90 18 {HEIGHT / 2})" text-anchor="middle">finished frames</text>')
    target.write_text("\n".join([*parts, "</svg>", ""]))


def main() -> None:
    """Measure, compare the digest with that of an undisturbed render, and draw."""
    work = pathlib.Path(sys.argv[1])
    work.mkdir(parents=True)
    (work / "job.json").write_text(json.dumps(JOB))
    points, digest = measure(work)
    printed = subprocess.run([FATHOM, "render", work / "job.json", "--out", work / "frames"], check=True, capture_output=True, text=True).stdout
    print(f"{points[-1][0]:.1f} s, digest {digest}")
    if digest not in printed:
        sys.exit(f"the undisturbed render prints {printed}")
    draw(points, pathlib.Path(sys.argv[2]))


if __name__ == "__main__":
    main()
