"""The parameters of the node: its settings, and every leaf of the job under its own name."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult

from fathom.errors import FathomError, InvalidArgument, InvalidJob
from fathom.ros.description import change_description, open_stream, start_description
from fathom.ros.leaves import REMOVED, flatten
from fathom.ros.settings import FIXED, NAMES, Settings, read_settings
from fathom.ros.subscriptions import import_transforms
from fathom.stream import Stream

_OF_ROS = ("use_sim_time", "start_type_description_service")
_OF_ROS_GROUPS = ("qos_overrides.",)
_OF_STREAM = ("job", "site", "mode", "deadline_ms", "vary")
"""Settings that need another stream."""

Apply = Callable[[Settings, dict[str, Any], Stream], None]


class Parameters:
    """Checks changes of parameters with a new stream before it accepts them."""

    def __init__(self, node: Any) -> None:
        """Read the parameters that the node was started with; raises `InvalidArgument` and `InvalidJob`."""
        self._node = node
        self._lock = threading.RLock()
        self._is_mirroring = False
        self._apply: Apply | None = None
        given = {
            name: _read(entry) for name, entry in node.get_parameters_by_prefix("").items() if not _is_of_ros(name)
        }
        values, leaves = _split(given)
        self.settings = read_settings(values)
        if self.settings.world_frame:
            import_transforms()
        self.description = start_description(self.settings, leaves)
        self.stream = open_stream(self.description, self.settings)
        self._mirror()

    def follow(self, apply: Apply) -> None:
        """Accept changes from now on; `apply` takes the settings, the job and its open stream."""
        self._apply = apply
        self._changed = self._node.create_guard_condition(self._mirror)
        self._node.add_on_set_parameters_callback(self._take_changes)

    def _take_changes(self, changes: Iterable[Any]) -> Any:
        with self._lock:
            if self._is_mirroring:
                return SetParametersResult(successful=True)
            given = {entry.name: _read(entry) for entry in changes if not _is_of_ros(entry.name)}
            try:
                self._change(given)
            except FathomError as error:
                return SetParametersResult(successful=False, reason=explain(error))
            return SetParametersResult(successful=True)

    def _change(self, given: Mapping[str, Any]) -> None:
        if not given:
            return
        values, leaves = _split(given)
        unset = [name for name in values if values[name] is None]
        if unset:
            raise InvalidArgument(f"`{unset[0]}` is a setting of the node and cannot be removed; set it to a value")
        if values.get("job"):
            values.setdefault("site", "")
        elif values.get("site"):
            values.setdefault("job", "")
        settings = read_settings(values, self.settings)
        if settings.world_frame and not self.settings.world_frame:
            import_transforms()
        is_new = (settings.job, settings.site) != (self.settings.job, self.settings.site) or "job" in values
        if is_new:
            description = start_description(settings, leaves)
        else:
            description = change_description(self.description, leaves, settings)
        stream = self.stream
        if description != self.description or any(name in values for name in _OF_STREAM):
            stream = open_stream(description, settings)
        # A leaf that ROS has no type for is refused before anything changes.
        flatten(description)
        self.settings, self.description, self.stream = settings, description, stream
        if self._apply:
            self._apply(settings, description, stream)
            self._changed.trigger()

    def _mirror(self) -> None:
        """Declare exactly the settings and the leaves of the job, with their values."""
        with self._lock:
            wanted = {name: getattr(self.settings, name) for name in NAMES} | flatten(self.description)
            self._is_mirroring = True
            try:
                self._declare(wanted)
            finally:
                self._is_mirroring = False

    def _declare(self, wanted: Mapping[str, Any]) -> None:
        declared = {
            name: entry for name, entry in self._node.get_parameters_by_prefix("").items() if not _is_of_ros(name)
        }
        for name, entry in declared.items():
            if name not in wanted or _read(entry) != wanted[name]:
                self._node.undeclare_parameter(name)
        for name, value in wanted.items():
            if not self._node.has_parameter(name):
                descriptor = ParameterDescriptor(name=name, dynamic_typing=True, description=_describe(name))
                self._node.declare_parameter(name, value, descriptor, ignore_override=True)


def explain(error: FathomError) -> str:
    """Return the message of an error in one line, with every field of an invalid job."""
    if isinstance(error, InvalidJob) and error.errors:
        return "; ".join(map(str, error.errors))
    return str(error)


def _split(given: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return settings and leaves."""
    values = {name: value for name, value in given.items() if name in NAMES}
    leaves = {name: REMOVED if value is None else value for name, value in given.items() if name not in NAMES}
    return values, leaves


def _read(entry: Any) -> Any:
    """Return the value of a parameter as JSON has it: arrays become lists, and no value `None`."""
    value = entry.value
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, bytes) or (value and isinstance(value[0], bytes)):
        raise InvalidArgument(f"`{entry.name}` is an array of bytes; must be numbers or strings")
    return list(value)


def _is_of_ros(name: str) -> bool:
    return name in _OF_ROS or name.startswith(_OF_ROS_GROUPS)


def _describe(name: str) -> str:
    if name not in NAMES:
        return "field of the job, see proto/job/FIELDS.md"
    meaning = str(Settings.__dataclass_fields__[name].metadata["meaning"])
    return f"{meaning} (fixed while the node runs)" if name in FIXED else meaning
