"""Trains a network that removes water from pictures, and compares it with classical methods on waters it never saw.

    pip install fathom_datasets-*.whl jax onnx pillow
    python examples/train_enhancer.py [STEPS [FOLDER]]

Pairs of a picture under water and the same scene in air are rendered during training and not stored. Writes the
network, its card and a picture of the comparison. Needs ONNX Runtime: scripts/get-onnxruntime.sh.
"""

import hashlib
import json
import sys
import time
from collections import deque
from collections.abc import Generator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from typing import Any

import fathom
import jax
import jax.numpy as jnp
import numpy as np
from enhancer_network import MULTIPLE, JaxOperations, Weights, apply, export, make_weights
from PIL import Image

# Pictures in a batch, drawn from the latest frames; frames that each step adds to these; frames rendered ahead.
BATCH, POOL, NEW, AHEAD = 8, 512, 2, 8
LEARNING_RATE = 2e-3
SSIM_WEIGHT = 0.3
LAMPS = [
    {"kind": "spot", "position_m": [x, -0.3, 0], "intensity": [6, 6, 6], "direction": [0.2 * x, 0.1, 1], "cone_deg": 85}
    for x in (-0.5, 0.5)
]
RANGE_SCALE = {"uniform": [0.1, 0.6]}
TRAINING = {
    "seed": 1,
    "count": 1_000_000,
    "site": {"choice": [{"name": "day"}, {"name": "night", "lights": LAMPS}]},
    "scene": {
        "kind": "procedural",
        "family": {"choice": ["structure", "shaft", "pipeline"]},
        "seed": {"int": [0, 9999]},
    },
    "camera": {"width": 128, "height": 96, "hfov_deg": {"uniform": [25, 75]}},
    "water": {
        "optics": {"choice": ["jerlov-IB", "jerlov-II", "jerlov-1C", "jerlov-5C"]},
        "range_scale": RANGE_SCALE,
    },
    "fidelity": {"tolerance": 0.01},
}

# Held-out frames: scenes of other seeds in other waters, six of each kind, halfway along a path. Training has no noise.
NOISE = {"sensor": {"preset": "small-pixel-1/2.3", "light_level": 0.1}}
PLACES: dict[str, dict[str, Any]] = {
    "structure by day, jerlov-3C": {"family": "structure", "optics": "jerlov-3C"},
    "pipeline by lamps, jerlov-3C": {"family": "pipeline", "optics": "jerlov-3C", "lights": LAMPS},
    "shaft by lamps, jerlov-III": {"family": "shaft", "optics": "jerlov-III", "lights": LAMPS},
    "the same at a tenth of the light": {"family": "shaft", "optics": "jerlov-III", "lights": LAMPS, "camera": NOISE},
}
FRAMES, PATH = 6, 96
METHODS = ["hscm", "clahe", "udcp", "fusion"]
METRICS = ["psnr", "ssim", "matches_correct", "matches_precision", "illumination_residual"]


def render_pairs() -> Generator[tuple[np.ndarray, np.ndarray]]:
    """Render pictures under water and in air without end, some ahead of their use: float32 in 0..1, (3, H, W)."""
    frames = fathom.Frames(fathom.Job(TRAINING), kinds=["rgb", "clean"])
    with ThreadPoolExecutor(2) as threads:
        ahead = deque(threads.submit(frames.read, index) for index in range(AHEAD))
        for index in range(AHEAD, len(frames)):
            frame = ahead.popleft().result()
            ahead.append(threads.submit(frames.read, index))
            yield as_planes(frame.rgb), as_planes(frame.clean)


def as_planes(picture: np.ndarray) -> np.ndarray:
    """Return codes (H, W, 3) as float32 in 0..1, (3, H, W)."""
    return picture.transpose(2, 0, 1).astype(np.float32) / 255


def loss(weights: Weights, pictures: jax.Array, clean: jax.Array) -> jax.Array:
    """Return the mean absolute error plus a part of 1 - SSIM, which keeps faint detail (Zhao et al. 2017)."""
    results = apply(JaxOperations(weights), pictures)
    a, b = average_blocks(results), average_blocks(clean)
    covariance = average_blocks(results * clean) - a * b
    variances = average_blocks(results**2) - a**2 + average_blocks(clean**2) - b**2
    ssim = (2 * a * b + 1e-4) * (2 * covariance + 9e-4) / ((a**2 + b**2 + 1e-4) * (variances + 9e-4))
    return jnp.mean(jnp.abs(results - clean)) + SSIM_WEIGHT * (1 - jnp.mean(ssim))


def average_blocks(x: jax.Array) -> jax.Array:
    """Return means over blocks of 8×8 pixels."""
    batch, channels, height, width = x.shape
    return jnp.mean(x.reshape(batch, channels, height // 8, 8, width // 8, 8), (3, 5))


@jax.jit
def step(weights, mean, square, number, rate, pictures, clean):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Take one step of Adam."""
    value, gradient = jax.value_and_grad(loss)(weights, pictures, clean)
    mean = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, mean, gradient)
    square = jax.tree.map(lambda s, g: 0.999 * s + 0.001 * g**2, square, gradient)
    first, second = 1 - 0.9**number, 1 - 0.999**number
    weights = jax.tree.map(lambda w, m, s: w - rate * m / first / (jnp.sqrt(s / second) + 1e-8), weights, mean, square)
    return weights, mean, square, value


def train(steps: int) -> Weights:
    """Train on batches of the latest frames."""
    random = np.random.default_rng(0)
    weights = make_weights(0)
    mean = square = jax.tree.map(jnp.zeros_like, weights)
    pairs = render_pairs()
    pool: deque[tuple[np.ndarray, np.ndarray]] = deque(maxlen=POOL)
    begun, values = time.perf_counter(), []
    for number in range(1, steps + 1):
        pool.extend(islice(pairs, NEW))
        drawn = [pool[index] for index in random.integers(len(pool), size=BATCH)]
        flips = random.choice([1, -1], size=BATCH)
        pictures, clean = (
            np.stack([pair[side][..., ::flip] for pair, flip in zip(drawn, flips, strict=True)]) for side in (0, 1)
        )
        rate = LEARNING_RATE * np.cos(number / steps * np.pi / 2) ** 2
        weights, mean, square, value = step(weights, mean, square, number, rate, pictures, clean)
        values.append(float(value))
        if number % 50 == 0 or number == steps:
            print(f"step {number:4}  loss {np.mean(values[-50:]):.4f}  {time.perf_counter() - begun:.0f} s", flush=True)
    pairs.close()
    return weights


def save(weights: Weights, folder: Path) -> None:
    """Write the network and its card, which make it the enhancer `trained` of this folder."""
    network = export(weights)
    (folder / "trained.onnx").write_bytes(network)
    digest = hashlib.sha256(network).hexdigest()
    card = {"name": "trained", "role": "enhancer", "size": f"multiple of {MULTIPLE}", "sha256": digest}
    (folder / "trained.card.json").write_text(json.dumps(card, indent=1))


def check(weights: Weights, folder: Path) -> None:
    """Print the largest difference between the picture of the enhancer and that of JAX."""
    picture = fathom.render(TRAINING, 0, ["rgb"]).rgb
    enhanced = fathom.enhance(picture, {"method": "onnx", "model": "trained"}, styles=folder)
    expected = np.asarray(apply(JaxOperations(weights), jnp.asarray(as_planes(picture)[None])))[0].transpose(1, 2, 0)
    difference = np.abs(enhanced - np.round(255 * expected.clip(0, 1)))
    print(f"largest difference between ONNX Runtime and JAX: {difference.max():.0f} of 255")


def describe(place: dict[str, Any]) -> dict[str, Any]:
    """Describe paths through scenes that were never trained on, with the methods and metrics to compare."""
    return {
        "seed": 2,
        "count": FRAMES * PATH,
        "scene": {"kind": "procedural", "family": place["family"], "seed": {"int": [10_000, 19_999]}},
        "camera": {"width": 384, "height": 288, "hfov_deg": 70, "path": {"frames": PATH}} | place.get("camera", {}),
        "water": {"optics": place["optics"], "range_scale": RANGE_SCALE},
        "lights": place.get("lights", []),
        "enhance": [*METHODS, {"method": "onnx", "model": "trained", "name": "network"}],
        "metrics": METRICS,
    }


def compare(folder: Path, frames: int) -> None:
    """Print the mean of each metric and draw the first frame of each place."""
    names = ["rgb", *METHODS, "network"]
    rows = []
    for place, fields in PLACES.items():
        job = fathom.Job(describe(fields), styles=folder)
        kinds = ["rgb", "clean", *(f"enhanced.{name}" for name in names[1:])]
        rendered = [fathom.render(job, number * PATH + PATH // 2, kinds) for number in range(frames)]
        rows.append(np.concatenate([rendered[0][kind] for kind in kinds], axis=1))
        print(f"\n{place}\n\n| | {' | '.join(METRICS)} |\n|---|{'---|' * len(METRICS)}")
        for name in names:
            found = [frame.record["measurements"][name] for frame in rendered]
            values = [[one[metric] for one in found if metric in one] for metric in METRICS]
            print(f"| {name} | {' | '.join(f'{np.mean(value):.2f}' if value else '–' for value in values)} |")
    Image.fromarray(np.concatenate(rows)).save(folder / "comparison.png")


def main() -> None:
    """Train, export, and compare."""
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 1500
    folder = Path(sys.argv[2] if len(sys.argv) > 2 else "enhancer")
    folder.mkdir(parents=True, exist_ok=True)
    weights = train(steps)
    save(weights, folder)
    check(weights, folder)
    compare(folder, FRAMES if steps > 1 else 1)


if __name__ == "__main__":
    main()
