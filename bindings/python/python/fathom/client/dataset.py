"""A dataset of a service as a source of frames."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fathom.client.proxies import hide_password
from fathom.display import html_table
from fathom.frame import Frame

if TYPE_CHECKING:
    from fathom.client.sync import Client


class Dataset:
    """Images of a service; every reading process opens its connection."""

    def __init__(self, server: str, token: str | None, rows: Iterable[Mapping[str, Any]], *, name: str = "") -> None:
        self.server, self.token = server, token
        self.name = name
        self._images = [(str(row["job"]), int(row["frame"])) for row in rows]
        self._client: tuple[int, Client] | None = None

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_client": None}

    def __repr__(self) -> str:
        name = f" {self.name}" if self.name else ""
        return f"<fathom.Dataset{name}: {len(self)} images of {hide_password(self.server)}>"

    def _repr_html_(self) -> str:
        jobs = {job for job, _ in self._images}
        rows = {"images": len(self), "jobs": len(jobs), "server": hide_password(self.server)}
        return html_table(f"Dataset {self.name}".rstrip(), rows)

    def __len__(self) -> int:
        return len(self._images)

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Fetch an image."""
        from fathom.client.sync import Client

        if self._client is None or self._client[0] != os.getpid():
            self._client = os.getpid(), Client(self.server, token=self.token)
        return self._client[1].frame(*self._images[index], kinds)
