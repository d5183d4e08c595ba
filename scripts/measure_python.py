"""Measures `Frames` beside `fathom render`, and the time that the binding adds to a frame.

Run by the interpreter of an environment with the wheel: `python scripts/measure_python.py FATHOM`, where FATHOM is the binary.
"""

import json
import multiprocessing
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import fathom

FRAMES = 96
PROCESSES = (1, 2)


def description() -> dict:
    """Describe frames of the usual size with water and a style; nothing is measured, as `Frames` measures nothing."""
    return {
        "count": FRAMES,
        "seed": 3,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 100000]}},
        "water": {"optics": "jerlov-1C", "range_scale": {"uniform": [0.2, 0.6]}, "style": "muddy"},
        "alpha": {"uniform": [0.2, 0.8]},
        "metrics": [],
        "artifacts": ["rgb", "semantics"],
    }


def rendered_per_s(binary: str, slots: int) -> float:
    """Return the frames per second of `fathom render`, as it prints them."""
    with tempfile.TemporaryDirectory() as folder:
        job = Path(folder) / "job.json"
        job.write_text(json.dumps(description()))
        command = [binary, "render", str(job), "--out", f"{folder}/out", "--slots", str(slots)]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return float(said.split("(")[1].split(" ")[0])


class Item:
    """What a worker process does for one frame."""

    def __init__(self, frames: fathom.Frames) -> None:
        self.frames = frames

    def __call__(self, index: int) -> dict:
        """Return the arrays of a frame."""
        return self.frames[index]


def read_per_s(frames: fathom.Frames, processes: int) -> float:
    """Return the frames per second that arrive in this process from worker processes."""
    with multiprocessing.get_context("fork").Pool(processes) as pool:
        pool.map(Item(frames), range(processes), chunksize=1)
        begun = time.perf_counter()
        for _ in pool.imap(Item(frames), range(len(frames))):
            pass
        return len(frames) / (time.perf_counter() - begun)


def added_ms(frames: fathom.Frames) -> tuple[float, float]:
    """Return the mean milliseconds of a frame here and the part of them that is not the renderer's own."""
    frames.read(0)
    begun = time.perf_counter()
    own = sum(frames.read(i).record["timings_ms"]["total"] for i in range(len(frames)))
    whole = 1000 * (time.perf_counter() - begun)
    return whole / len(frames), (whole - own) / len(frames)


def main() -> None:
    """Print a table; the runs alternate, and of three rounds the best counts."""
    frames = fathom.Frames(fathom.Job(description()))
    print("| processes or slots | `fathom render`, frames/s | `Frames`, frames/s |\n|---|---|---|")
    for processes in PROCESSES:
        rounds = [(rendered_per_s(sys.argv[1], processes), read_per_s(frames, processes)) for _ in range(3)]
        render, read = (max(values) for values in zip(*rounds, strict=True))
        print(f"| {processes} | {render:.1f} | {read:.1f} |")
    whole, added = added_ms(frames)
    print(f"\nOne frame: {whole:.1f} ms, of which {added:.2f} ms ({100 * added / whole:.1f} %) outside of the renderer")


if __name__ == "__main__":
    main()
