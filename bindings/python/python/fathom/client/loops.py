"""Connections of the async client."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator

import httpx

from fathom.client.connection import Connection

_Holder = AsyncGenerator[None, None]
_holders: set[_Holder] = set()
"""Generators of open connections. In Python 3.10 a loop that ends leaves a generator open whose last reference just
disappeared; this is a reference until it is closed."""


class LoopClients:
    """One client of httpx at a time, made in the running loop.

    A generator holds it open, because a loop closes its generators when it shuts down. So connections close without a
    `with` block.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._loop: asyncio.AbstractEventLoop | None = None
        self._http: httpx.AsyncClient | None = None
        self._holder: _Holder | None = None

    async def open(self) -> httpx.AsyncClient:
        """Return the client of the running loop."""
        loop = asyncio.get_running_loop()
        if self._http is None or self._http.is_closed or self._loop is not loop:
            self.release()
            transport = httpx.AsyncHTTPTransport(**self._connection.transport_options())
            self._http = httpx.AsyncClient(transport=transport, **self._connection.options())
            self._loop, self._holder = loop, _hold(self._http)
            _holders.difference_update([holder for holder in _holders if getattr(holder, "ag_frame", None) is None])
            _holders.add(self._holder)
            # The loop registers the generator at its first step.
            await anext(self._holder)
        return self._http

    async def close(self) -> None:
        """Close the connections of the running loop, and drop those of another one."""
        if self._holder is not None and self._loop is asyncio.get_running_loop():
            await _close(self._holder)
            self._http = self._holder = None
        else:
            self.release()

    def release(self) -> None:
        """Let the loop close the connections soon, without waiting; also from another thread."""
        loop, holder = self._loop, self._holder
        self._http = self._holder = None
        if holder is not None and loop is not None and loop.is_running():
            loop.call_soon_threadsafe(lambda: loop.create_task(_close(holder)))


async def _hold(http: httpx.AsyncClient) -> _Holder:
    try:
        yield
    finally:
        await http.aclose()


async def _close(holder: _Holder) -> None:
    await holder.aclose()
    _holders.discard(holder)
