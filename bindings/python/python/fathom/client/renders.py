"""Pictures rendered by a service without storage, shared by both clients."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import httpx
from numpy.typing import ArrayLike

from fathom.arguments import read_matrix, read_stamp
from fathom.client.calls import Description, read_body
from fathom.client.protocol import Call, Request
from fathom.client.uploads import Picture, Pose, read_pose, read_scene_file
from fathom.errors import FathomError, InvalidArgument
from fathom.frame import Frame
from fathom.stored import decode_artifact

LONGEST_WAIT_S = 60
"""Longest rendering of one picture."""
_BOUNDARY = re.compile(r'multipart/mixed;\s*boundary="?([^";]+)"?')
_NAME = re.compile(rb'^Content-Disposition:[^\r\n]*\bname="([^"]+)"', re.MULTILINE | re.IGNORECASE)
_LENGTH = re.compile(rb"^Content-Length:\s*(\d+)", re.MULTILINE | re.IGNORECASE)


def render(
    description: Description,
    parts: Mapping[str, Picture | None],
    camera: ArrayLike | None,
    pose: Pose | None,
    stamp_ns: int,
    wait_s: int,
) -> Call[Frame]:
    """Render a picture of the parts `rgb`, `range`, `z_depth` and `instances` in the water of a job."""
    if parts["range"] is not None and parts["z_depth"] is not None:
        raise InvalidArgument("`z_depth` and `range_m` are both given; give the one that was measured")
    if not 1 <= wait_s <= LONGEST_WAIT_S:
        raise InvalidArgument(f"`wait_s` is {wait_s}; must be 1 to {LONGEST_WAIT_S}")
    body = read_body(description)
    form = {"frame": body.encode() if isinstance(body, str) else body, "stamp_ns": str(read_stamp(stamp_ns)).encode()}
    form |= {name: read_scene_file(name, part) for name, part in parts.items() if part is not None}
    if (matrix := read_matrix("camera", camera, 3)) is not None:
        form["camera"] = json.dumps(matrix).encode()
    if pose is not None:
        form["pose"] = read_pose(pose)
    headers = {"Accept": "multipart/mixed", "Prefer": f"wait={wait_s}"}
    options = {"files": {name: (name, content) for name, content in form.items()}, "headers": headers}
    return _read_frame((yield Request("POST", "/v1/renders", options)))


def _read_frame(response: httpx.Response) -> Frame:
    parts = dict(_split(response))
    try:
        record = parts.pop("record").decode()
        number = int(json.loads(record)["frame"])
    except (KeyError, ValueError) as error:
        raise FathomError(f"the response to {response.url} has no record") from error
    return Frame(number, {kind: decode_artifact(kind, content) for kind, content in parts.items()}, record)


def _split(response: httpx.Response) -> Iterator[tuple[str, bytes]]:
    """Yield name and content of each part. The lengths in their headers delimit them."""
    kind = response.headers.get("content-type", "unknown")
    boundary = _BOUNDARY.match(kind)
    if boundary is None:
        raise FathomError(f"the response to {response.url} is of type {kind}, not multipart/mixed")
    delimiter, rest = b"--" + boundary[1].encode(), response.content
    while not rest.startswith(delimiter + b"--"):
        head, _, content = rest.partition(b"\r\n\r\n")
        name, length = _NAME.search(head), _LENGTH.search(head)
        size = int(length[1]) if length else 0
        if not rest.startswith(delimiter) or name is None or length is None or len(content) < size + 2:
            raise FathomError(f"the response to {response.url} is damaged; repeat the request")
        yield name[1].decode(), content[:size]
        rest = content[size + 2 :]


def list_warnings(frame: Frame) -> Sequence[str]:
    """Return the warnings of a rendered picture."""
    found: Any = frame.record.get("warnings") or ()
    return tuple(str(warning) for warning in found)
