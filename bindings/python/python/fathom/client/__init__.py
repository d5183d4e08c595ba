"""Clients of a Fathom service, sync and async. They need httpx: `pip install fathom-datasets[client]`."""

from fathom.client.aio import AsyncClient
from fathom.client.dataset import Dataset
from fathom.client.rows import Rows
from fathom.client.scene import Scene
from fathom.client.submitted import AsyncSubmitted, Submitted
from fathom.client.sync import Client

__all__ = ["AsyncClient", "AsyncSubmitted", "Client", "Dataset", "Rows", "Scene", "Submitted"]


def __dir__() -> list[str]:
    return sorted(__all__)
