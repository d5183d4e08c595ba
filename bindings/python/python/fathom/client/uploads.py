"""Uploads of scenes and photos, shared by both clients."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.client.exr import has_distances
from fathom.client.protocol import WAIT_S, Call, Request, get, read_json
from fathom.client.scene import Scene
from fathom.errors import InvalidArgument
from fathom.training import Photo

Picture: TypeAlias = "str | os.PathLike[str] | NDArray[Any]"
Pose: TypeAlias = "str | os.PathLike[str] | NDArray[Any] | Sequence[Sequence[float]]"
Classes: TypeAlias = "Mapping[int, str] | Mapping[str, Any] | str | os.PathLike[str]"


def upload(
    parts: Mapping[str, Picture | None],
    classes: Classes | None,
    pose: Pose | None,
    values: Mapping[str, float | str | None],
) -> Call[Scene]:
    """Upload a scene of `rgb`, `range`, `z_depth` and `instances`."""
    files = {name: (name, read_scene_file(name, part)) for name, part in parts.items() if part is not None}
    # Distances along the axis need the camera. Without it the service responds with a note.
    has_camera = values.get("focal_px") is not None or values.get("hfov_deg") is not None
    if has_camera and not {"range", "z_depth"} & set(files) and has_distances(files["rgb"][1]):
        files["z_depth"] = ("z_depth", files["rgb"][1])
    if classes is not None:
        text = json.dumps(classes).encode() if isinstance(classes, Mapping) else Path(classes).read_bytes()
        files["classes"] = ("classes", text)
    if pose is not None:
        files["pose"] = ("pose", read_pose(pose))
    data = {name: str(value) for name, value in values.items() if value is not None}
    return Scene(read_json((yield Request("POST", "/v1/scenes", {"files": files, "data": data}))))


def train(photos: Photo | Sequence[Photo], name: str, options: Mapping[str, Any]) -> Call[dict[str, Any]]:
    """Train a style water on the service and follow it to its end."""
    given = [photos] if isinstance(photos, (str, os.PathLike, np.ndarray)) else list(photos)
    files = [("photo", ("photo", read_scene_file("photo", photo))) for photo in given]
    data = {"name": name} | {key: _form_value(value) for key, value in options.items() if value is not None}
    training: dict[str, Any] = read_json((yield Request("POST", "/v1/styles/train", {"files": files, "data": data})))
    while training["state"] in ("queued", "running"):
        training = yield from get(f"/v1/styles/trainings/{training['id']}", wait=WAIT_S)
    return training


def _form_value(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def read_pose(pose: Pose) -> bytes:
    """Return a pose as JSON, a file unchanged."""
    if isinstance(pose, (str, os.PathLike)):
        return Path(pose).read_bytes()
    matrix = np.asarray(pose, dtype=np.float64)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise InvalidArgument(f"pose has shape {matrix.shape} but a finite matrix of (4, 4) is needed")
    return json.dumps({"world_from_camera": matrix.tolist()}).encode()


def read_scene_file(name: str, part: Picture) -> bytes:
    """Return the file of a part: uint8 and uint16 as PNG, other types as NPY."""
    if not isinstance(part, np.ndarray):
        return Path(part).read_bytes()
    if part.ndim not in (2, 3) or (part.ndim == 3 and part.shape[2] != 3):
        raise InvalidArgument(f"{name} has shape {part.shape} but (height, width) or (height, width, 3) is needed")
    if part.dtype in (np.uint8, np.uint16):
        return _native.encode_png(part)
    file = BytesIO()
    if not np.issubdtype(part.dtype, np.floating):
        np.save(file, part, allow_pickle=False)
        return file.getvalue()
    if name == "rgb" and not np.isfinite(part).all():
        raise InvalidArgument(f"{name} has {np.count_nonzero(~np.isfinite(part))} samples that are not finite")
    np.save(file, np.ascontiguousarray(part, dtype=np.float32), allow_pickle=False)
    return file.getvalue()
