"""Many frames as a sequence of arrays by kind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, overload

from fathom.arguments import list_kinds
from fathom.display import html_table
from fathom.frame import Artifact, Frame


class Source(Protocol):
    """Sources of frames: a job to render, or existing output."""

    def __len__(self) -> int:
        """Return the number of frames."""

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Return a frame with these kinds of artifacts; `None`: those that it has."""


class Frames(Sequence[dict[str, Artifact]]):
    """The frames of a source as a sequence: `frames[i]` is a dictionary of arrays by kind, `frames[a:b]` a part of it.

    A DataLoader of torch, Grain and tf.data take it as it is. It can be pickled and holds no frame.
    """

    def __init__(self, source: Source, kinds: Sequence[str] | None = None, *, indices: range | None = None) -> None:
        """Use the frames of a `Job` or of a result of `fathom.open`; default `kinds`: all.

        Raises `fathom.InvalidArgument` for an unknown kind.
        """
        self.source = source
        self.kinds = list_kinds(kinds)
        self.indices = range(len(source)) if indices is None else indices

    def __repr__(self) -> str:
        kinds = "" if self.kinds is None else f" with {', '.join(self.kinds) or 'no artifacts'}"
        return f"<fathom.Frames: {len(self)} frames{kinds} of {self.source!r}>"

    def _repr_html_(self) -> str:
        kinds = "all" if self.kinds is None else ", ".join(self.kinds)
        return html_table("Frames", {"frames": len(self), "kinds": kinds, "source": repr(self.source)})

    def __len__(self) -> int:
        return len(self.indices)

    @overload
    def __getitem__(self, index: int) -> dict[str, Artifact]: ...
    @overload
    def __getitem__(self, index: slice) -> Frames: ...
    def __getitem__(self, index: int | slice) -> dict[str, Artifact] | Frames:
        if isinstance(index, slice):
            return Frames(self.source, self.kinds, indices=self.indices[index])
        return self.read(index).artifacts

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Return a frame with its record."""
        return self.source.read(self.indices[index], self.kinds if kinds is None else kinds)
