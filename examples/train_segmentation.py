"""Trains a small segmentation network on frames that are rendered while it learns, with nothing stored.

    pip install fathom_datasets-*.whl jax
    python examples/train_segmentation.py [STEPS]
"""

import sys
import time

import jax
import jax.numpy as jnp
import numpy as np

import fathom

SIZE = {"width": 96, "height": 64, "hfov_deg": 80}
CLASSES = len(fathom.names()["categories"])
BATCH = 8
job = fathom.Job({
    "seed": 1,
    "count": 1_000_000,
    "scene": {"kind": "procedural", "family": {"choice": ["structure", "shaft", "pipeline"]}, "seed": {"int": [0, 9999]}},
    "camera": SIZE,
    "water": {"optics": {"choice": ["jerlov-IB", "jerlov-1C", "jerlov-3C"]}, "range_scale": {"uniform": [0.1, 0.4]}},
})
frames = fathom.Frames(job, kinds=["rgb", "semantics"])


def batch(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Render the frames of a step: float32 pictures in -1..1, (B, H, W, 3), and classes, (B, H, W)."""
    made = [frames.read(number * BATCH + i) for i in range(BATCH)]
    pictures = np.stack([frame.rgb for frame in made]).astype(np.float32) / 127.5 - 1
    return pictures, np.stack([frame.semantics for frame in made])


def network(weights: list[dict[str, jax.Array]], pictures: jax.Array) -> jax.Array:
    """Apply 3x3 convolutions of growing dilation, so that a pixel sees its surroundings."""
    x = pictures
    for layer, weight in enumerate(weights):
        x = jax.lax.conv_general_dilated(
            x, weight["kernel"], (1, 1), "SAME", rhs_dilation=(2**layer,) * 2, dimension_numbers=("NHWC", "HWIO", "NHWC")
        ) + weight["bias"]
        if layer < len(weights) - 1:
            x = jax.nn.relu(x)
    return x


def loss(weights: list[dict[str, jax.Array]], pictures: jax.Array, classes: jax.Array) -> jax.Array:
    """Return the mean cross entropy."""
    chances = jax.nn.log_softmax(network(weights, pictures))
    return -jnp.mean(jnp.take_along_axis(chances, classes[..., None].astype(int), axis=-1))


@jax.jit
def step(weights, velocity, pictures, classes):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201
    """Take one step down the gradient, with momentum."""
    value, gradient = jax.value_and_grad(loss)(weights, pictures, classes)
    velocity = jax.tree.map(lambda v, g: 0.9 * v - 0.03 * g, velocity, gradient)
    return jax.tree.map(jnp.add, weights, velocity), velocity, value


def main() -> None:
    """Train, and compare the pixels of frames never trained on with the most frequent class."""
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    widths = [3, 16, 16, 16, CLASSES]
    random = np.random.default_rng(0)
    weights = [
        {"kernel": jnp.asarray(random.normal(0, (2 / (9 * a)) ** 0.5, (3, 3, a, b)), jnp.float32), "bias": jnp.zeros(b)}
        for a, b in zip(widths, widths[1:], strict=False)
    ]
    velocity = jax.tree.map(jnp.zeros_like, weights)
    begun = time.perf_counter()
    for number in range(steps):
        weights, velocity, value = step(weights, velocity, *batch(number))
        if number % 20 == 0:
            print(f"step {number:4}  loss {value:.3f}")
    seconds = time.perf_counter() - begun
    print(f"{steps * BATCH} frames in {seconds:.1f} s, none of them stored")
    pictures, classes = batch(10_000)
    right = float(np.mean(np.argmax(network(weights, pictures), axis=-1) == classes))
    usual = float(np.mean(classes == np.bincount(classes.ravel()).argmax()))
    print(f"pixels right on new frames: {right:.2f}; the most frequent class alone: {usual:.2f}")


if __name__ == "__main__":
    main()
