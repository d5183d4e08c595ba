"""Methods of the client for asyncio about scenes, pictures, waters and styles."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from numpy.typing import ArrayLike

from fathom.client import calls, deletion, renders, uploads
from fathom.client.calls import Description
from fathom.client.protocol import Call
from fathom.client.rows import Rows
from fathom.client.scene import Scene
from fathom.client.uploads import Classes, Picture, Pose
from fathom.frame import Frame
from fathom.training import Photo, choose_license

T = TypeVar("T")


class AsyncSceneMethods:
    """Methods of `fathom.AsyncClient` about scenes, pictures, waters and styles."""

    async def _run(self, call: Call[T]) -> T:
        raise NotImplementedError

    async def upload(
        self,
        rgb: Picture,
        *,
        range: Picture | None = None,
        z_depth: Picture | None = None,
        instances: Picture | None = None,
        classes: Classes | None = None,
        pose: Pose | None = None,
        unit_m: float | None = None,
        invalid_code: int | None = None,
        focal_px: float | None = None,
        hfov_deg: float | None = None,
        cx: float | None = None,
        cy: float | None = None,
        scale: float | None = None,
        collection: str | None = None,
        name: str | None = None,
    ) -> Scene:
        """Upload a scene and return its id, which has the `summary` of its files.

        Its `notes` are warnings of Python.
        """
        parts = {"rgb": rgb, "range": range, "z_depth": z_depth, "instances": instances}
        values = {
            "collection": collection,
            "name": name,
            "unit_m": unit_m,
            "invalid_code": invalid_code,
            "focal_px": focal_px,
            "hfov_deg": hfov_deg,
            "cx": cx,
            "cy": cy,
            "scale": scale,
        }
        scene = await self._run(uploads.upload(parts, classes, pose, values))
        for note in scene.notes:
            warnings.warn(note, stacklevel=2)
        return scene

    async def train(
        self,
        photos: Photo | Sequence[Photo],
        name: str,
        *,
        steps: int | None = None,
        seed: int | None = None,
        range: bool = False,
        license: str | None = None,
        licence: str | None = None,
    ) -> dict[str, Any]:
        """Train a style water on the service and wait for it."""
        # The service stores the license under this name.
        options = {"steps": steps, "seed": seed, "range": range or None, "licence": choose_license(license, licence)}
        return await self._run(uploads.train(photos, name, options))

    async def render(
        self,
        job: Description,
        rgb: Picture,
        *,
        range_m: Picture | None = None,
        z_depth: Picture | None = None,
        instances: Picture | None = None,
        camera: ArrayLike | None = None,
        pose: Pose | None = None,
        stamp_ns: int = 0,
        wait_s: int = 30,
    ) -> Frame:
        """Put a picture into the water of a job, as a `fathom.Stream` does; the service stores nothing."""
        parts = {"rgb": rgb, "range": range_m, "z_depth": z_depth, "instances": instances}
        frame = await self._run(renders.render(job, parts, camera, pose, stamp_ns, wait_s))
        for warning in renders.list_warnings(frame):
            warnings.warn(warning, stacklevel=2)
        return frame

    async def scenes(self, *, collection: str | None = None, limit: int | None = None) -> list[Scene]:
        """Return the uploaded scenes, the newest first, or those of a collection in its order."""
        return await self._run(calls.scenes(collection, limit))

    async def delete_collection(self, name: str) -> None:
        """Delete a collection; its scenes stay."""
        await self._run(deletion.delete_collection(name))

    async def waters(self) -> Rows:
        """Return the optical waters with their coefficients and sources."""
        return await self._run(calls.waters())

    async def add_water(self, water: Mapping[str, Any] | str | os.PathLike[str]) -> dict[str, Any]:
        """Add a custom water, a mapping or the path of a JSON file, and return it with its derived coefficients."""
        return await self._run(calls.add_water(water))

    async def styles(self, *, role: str | None = None) -> Rows:
        """Return the networks: those of all roles, or of `role`: style, enhancer or metric."""
        return await self._run(calls.styles(role))
