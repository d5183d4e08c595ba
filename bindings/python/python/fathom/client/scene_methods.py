"""Methods of the client that waits about scenes, pictures, waters and styles."""

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


class SceneMethods:
    """Methods of `fathom.Client` about scenes, pictures, waters and styles."""

    def _run(self, call: Call[T]) -> T:
        raise NotImplementedError

    def upload(
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
        """Upload a scene and return its id, which has the `summary` of its files. Its `notes` are warnings of Python.

        Each part is a file or an array: `rgb` uint8 or uint16 codes, or float linear radiance, (H, W, 3); `range` or
        `z_depth` float meters or integers of `unit_m` meters, (H, W); `instances` whole numbers, (H, W). `scale` is the
        factor from the floats of `rgb` to linear light, where 1 is white. `classes` names the instances:
        `{1: "pile", 2: "chain"}`, COCO's `categories` and `segments_info`, or a JSON file. `pose` is the pose of the
        camera: the (4, 4) matrix from camera axes (right, down, ahead) to the world, or a JSON file. The camera is
        `focal_px` or `hfov_deg`, with the principal point `cx`, `cy` in pixels. With a camera, the channel Z of an EXR
        picture is its z-depth.
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
        scene = self._run(uploads.upload(parts, classes, pose, values))
        for note in scene.notes:
            warnings.warn(note, stacklevel=2)
        return scene

    def train(
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
        """Train a style water on the service, wait for it and return the training with its `state`."""
        # The service stores the license under this name.
        options = {"steps": steps, "seed": seed, "range": range or None, "licence": choose_license(license, licence)}
        return self._run(uploads.train(photos, name, options))

    def render(
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
        """Put a picture into the water of a job, as a `fathom.Stream` does; the service stores nothing.

        The picture replaces the scene of the job, which may be absent. `rgb`: integers are sRGB codes, floats linear
        light, (H, W, 3). `range_m` (along the ray) or `z_depth` (along the optical axis): integers are millimeters,
        floats meters, (H, W); without distances the stages of the water are skipped. `instances`: a mask for the
        artifacts `instances` and `boxes`. Each is a file or an array. `camera`: the matrix
        [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels. `pose` as for `upload`. `stamp_ns` is the time of the picture,
        from which its random numbers are drawn. The rendering takes at most `wait_s` seconds, 1 to 60.

        The frame has all artifacts of the job. Its warnings are warnings of Python.
        """
        parts = {"rgb": rgb, "range": range_m, "z_depth": z_depth, "instances": instances}
        frame = self._run(renders.render(job, parts, camera, pose, stamp_ns, wait_s))
        for warning in renders.list_warnings(frame):
            warnings.warn(warning, stacklevel=2)
        return frame

    def scenes(self, *, collection: str | None = None, limit: int | None = None) -> list[Scene]:
        """Return the uploaded scenes, the newest first, or those of a collection in its order."""
        return self._run(calls.scenes(collection, limit))

    def delete_collection(self, name: str) -> None:
        """Delete a collection; its scenes stay."""
        self._run(deletion.delete_collection(name))

    def waters(self) -> Rows:
        """Return the optical waters with their coefficients and sources."""
        return self._run(calls.waters())

    def add_water(self, water: Mapping[str, Any] | str | os.PathLike[str]) -> dict[str, Any]:
        """Add a custom water, a mapping or the path of a JSON file, and return it with its derived coefficients."""
        return self._run(calls.add_water(water))

    def styles(self, *, role: str | None = None) -> Rows:
        """Return the networks: those of all roles, or of `role`: style, enhancer or metric."""
        return self._run(calls.styles(role))
