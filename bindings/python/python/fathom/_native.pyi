"""The native half of the package."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

class Job:
    """A checked job. Every index is that of a frame, from 0."""

    def __new__(cls, text: str, styles: str | None, onnxruntime: str | None) -> Job:
        """Check a description; raises `fathom.InvalidJob`."""

    @property
    def frames(self) -> int:
        """Number of frames."""

    @property
    def canonical(self) -> str:
        """Canonical JSON text."""

    @property
    def digest(self) -> str:
        """SHA-256 of the canonical text, lower-case hex."""

    @property
    def warnings(self) -> list[str]:
        """Warnings."""

    def resolve(self, index: int) -> str:
        """Return the parameters of a frame as JSON."""

    def plan(self, index: int) -> str:
        """Return the plan of a frame as JSON."""

    def render(
        self, index: int, kinds: list[str] | None, metrics: bool
    ) -> tuple[list[tuple[str, NDArray[Any] | str]], str]:
        """Return the artifacts of a frame by kind (`boxes` as JSON) and its record as JSON."""

class StreamRecord:
    """The record of a frame of a stream."""

    @property
    def warnings(self) -> list[str]:
        """Warnings about the frame."""

    def text(self) -> str:
        """Return the record as JSON."""

class Stream:
    """A job over the pictures of a camera."""

    def __new__(
        cls,
        text: str,
        vary: str,
        has_metrics: bool,
        deadline_ms: float | None,
        styles: str | None,
        onnxruntime: str | None,
    ) -> Stream:
        """Check a description; raises `fathom.InvalidJob` and `fathom.InvalidArgument`."""

    @property
    def warnings(self) -> list[str]:
        """Warnings about the job."""

    def render(
        self,
        rgb: NDArray[Any],
        channels: str,
        depth: tuple[str, NDArray[Any]] | None,
        camera: list[list[float]] | None,
        stamp_ns: int | None,
        pose: list[list[float]] | None,
    ) -> tuple[list[tuple[str, NDArray[Any] | str]], StreamRecord, float | None, float]:
        """Return the artifacts of a frame by kind, its record, error bound and time in ms."""

def enhance(
    image: NDArray[Any], method: str, styles: str | None, onnxruntime: str | None
) -> tuple[NDArray[np.uint8], list[str]]:
    """Return the enhanced image and its warnings."""

def measure(
    image: NDArray[Any],
    metrics: list[str],
    clean: NDArray[Any] | None,
    styles: str | None,
    onnxruntime: str | None,
) -> list[tuple[str, float]]:
    """Return the metrics with their values."""

def decode(file: bytes) -> NDArray[Any]:
    """Return the array of a PNG, JPEG, WebP or NPY file."""

def encode_png(image: NDArray[Any]) -> bytes:
    """Return the PNG file of an array."""

def names() -> dict[str, list[str]]:
    """Return all names by kind."""

def run(arguments: list[str]) -> int:
    """Run a command of the `fathom` binary and return its exit status."""
