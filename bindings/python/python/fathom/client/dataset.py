"""A dataset of a service as a source of frames."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from fathom.frame import Frame

if TYPE_CHECKING:
    from fathom.client.sync import Client


class Dataset:
    """Images of a service; every reading process opens its connection."""

    def __init__(self, server: str, token: str | None, rows: Iterable[Mapping[str, Any]]) -> None:
        self.server, self.token = server, token
        self._images = [(str(row["job"]), int(row["frame"])) for row in rows]
        self._client: tuple[int, Client] | None = None

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_client": None}

    def __len__(self) -> int:
        return len(self._images)

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Fetch an image."""
        from fathom.client.sync import Client

        if self._client is None or self._client[0] != os.getpid():
            self._client = os.getpid(), Client(self.server, token=self.token)
        return self._client[1].frame(*self._images[index], kinds)
