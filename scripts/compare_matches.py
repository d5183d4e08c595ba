"""Correct matches of enhanced pictures, measured by Fathom and by OpenCV's ORB and SIFT; see compare-matches.sh.

Usage: compare_matches.py FATHOM FOLDER [FRAMES]
Appends the values of each frame to FOLDER/values.jsonl, continues there if it was stopped, and writes FOLDER/matches.csv.
"""

from __future__ import annotations

import csv
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

SEEDS = (11, 12, 13)
ENHANCE = [
    "clahe",
    "hscm",
    {"method": "hscm", "name": "hscm-masked", "mask": "paper", "metrics_over": "mask"},
    "fusion",
    "mlle",
    "udcp",
]
PICTURES = ["rgb", "clahe", "hscm", "hscm-masked", "fusion", "mlle", "udcp"]
TITLES = ["raw", "CLAHE", "HSCM", "HSCM, mask", "fusion", "MLLE", "UDCP"]
CORRECT_PX = 3.0
SENSOR = {"sensor": {"preset": "small-pixel-1/2.3", "light_level": 0.1}}
# Two lamps next to the camera, as in examples/train_enhancer.py.
LAMPS = [
    {"kind": "spot", "position_m": [x, -0.3, 0], "intensity": [6, 6, 6], "direction": [0.2 * x, 0.1, 1], "cone_deg": 85}
    for x in (-0.5, 0.5)
]
WATERS = ("jerlov-IB", "jerlov-1C", "jerlov-3C", "jerlov-5C", "jerlov-3C, noise")
SCENES = {
    ("structure", "day"): WATERS,
    ("shaft", "lamps"): WATERS,
    ("structure", "lamps"): ("jerlov-IB", "jerlov-3C"),
    ("pipeline", "lamps"): ("jerlov-IB", "jerlov-3C"),
}


@dataclass(frozen=True)
class Measure:
    """A measured quantity and its summary over the frames of all seeds."""

    title: str
    digits: int = 0
    summarize: Callable[[list[float]], Any] = np.mean


METRICS = {
    "matches_correct_default": Measure("Fathom, `matches_correct_default`"),
    "matches_correct": Measure("Fathom, `matches_correct`"),
    "matches_precision": Measure("Fathom, `matches_precision`", 2),
    "track_length": Measure("Fathom, `track_length`", 2),
    "pose_error_deg": Measure("Fathom, median `pose_error_deg`", 2, np.median),
    "pose_error_m": Measure("Fathom, median `pose_error_m`", 3, np.median),
    "illumination_residual": Measure("Fathom, `illumination_residual`", 2),
}
DETECTORS = {
    "orb": lambda: cv2.ORB_create(nfeatures=1000),
    "orb_2": lambda: cv2.ORB_create(nfeatures=1000, fastThreshold=2),
    "sift": lambda: cv2.SIFT_create(nfeatures=1000),
    "sift_0.004": lambda: cv2.SIFT_create(nfeatures=1000, contrastThreshold=0.004),
}
MEASURES = METRICS | {
    "orb": Measure("OpenCV's ORB, default threshold"),
    "orb_2": Measure("OpenCV's ORB, `fastThreshold` 2"),
    "sift": Measure("OpenCV's SIFT, default threshold"),
    "sift_0.004": Measure("OpenCV's SIFT, `contrastThreshold` 0.004"),
}
Values = dict[str, dict[str, list[float]]]


def list_places() -> dict[str, dict[str, Any]]:
    """Return the fields of a job for each scene, light and water."""
    places: dict[str, dict[str, Any]] = {"structure by day, air": {"scene": {"family": "structure", "lighting": "in_air"}}}
    for (family, light), waters in SCENES.items():
        lights = {"lights": LAMPS, "daylight": "none"} if light == "lamps" else {}
        for water in waters:
            camera = {"camera": SENSOR} if water.endswith("noise") else {}
            fields = {"scene": {"family": family}, "water": {"optics": water.split(",")[0]}}
            places[f"{family} by {light}, {water}"] = fields | lights | camera
    return places


def describe(place: dict[str, Any], seed: int, frames: int) -> dict[str, Any]:
    """Return a job of a path past a scene."""
    camera = {"width": 640, "height": 480, "hfov_deg": 70, "path": {"frames": 96, "sway_m": 0.01}}
    return place | {
        "count": frames,
        "scene": {"kind": "procedural", "seed": seed} | place["scene"],
        "camera": camera | place.get("camera", {}),
        "enhance": ENHANCE,
        "metrics": list(METRICS),
        "artifacts": ["rgb", "flow", *(f"enhanced.{name}" for name in PICTURES[1:]), "enhanced.hscm-masked.mask"],
    }


def read_picture(folder: Path, name: str) -> NDArray[np.uint8]:
    """Return a gray picture."""
    kind = "rgb" if name == "rgb" else f"enhanced.{name}"
    return cv2.imread(str(folder / f"{kind}.png"), cv2.IMREAD_GRAYSCALE)


def count_correct(detector: Any, folders: list[Path], name: str) -> list[float]:
    """Return the cross-checked matches within 3 px of the true position of each pair of neighboring frames."""
    norm = cv2.NORM_HAMMING if detector.descriptorType() == cv2.CV_8U else cv2.NORM_L2
    matcher = cv2.BFMatcher(norm, crossCheck=True)
    counts, before = [], None
    for folder in folders:
        path = folder / "enhanced.hscm-masked.mask.png"
        mask = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) if name == "hscm-masked" else None
        found = detector.detectAndCompute(read_picture(folder, name), mask)
        if before is not None:
            (points, descriptors), (others, other_descriptors), flow = before[0], found, np.load(before[1] / "flow.npy")
            correct = 0
            if descriptors is not None and other_descriptors is not None:
                for match in matcher.match(descriptors, other_descriptors):
                    x, y = points[match.queryIdx].pt
                    dx, dy, visible = flow[min(round(y), flow.shape[0] - 1), min(round(x), flow.shape[1] - 1)]
                    u, v = others[match.trainIdx].pt
                    correct += bool(visible) and (u - x - dx) ** 2 + (v - y - dy) ** 2 <= CORRECT_PX**2
            counts.append(float(correct))
        before = (found, folder)
    return counts


def measure(fathom: str, folder: Path, job: dict[str, Any]) -> Values:
    """Render a job and return the values of its frames by measure and picture."""
    folder.mkdir(parents=True)
    (folder / "job.json").write_text(json.dumps(job))
    out = folder / "frames"
    # One slot keeps the previous frames; several would render them again.
    command = [fathom, "render", folder / "job.json", "--out", out, "--slots", "1"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    records = [json.loads(line)["measurements"] for line in (out / "records.jsonl").read_text().splitlines()]
    folders = sorted((path for path in out.iterdir() if path.is_dir()), key=lambda path: int(path.name))
    values: Values = {
        metric: {name: [record[name][metric] for record in records if metric in record[name]] for name in PICTURES}
        for metric in METRICS
    }
    for key, make in DETECTORS.items():
        values[key] = {name: count_correct(make(), folders, name) for name in PICTURES}
    shutil.rmtree(folder)
    return values


def measure_all(fathom: str, out: Path, frames: int) -> dict[str, list[Values]]:
    """Return the values of each place, one set for each seed, and keep them in a file."""
    kept = out / "values.jsonl"
    known = [json.loads(line) for line in kept.read_text().splitlines()] if kept.exists() else []
    measured = {(row["place"], row["seed"]): row["values"] for row in known}
    places = list_places()
    for seed in SEEDS:
        for place, fields in places.items():
            if (place, seed) in measured:
                continue
            measured[place, seed] = measure(fathom, out / "work", describe(fields, seed, frames))
            with kept.open("a") as file:
                file.write(json.dumps({"place": place, "seed": seed, "values": measured[place, seed]}) + "\n")
            print(f"{place}, seed {seed}", file=sys.stderr, flush=True)
    return {place: [measured[place, seed] for seed in SEEDS] for place in places}


def pool(seeds: list[Values], key: str, picture: str) -> list[float]:
    """Return the values of all frames of all seeds."""
    return [value for values in seeds for value in values[key][picture]]


def print_table(key: str, places: dict[str, list[Values]]) -> None:
    """Print a measure of all places and pictures in Markdown; residuals with the number of frames that define them."""
    kind, is_residual = MEASURES[key], key == "illumination_residual"
    titles = TITLES + (["frames"] if is_residual else [])
    print(f"\n{kind.title}\n\n| place | {' | '.join(titles)} |\n|---|{'---|' * len(titles)}")
    for place, seeds in places.items():
        found = [pool(seeds, key, picture) for picture in PICTURES]
        cells = [f"{kind.summarize(values):.{kind.digits}f}" if values else "–" for values in found]
        cells += [str(len(found[0]))] if is_residual else []
        print(f"| {place} | {' | '.join(cells)} |")


def print_gains(key: str, places: dict[str, list[Values]], picture: str, base: str) -> None:
    """Print the change of the mean from one picture to another: of all frames, and the range over the seeds."""
    print(f"\n{MEASURES[key].title}, {picture} against {base}\n\n| place | all | lowest seed | highest seed |\n|---|---|---|---|")
    for place, seeds in places.items():
        changes = []
        for chosen in (seeds, *([values] for values in seeds)):
            before, after = (np.mean(pool(chosen, key, name)) for name in (base, picture))
            changes.append(100 * (after / before - 1) if before else np.inf)
        print(f"| {place} | {changes[0]:+.0f} % | {min(changes[1:]):+.0f} % | {max(changes[1:]):+.0f} % |")


def write_csv(path: Path, places: dict[str, list[Values]]) -> None:
    """Write the summary of each measure, place and picture, of all seeds and of each."""
    with path.open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["measure", "place", "picture", "values", "summary", *(f"seed_{seed}" for seed in SEEDS)])
        for key, kind in MEASURES.items():
            for place, seeds in places.items():
                for picture in PICTURES:
                    groups = [pool(seeds, key, picture), *(values[key][picture] for values in seeds)]
                    cells = [f"{kind.summarize(group):.4g}" if group else "" for group in groups]
                    rows.writerow([key, place, picture, len(groups[0]), *cells])


def main() -> None:
    """Measure all places, write the table of values and print Markdown."""
    fathom, out = sys.argv[1], Path(sys.argv[2])
    frames = int(sys.argv[3]) if len(sys.argv) > 3 else 6
    out.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(out / "work", ignore_errors=True)
    places = measure_all(fathom, out, frames)
    write_csv(out / "matches.csv", places)
    for key in MEASURES:
        print_table(key, places)
    for key in ("matches_correct", "orb_2", "sift_0.004"):
        print_gains(key, places, "hscm", "rgb")
    for key in ("matches_correct_default", "matches_correct", "orb", "orb_2", "sift", "sift_0.004"):
        print_gains(key, places, "hscm-masked", "hscm")


if __name__ == "__main__":
    main()
