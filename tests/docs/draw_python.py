"""Draws pictures of the guide from Python: a notebook, a recording and a stream. Needs the wheel.

    pip install pillow numpy pycocotools httpx 'rosbags>=0.11.9,<0.12'
    FATHOM=target/release/fathom python tests/docs/draw_python.py target/docs/python [NAME…]
    python scripts/write_webp.py target/docs/python/notebook.png docs/pictures/notebook.webp

The notebook is drawn by Chromium, which CHROMIUM names.
"""

import html
import json
import os
import pathlib
import subprocess
import sys
import time

import fathom
import numpy
from draw_pictures import FATHOM, ROOT, draw_grid, draw_range
from PIL import Image

ADDRESS = "127.0.0.1:7468"
CHROMIUM = os.environ.get("CHROMIUM", "/usr/bin/chromium")
SIZE = (320, 216)
HFOV_DEG = 80
STYLE = """<meta charset="utf-8"><style>
body { margin: 16px; width: 968px; font: 14px sans-serif; background: #fff }
pre { margin: 0 0 8px; padding: 8px 10px; background: #f4f4f4; border-left: 3px solid #4a7; font: 13px monospace }
.out { margin: 0 0 14px 14px } table { border-collapse: collapse; font-size: 13px } caption { text-align: left; padding: 4px 8px; font-weight: bold }
td, th { padding: 2px 8px } tr:nth-child(odd) { background: #f6f8fa } .out > div { display: flex; gap: 16px; align-items: center }
</style>"""


def draw_notebook(work: pathlib.Path) -> None:
    """The parts of a client as a notebook shows them."""
    command = [FATHOM, "serve", "--data", work / "data", "--listen", ADDRESS]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as service:
        time.sleep(3)
        try:
            cells = list(run_cells(fathom.Client(f"http://{ADDRESS}")))
        finally:
            service.terminate()
    text = STYLE + "".join(f'<pre>{html.escape(code)}</pre><div class="out">{shown}</div>' for code, shown in cells)
    (work / "notebook.html").write_text(text)
    target = work / "notebook.png"
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1000,1000"]
    subprocess.run([CHROMIUM, *options, f"--screenshot={target}", (work / "notebook.html").as_uri()], check=True, capture_output=True)
    crop_below(Image.open(target).convert("RGB")).save(target)


def run_cells(client: fathom.Client):
    """Yield the code and the output of each cell."""
    job = client.submit(ROOT / "examples/labels.json").wait(progress=False)
    yield 'job = client.submit("examples/labels.json").wait()\njob', job._repr_html_()
    rows = client.images("uiqm > 0.5", dataset="labels", order_by="-uiqm", limit=6)
    yield 'rows = client.images("uiqm > 0.5", dataset="labels", order_by="-uiqm", limit=6)\nrows', rows._repr_html_()
    frame = next(client.frames(rows, ["rgb", "range", "instances", "boxes"]))
    yield 'next(client.frames(rows, ["rgb", "range", "instances", "boxes"]))', frame._repr_html_()


def crop_below(picture: Image.Image) -> Image.Image:
    """Return the picture without the white rows at its end."""
    used = numpy.flatnonzero((numpy.asarray(picture) < 250).any(axis=(1, 2)))
    return picture.crop((0, 0, picture.width, int(used[-1]) + 12))


def render_air(seed: int, frames: int) -> list[fathom.Frame]:
    """Return pictures in air along a path, with their range."""
    scene = {"kind": "procedural", "family": "structure", "seed": seed, "lighting": "in_air"}
    camera = {"width": SIZE[0], "height": SIZE[1], "hfov_deg": HFOV_DEG, "path": {"frames": frames}}
    job = {"scene": scene, "camera": camera, "count": frames}
    return [fathom.render(job, frame, ["rgb", "range"]) for frame in range(frames)]


def show_range(work: pathlib.Path, meters: numpy.ndarray) -> Image.Image:
    """Return a range in gray, near is bright."""
    Image.fromarray(numpy.nan_to_num(meters * 1000).astype(numpy.uint16)).save(work / "range.png")
    return draw_range(work / "range.png")


def draw_stream(work: pathlib.Path) -> None:
    """Four pictures of a moving camera, their range, and both results of a stream."""
    job = {
        "seed": 3, "water": {"optics": "jerlov-3C", "range_scale": 0.35, "depth_m": 3, "snow": {"density_per_m3": 150}}, "enhance": ["hscm"],
    }  # fmt: skip
    stream = fathom.Stream(job)
    rows: list[list[Image.Image]] = [[], [], [], []]
    for number, air in enumerate(render_air(4, 40)[::13]):
        out = stream(air.rgb, range_m=air.range_m, stamp_ns=number * 10**9)
        shown = [air.rgb, None, out.rgb, out.enhanced["hscm"]]
        for row, array in zip(rows, shown, strict=True):
            row.append(show_range(work, air.range_m) if array is None else Image.fromarray(array))
    draw_grid(rows, [["in: rgb"], ["in: range_m"], ["out: rgb"], ['out: enhanced["hscm"]']], work / "stream.png")


def write_recording(path: pathlib.Path, frames: list[fathom.Frame]) -> None:
    """Write pictures and depths as a ROS 2 recording."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    image_type, header_type, time_type = (
        store.types[name] for name in ("sensor_msgs/msg/Image", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    width, height = SIZE
    x, y = numpy.meshgrid(numpy.arange(width) - (width - 1) / 2, numpy.arange(height) - (height - 1) / 2)
    focal_px = width / 2 / numpy.tan(numpy.radians(HFOV_DEG / 2))
    ray = numpy.sqrt(1 + (x / focal_px) ** 2 + (y / focal_px) ** 2)
    with Writer(path, version=8, storage_plugin=StoragePlugin.MCAP) as writer:
        names = ("/camera/image_raw", "/camera/depth")
        topics = [writer.add_connection(name, image_type.__msgtype__, typestore=store) for name in names]
        for number, frame in enumerate(frames):
            header = header_type(stamp=time_type(sec=1_700_000_000 + number, nanosec=0), frame_id="camera")
            depth = (frame.range_m / ray).astype(numpy.float32)
            for topic, encoding, array in zip(topics, ("rgb8", "32FC1"), (frame.rgb, depth), strict=True):
                data = numpy.ascontiguousarray(array).reshape(-1).view(numpy.uint8)
                message = image_type(
                    header=header, height=height, width=width, encoding=encoding, is_bigendian=0, step=data.size // height, data=data
                )
                writer.write(topic, header.stamp.sec * 10**9, store.serialize_cdr(message, image_type.__msgtype__))


def read_pictures(path: pathlib.Path, topic: str) -> list[Image.Image]:
    """Return the pictures of a topic."""
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as reader:
        wanted = [connection for connection in reader.connections if connection.topic == topic]
        messages = [reader.deserialize(raw, connection.msgtype) for connection, _, raw in reader.messages(wanted)]
    return [Image.fromarray(message.data.reshape(message.height, message.width, 3)) for message in messages]


def draw_recording(work: pathlib.Path) -> None:
    """Four pictures of a recording, and the topics that the command adds."""
    dry, wet, job = work / "dive", work / "wet.mcap", work / "job.json"
    subprocess.run(["rm", "-rf", dry, wet], check=True)
    write_recording(dry, render_air(11, 40)[::13])
    lamp = {"kind": "spot", "position_m": [0.4, -0.4, 0], "intensity": [6, 6, 6], "direction": [-0.1, 0.1, 1], "cone_deg": 60}
    water = {"optics": "jerlov-IB", "range_scale": 2, "depth_m": 10, "snow": {"density_per_m3": 100}}
    job.write_text(json.dumps({"seed": 2, "water": water, "lights": [lamp], "camera": {"hfov_deg": HFOV_DEG}, "enhance": ["hscm"]}))
    command = [sys.executable, "-m", "fathom", "bag", dry, wet, "--job", job, "--image", "/camera/image_raw", "--depth", "/camera/depth"]
    subprocess.run([str(word) for word in command], check=True)
    topics = ["/camera/image_raw", "/camera/image_raw/underwater", "/camera/image_raw/enhanced/hscm/underwater"]
    draw_grid([read_pictures(wet, topic) for topic in topics], [[topic] for topic in topics], work / "recording.png")


DRAWERS = {"notebook": draw_notebook, "recording": draw_recording, "stream": draw_stream}


def main() -> None:
    """Draw the pictures with these names, or all."""
    work = pathlib.Path(sys.argv[1])
    work.mkdir(parents=True, exist_ok=True)
    work = work.resolve()
    for name in sys.argv[2:] or DRAWERS:
        DRAWERS[name](work)


if __name__ == "__main__":
    main()
