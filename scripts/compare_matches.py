"""Correct matches of enhanced pictures, measured by Fathom and by OpenCV's ORB and SIFT; see compare-matches.sh.

Usage: compare_matches.py FATHOM FOLDER [FRAMES]
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

ENHANCE = [
    "clahe",
    "hscm",
    {"method": "hscm", "name": "hscm-masked", "mask": "paper", "metrics_over": "mask"},
    "fusion",
    "mlle",
    "udcp",
]
PICTURES = ["rgb", "clahe", "hscm", "hscm-masked", "fusion", "mlle", "udcp"]
CORRECT_PX = 3.0
SENSOR = {"camera": {"sensor": {"preset": "small-pixel-1/2.3", "light_level": 0.1}}}
PLACES: dict[str, dict[str, Any]] = {
    "air": {"scene": {"lighting": "in_air"}},
    "jerlov-IB": {"water": {"optics": "jerlov-IB"}},
    "jerlov-1C": {"water": {"optics": "jerlov-1C"}},
    "jerlov-3C": {"water": {"optics": "jerlov-3C"}},
    "jerlov-5C": {"water": {"optics": "jerlov-5C"}},
}
DETECTORS = {
    "ORB, default": lambda: cv2.ORB_create(nfeatures=1000),
    "ORB, threshold 2": lambda: cv2.ORB_create(nfeatures=1000, fastThreshold=2),
    "SIFT, default": lambda: cv2.SIFT_create(nfeatures=1000),
    "SIFT, threshold 0.004": lambda: cv2.SIFT_create(nfeatures=1000, contrastThreshold=0.004),
}


def describe(place: dict[str, Any], frames: int) -> dict[str, Any]:
    """A path past a structure."""
    camera = {"width": 640, "height": 480, "hfov_deg": 70, "path": {"frames": 96, "sway_m": 0.01}}
    scene = {"kind": "procedural", "family": "structure", "seed": 11}
    return {
        "count": frames,
        "scene": scene | place.get("scene", {}),
        "camera": camera | place.get("camera", {}),
        "water": place.get("water", {}),
        "enhance": ENHANCE,
        "metrics": ["features", "features_default", "matches_correct", "matches_correct_default", "illumination_residual"],
        "artifacts": ["rgb", "flow", *(f"enhanced.{name}" for name in PICTURES[1:]), "enhanced.hscm-masked.mask"],
    }


def read_picture(folder: Path, name: str) -> NDArray[np.uint8]:
    """A gray picture."""
    kind = "rgb" if name == "rgb" else f"enhanced.{name}"
    return cv2.imread(str(folder / f"{kind}.png"), cv2.IMREAD_GRAYSCALE)


def count_correct(detector: Any, folders: list[Path], name: str) -> float:
    """Cross-checked matches within 3 px of the true position, mean of all neighboring pairs."""
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
            counts.append(correct)
        before = (found, folder)
    return float(np.mean(counts))


def mean_metric(records: list[dict[str, Any]], name: str, metric: str) -> float:
    """The mean of a metric over the frames that have it; NaN if none has."""
    values = [record["measurements"][name][metric] for record in records if metric in record["measurements"][name]]
    return float(np.mean(values)) if values else float("nan")


def main() -> None:
    """Renders each place and prints the tables in Markdown."""
    fathom, out = sys.argv[1], Path(sys.argv[2])
    frames = int(sys.argv[3]) if len(sys.argv) > 3 else 12
    rows: dict[str, dict[str, list[float]]] = {}
    for place, fields in (PLACES | {"jerlov-3C, noise": PLACES["jerlov-3C"] | SENSOR}).items():
        folder = out / place.replace(", ", "-")
        job = folder.with_suffix(".json")
        job.parent.mkdir(parents=True, exist_ok=True)
        job.write_text(json.dumps(describe(fields, frames)))
        subprocess.run([fathom, "render", job, "--out", folder], check=True, stdout=subprocess.DEVNULL)
        lines = (folder / "records.jsonl").read_text().splitlines()
        records = [json.loads(line) for line in lines]
        folders = sorted((path for path in folder.iterdir() if path.is_dir()), key=lambda path: int(path.name))
        for metric in ["matches_correct", "matches_correct_default", "illumination_residual"]:
            values = [mean_metric(records, name, metric) for name in PICTURES]
            rows.setdefault(f"Fathom, `{metric}`", {})[place] = values
        for name, make in DETECTORS.items():
            rows.setdefault(f"OpenCV's {name}", {})[place] = [count_correct(make(), folders, kind) for kind in PICTURES]
    for title, places in rows.items():
        digits = 2 if "residual" in title else 0
        print(f"\n{title}\n\n| place | {' | '.join(PICTURES)} |\n|---|{'---|' * len(PICTURES)}")
        for place, values in places.items():
            cells = ("–" if np.isnan(value) else f"{value:.{digits}f}" for value in values)
            print(f"| {place} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
