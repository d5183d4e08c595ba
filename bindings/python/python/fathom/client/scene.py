"""An uploaded scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fathom.display import html_table


class Scene(str):
    """The id of an uploaded scene, with the content of its files. It is a string wherever an id is needed."""

    fields: dict[str, Any]
    """The scene as JSON of the service."""

    def __new__(cls, fields: Mapping[str, Any]) -> Scene:
        """Make a scene from the response to its upload."""
        scene = super().__new__(cls, fields["id"])
        scene.fields = dict(fields)
        return scene

    def __getnewargs__(self) -> tuple[Any, ...]:
        return (self.fields,)

    def __repr__(self) -> str:
        return f"<fathom.Scene {self}: {', '.join(self._describe().values())}>"

    def _repr_html_(self) -> str:
        return html_table(f"Scene {self}", self._describe() | {"notes": "; ".join(self.notes)})

    @property
    def id(self) -> str:
        """The id as a plain string."""
        return str.__str__(self)

    @property
    def width(self) -> int:
        """Columns."""
        return int(self.fields["width"])

    @property
    def height(self) -> int:
        """Rows."""
        return int(self.fields["height"])

    @property
    def has_range(self) -> bool:
        """Whether it has distances, which water, snow and lamps need."""
        return (self.fields.get("range_digest") or self.fields.get("range_kind")) is not None

    @property
    def name(self) -> str | None:
        """Its name in a collection, if it was listed by one."""
        name = self.fields.get("name")
        return None if name is None else str(name)

    @property
    def summary(self) -> dict[str, Any]:
        """Content of the files: `valid_share`, `nearest_m`, `farthest_m`, `objects`, `classes` with their `pixels`."""
        return dict(self.fields.get("summary") or {})

    @property
    def notes(self) -> tuple[str, ...]:
        """Readings of the files that are not obvious, and parts of them that are not used."""
        return tuple(self.summary.get("notes") or ())

    def _describe(self) -> dict[str, str]:
        summary = self.summary
        described = {} if self.name is None else {"name": self.name}
        described["size"] = f"{self.width}×{self.height}"
        if summary.get("valid_share") is None:
            described["range"] = "range" if self.has_range else "no range"
        elif summary.get("nearest_m") is None:
            described["range"] = "range of 0.0 % of the pixels"
        else:
            distances = f"{summary['nearest_m']:.3f} to {summary['farthest_m']:.3f} m"
            described["range"] = f"range of {100 * summary['valid_share']:.1f} % of the pixels, {distances}"
        if summary.get("objects") is not None:
            classes = [f"{row['name']} {row['pixels']} px" for row in summary.get("classes", ())]
            described["objects"] = f"{summary['objects']} objects" + (f" ({', '.join(classes)})" if classes else "")
        return described
