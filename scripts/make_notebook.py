"""Writes examples/frames.ipynb and executes it, so that it is stored with its outputs.

Run in the root of the repository by the interpreter of an environment with the wheel, nbclient, ipykernel and matplotlib.
"""

import nbformat
from nbclient import NotebookClient

PATH = "examples/frames.ipynb"
CELLS = [
    "# Frames in a notebook\nA job is a description with laws in place of values. It is checked at once.",
    """import matplotlib.pyplot as plt
import numpy as np

import fathom

job = fathom.Job({
    "seed": 4, "count": 6,
    "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1000]}},
    "camera": {"width": 240, "height": 160},
    "water": {"optics": {"choice": ["jerlov-IB", "jerlov-1C", "jerlov-3C"]}, "range_scale": {"uniform": [0.1, 0.5]}},
})
job""",
    "All errors of a description come together.",
    """try:
    fathom.Job({"scene": {"kind": "procedural", "family": "structur"}, "alpha": 1.5, "count": 0})
except fathom.InvalidJob as invalid:
    for error in invalid.errors:
        print(error)""",
    "A frame is a function of the job and its index: pictures, range in meters, labels, and a record.",
    """frame = fathom.render(job, 2, ["rgb", "range", "semantics", "boxes"])
_, axes = plt.subplots(1, 3, figsize=(9, 2.2))
for axis, picture in zip(axes, (frame.rgb, frame.range_m, frame.semantics)):
    axis.imshow(picture)
    axis.axis("off")
plt.show()
names = fathom.names()["categories"]
print({names[number]: int(count) for number, count in enumerate(np.bincount(frame.semantics.ravel())) if count})
print(frame.record["measurements"]["rgb"])""",
    "`Frames` is a sequence for data loaders. Every frame is rendered when it is asked for, and nothing is stored.",
    """frames = fathom.Frames(job, kinds=["rgb", "semantics"])
np.stack([frames[i]["rgb"] for i in range(len(frames))]).shape""",
]


def main() -> None:
    """Write the notebook."""
    notebook = nbformat.v4.new_notebook()
    makers = (nbformat.v4.new_markdown_cell, nbformat.v4.new_code_cell)
    # Text and code take turns. Ids are numbers, so that the file changes only where the notebook does.
    notebook.cells = [makers[i % 2](text, id=f"cell-{i}") for i, text in enumerate(CELLS)]
    notebook.metadata.kernelspec = {"name": "python3", "display_name": "Python 3", "language": "python"}
    NotebookClient(notebook, record_timing=False).execute()
    nbformat.write(notebook, PATH)


if __name__ == "__main__":
    main()
