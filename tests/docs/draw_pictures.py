"""Draws pictures of the guide from the output of the program: enhancement, uploaded, exports, cluster.

    pip install pillow numpy pycocotools
    FATHOM=target/release/fathom python tests/docs/draw_pictures.py target/docs/guide [NAME…]
    python scripts/write_webp.py target/docs/guide/exports.png docs/pictures/exports.webp
"""

import colorsys
import json
import os
import pathlib
import subprocess
import sys
import tarfile
import time
import urllib.request

import numpy
from PIL import Image, ImageDraw, ImageFont
from pycocotools.coco import COCO

ROOT = pathlib.Path(__file__).resolve().parents[2]
FATHOM = pathlib.Path(os.environ.get("FATHOM", ROOT / "target/release/fathom")).resolve()
# Height of the line of text above a picture, and the gap between pictures, in pixels.
TITLE = 22
GAP = 4
# Fewest pixels of an object whose box is drawn.
MIN_AREA = 250
SERVER = "http://127.0.0.1:7466"


def run_fathom(*arguments: object) -> str:
    """Run a command and return its output."""
    environment = os.environ | {"FATHOM_SERVER": SERVER}
    return subprocess.run([FATHOM, *map(str, arguments)], check=True, capture_output=True, text=True, env=environment).stdout


def render(work: pathlib.Path, name: str, job: dict) -> pathlib.Path:
    """Render a job into a folder and return it."""
    (work / f"{name}.json").write_text(json.dumps(job))
    run_fathom("render", work / f"{name}.json", "--out", work / name)
    return work / name


def draw_grid(rows: list[list[Image.Image]], titles: list[list[str]], target: pathlib.Path) -> None:
    """Write rows of pictures of one size, each below its titles, if it has any."""
    width, height = rows[0][0].size
    tops = [TITLE if row else 0 for row in titles]
    grid = Image.new("RGB", (len(rows[0]) * (width + GAP) - GAP, sum(tops) + len(rows) * (height + GAP) - GAP), "white")
    draw = ImageDraw.Draw(grid)
    y = 0
    for pictures, names, top in zip(rows, titles, tops, strict=True):
        for column, picture in enumerate(pictures):
            grid.paste(picture.convert("RGB"), (column * (width + GAP), y + top))
        for column, name in enumerate(names):
            draw.text((column * (width + GAP) + 2, y + 2), name, fill="black", font=ImageFont.load_default(15))
        y += top + height + GAP
    grid.save(target)


def color_number(number: int) -> tuple[int, int, int]:
    """Return a color for a number; neighbors differ in hue."""
    red, green, blue = colorsys.hsv_to_rgb(number * 0.618 % 1, 0.75, 0.95)
    return int(255 * red), int(255 * green), int(255 * blue)


def draw_range(path: pathlib.Path) -> Image.Image:
    """Return a range in gray on a logarithmic scale, near is bright, black is no return."""
    meters = numpy.asarray(Image.open(path)).astype(float) / 1000
    seen = meters > 0
    low, high = numpy.log(meters[seen].min()), numpy.log(meters[seen].max())
    gray = numpy.zeros(meters.shape)
    gray[seen] = 255 - 215 * (numpy.log(meters[seen]) - low) / (high - low)
    return Image.fromarray(gray.astype(numpy.uint8))


def draw_numbers(path: pathlib.Path) -> Image.Image:
    """Return a mask with a color for each number."""
    numbers = numpy.asarray(Image.open(path))
    colors = numpy.zeros((*numbers.shape, 3), numpy.uint8)
    for number in numpy.unique(numbers[numbers > 0]):
        colors[numbers == number] = color_number(int(number))
    return Image.fromarray(colors)


def draw_enhancement(work: pathlib.Path) -> None:
    """Two frames, enhanced by two methods, next to the scene in air."""
    rows = []
    for site, seed in (("harbour-wall", 5), ("pipeline", 3)):
        job = {
            "site": site, "seed": seed, "camera": {"width": 384, "height": 246},
            "enhance": ["hscm", "clahe"], "artifacts": ["rgb", "enhanced.hscm", "enhanced.clahe", "clean"],
        }  # fmt: skip
        folder = render(work, f"enhance-{site}", job) / "0"
        rows.append([Image.open(folder / f"{kind}.png") for kind in ("rgb", "enhanced.hscm", "enhanced.clahe", "clean")])
    draw_grid(rows, [["rgb", "enhanced.hscm", "enhanced.clahe", "clean: the scene in air"], []], work / "enhancement.png")


def draw_uploaded(work: pathlib.Path) -> None:
    """The sample picture with its range and mask, and frames of it in three waters."""
    sample = ROOT / "examples/pile"
    waters = {"jerlov-IB": 1, "jerlov-1C": 1, "jerlov-3C": 0.4}
    frames = []
    for water, scale in waters.items():
        job = {
            "scene": {"kind": "files", "rgb": str(sample / "pile.jpg"), "range": str(sample / "pile.range.png"), "unit_m": 0.001, "invalid_code": 0},
            "camera": {"hfov_deg": 75}, "water": {"optics": water, "range_scale": scale},
        }  # fmt: skip
        frames.append(Image.open(render(work, f"uploaded-{water}", job) / "0/rgb.png"))
    inputs = [Image.open(sample / "pile.jpg"), draw_range(sample / "pile.range.png"), draw_numbers(sample / "pile.instances.png")]
    titles = [["picture", "range", "instances"], ["jerlov-IB", "jerlov-1C", "jerlov-3C with range_scale 0.4"]]
    draw_grid([inputs, frames], titles, work / "uploaded.png")


def export_labels(work: pathlib.Path) -> pathlib.Path:
    """Export the example with labels as COCO from a temporary service, and return the folder."""
    command = [FATHOM, "serve", "--data", work / "data", "--listen", SERVER.removeprefix("http://")]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as service:
        try:
            for _ in range(100):
                try:
                    urllib.request.urlopen(f"{SERVER}/readyz")
                    break
                except OSError:
                    time.sleep(0.1)
            run_fathom("submit", ROOT / "examples/labels.json", "--wait")
            run_fathom("export", "labels", "--format", "coco", "--kinds", "rgb,range,instances", "--out", work / "coco")
        finally:
            service.terminate()
    return work / "coco"


def draw_annotations(coco: COCO, image: dict, picture: Image.Image) -> tuple[Image.Image, Image.Image]:
    """Return a picture with the boxes of its larger objects, and its masks over the darkened picture."""
    names = {category["id"]: category["name"] for category in coco.dataset["categories"]}
    boxes, masks = picture.copy(), numpy.asarray(picture.convert("L").convert("RGB")) // 2
    draw = ImageDraw.Draw(boxes)
    font = ImageFont.load_default(12)
    annotations = coco.loadAnns(coco.getAnnIds(image["id"]))
    for annotation in sorted(annotations, key=lambda annotation: -annotation["area"]):
        masks[coco.annToMask(annotation) > 0] = color_number(annotation["id"])
        if annotation["area"] >= MIN_AREA:
            color = color_number(annotation["category_id"])
            x, y, width, height = annotation["bbox"]
            draw.rectangle((x, y, x + width - 1, y + height - 1), outline=color, width=2)
            draw.text((x + 4, y + 3), names[annotation["category_id"]], fill=color, font=font, stroke_width=1, stroke_fill="black")
    return boxes, Image.fromarray(masks)


def draw_exports(work: pathlib.Path) -> None:
    """A frame of two sites of an export, with the boxes and masks that pycocotools reads from it."""
    folder = export_labels(work)
    coco = COCO(str(folder / "annotations.json"))
    lines = [json.loads(line) for line in (folder / "metadata.jsonl").read_text().splitlines()]
    sites = {line["file_name"]: line["site"] for line in lines}
    rows = []
    for site in ("pipeline", "pile-in-current"):
        image = next(image for image in coco.dataset["images"] if sites[image["file_name"]] == site)
        path = folder / image["file_name"]
        picture = Image.open(path).convert("RGB")
        rows.append([picture, *draw_annotations(coco, image, picture), draw_range(path.parent / "range.png")])
    draw_grid(rows, [["rgb", "bbox", "segmentation", "range"], []], work / "exports.png")


def draw_cluster(work: pathlib.Path) -> None:
    """The frames of a sharded dataset by shard, framed in the color of the process that rendered the shard."""
    job = {"dataset": "reef", "count": 40, "seed": 1, "site": "harbour-wall", "camera": {"width": 192, "height": 128}, "artifacts": ["rgb"]}
    (work / "reef.json").write_text(json.dumps(job))
    parts = [
        subprocess.Popen([FATHOM, "render", work / "reef.json", "--out", work / "reef", "--frames-per-shard", "8", "--shard", f"{part}/3"])
        for part in range(3)
    ]
    if any(part.wait() for part in parts):
        sys.exit("a process failed")
    rows = []
    for shard, tar in enumerate(sorted((work / "reef/shards").glob("*.tar"))):
        color = color_number(shard % 3 + 1)
        rows.append([add_border(picture, color) for picture in read_tar(tar)])
    titles = [[f"shard {shard}, rendered by process {shard % 3}"] for shard in range(len(rows))]
    draw_grid(rows, titles, work / "cluster.png")


def read_tar(path: pathlib.Path) -> list[Image.Image]:
    """Return the pictures of a shard in the order of its frames."""
    with tarfile.open(path) as tar:
        names = sorted(name for name in tar.getnames() if name.endswith(".rgb.png"))
        return [Image.open(tar.extractfile(name)).convert("RGB") for name in names]


def add_border(picture: Image.Image, color: tuple[int, int, int]) -> Image.Image:
    """Return the picture with a border of a color."""
    ImageDraw.Draw(picture).rectangle((0, 0, picture.width - 1, picture.height - 1), outline=color, width=5)
    return picture


DRAWERS = {"enhancement": draw_enhancement, "uploaded": draw_uploaded, "exports": draw_exports, "cluster": draw_cluster}


def main() -> None:
    """Draw the pictures with these names, or all."""
    work = pathlib.Path(sys.argv[1])
    work.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or DRAWERS:
        DRAWERS[name](work)


if __name__ == "__main__":
    main()
