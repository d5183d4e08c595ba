"""A small network that removes water from pictures, written once and run both in JAX and as ONNX."""

# ruff: noqa: D102 - `Operations` describes the methods of both classes.

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Protocol, TypeVar

import jax
import jax.numpy as jnp
import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

Weights = dict[str, tuple[jax.Array, jax.Array]]
T = TypeVar("T")

# Channels at 1/2, 1/4, 1/8 and 1/16 of the size of the picture.
WIDTHS = (24, 32, 48, 64)
MULTIPLE = 2 ** len(WIDTHS)
EPSILON = 1e-3
LEAK = 0.1
OPSET = 17


class Operations(Protocol[T]):
    """The operations of the network on tensors (batch, channels, height, width)."""

    def conv(self, name: str, x: T, stride: int = 1) -> T:
        """Convolve with the kernel and bias of this name."""

    def relu(self, x: T) -> T:
        """Multiply negative values by `LEAK`."""

    def normalize(self, x: T) -> T:
        """Bring each channel of a picture to mean 0 and variance 1."""

    def average(self, x: T) -> T:
        """Return the mean of each channel, of size 1×1."""

    def double(self, x: T) -> T:
        """Double height and width by linear interpolation."""

    def concat(self, a: T, b: T) -> T:
        """Stack channels."""

    def split(self, x: T, parts: int) -> Sequence[T]:
        """Cut the channels into equal parts."""

    def add(self, a: T, b: T) -> T:
        """Add with broadcasting."""

    def multiply(self, a: T, b: T) -> T:
        """Multiply with broadcasting."""


def apply(ops: Operations[T], picture: T) -> T:
    """Return the picture without water, sRGB codes in 0..1 like the input.

    An encoder and decoder at 1/2 to 1/16 of the size predict an affine color map for each pixel. It is applied at full
    size to the picture with mean and contrast normalized, so that faint detail is amplified and not blurred.
    """
    stretched = ops.normalize(picture)
    x = ops.concat(picture, stretched)
    skips = []
    for level in range(len(WIDTHS)):
        x = ops.relu(ops.conv(f"down{level}", x, 2))
        skips.append(x)
    x = ops.relu(ops.conv("middle", x))
    x = ops.add(x, ops.average(x))
    for level in reversed(range(len(WIDTHS) - 1)):
        x = ops.add(ops.double(ops.conv(f"narrow{level}", x)), skips[level])
        x = ops.relu(ops.conv(f"up{level}", x))
    *columns, result = ops.split(ops.double(ops.conv("color", x)), 4)
    for column, channel in zip(columns, ops.split(stretched, 3), strict=True):
        result = ops.add(result, ops.multiply(column, channel))
    return result


def make_weights(seed: int) -> Weights:
    """Draw initial weights. Those of `color` give every channel the mean 0.4 and the standard deviation 0.2."""
    random = np.random.default_rng(seed)
    last = WIDTHS[-1]
    shapes = {f"down{level}": (b, a, 3) for level, (a, b) in enumerate(pairwise((6, *WIDTHS)))}
    shapes |= {"middle": (last, last, 3), "color": (12, WIDTHS[0], 3)}
    shapes |= {f"narrow{level}": (a, b, 1) for level, (a, b) in enumerate(pairwise(WIDTHS))}
    shapes |= {f"up{level}": (width, width, 3) for level, width in enumerate(WIDTHS[:-1])}
    weights = {}
    for name, (outputs, inputs, side) in shapes.items():
        scale = 0.0 if name == "color" else (2 / (inputs * side**2)) ** 0.5
        kernel = random.normal(0, scale, (outputs, inputs, side, side))
        bias = [*0.2 * np.eye(3).ravel(), 0.4, 0.4, 0.4] if name == "color" else np.zeros(outputs)
        weights[name] = (jnp.asarray(kernel, jnp.float32), jnp.asarray(bias, jnp.float32))
    return weights


class JaxOperations:
    """The operations on arrays of JAX."""

    def __init__(self, weights: Weights) -> None:
        self.weights = weights

    def conv(self, name: str, x: jax.Array, stride: int = 1) -> jax.Array:
        kernel, bias = self.weights[name]
        pad = kernel.shape[-1] // 2
        result: jax.Array = jax.lax.conv_general_dilated(x, kernel, (stride,) * 2, [(pad, pad)] * 2)
        return result + bias[:, None, None]

    def relu(self, x: jax.Array) -> jax.Array:
        return jnp.maximum(x, LEAK * x)

    def normalize(self, x: jax.Array) -> jax.Array:
        return (x - self.average(x)) / jnp.sqrt(jnp.var(x, (2, 3), keepdims=True) + EPSILON)

    def average(self, x: jax.Array) -> jax.Array:
        return jnp.mean(x, (2, 3), keepdims=True)

    def double(self, x: jax.Array) -> jax.Array:
        result: jax.Array = jax.image.resize(x, (*x.shape[:2], 2 * x.shape[2], 2 * x.shape[3]), "linear")
        return result

    def concat(self, a: jax.Array, b: jax.Array) -> jax.Array:
        return jnp.concatenate([a, b], 1)

    def split(self, x: jax.Array, parts: int) -> list[jax.Array]:
        return jnp.split(x, parts, 1)

    def add(self, a: jax.Array, b: jax.Array) -> jax.Array:
        return a + b

    def multiply(self, a: jax.Array, b: jax.Array) -> jax.Array:
        return a * b


class OnnxOperations:
    """The operations as nodes of an ONNX graph; a tensor is its name."""

    def __init__(self, weights: Weights) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: dict[str, np.ndarray] = {
            "ones": np.ones(3, np.float32),
            "zeros": np.zeros(3, np.float32),
            "scales": np.array([1, 1, 2, 2], np.float32),
        }
        for name, (kernel, bias) in weights.items():
            self.constants |= {f"{name}.kernel": np.asarray(kernel), f"{name}.bias": np.asarray(bias)}

    def node(self, kind: str, *inputs: str, outputs: int = 1, **attributes: Any) -> list[str]:
        names = [f"{kind}_{len(self.nodes)}_{part}" for part in range(outputs)]
        self.nodes.append(helper.make_node(kind, inputs, names, **attributes))
        return names

    def conv(self, name: str, x: str, stride: int = 1) -> str:
        pad = self.constants[f"{name}.kernel"].shape[-1] // 2
        return self.node("Conv", x, f"{name}.kernel", f"{name}.bias", strides=[stride] * 2, pads=[pad] * 4)[0]

    def relu(self, x: str) -> str:
        return self.node("LeakyRelu", x, alpha=LEAK)[0]

    def normalize(self, x: str) -> str:
        return self.node("InstanceNormalization", x, "ones", "zeros", epsilon=EPSILON)[0]

    def average(self, x: str) -> str:
        return self.node("GlobalAveragePool", x)[0]

    def double(self, x: str) -> str:
        return self.node("Resize", x, "", "scales", mode="linear")[0]

    def concat(self, a: str, b: str) -> str:
        return self.node("Concat", a, b, axis=1)[0]

    def split(self, x: str, parts: int) -> list[str]:
        return self.node("Split", x, outputs=parts, axis=1)

    def add(self, a: str, b: str) -> str:
        return self.node("Add", a, b)[0]

    def multiply(self, a: str, b: str) -> str:
        return self.node("Mul", a, b)[0]


def export(weights: Weights) -> bytes:
    """Return the network as an ONNX file. Height and width are multiples of `MULTIPLE`."""
    ops = OnnxOperations(weights)
    apply(ops, "picture")
    ops.nodes[-1].output[0] = "enhanced"
    ports = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, [1, 3, "height", "width"])
        for name in ("picture", "enhanced")
    ]
    constants = [numpy_helper.from_array(value, name) for name, value in ops.constants.items()]
    graph = helper.make_graph(ops.nodes, "enhancer", ports[:1], ports[1:], constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=8)
    onnx.checker.check_model(model, full_check=True)
    return bytes(model.SerializeToString())
