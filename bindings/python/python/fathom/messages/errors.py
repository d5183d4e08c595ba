"""The error of a message that has no array."""

from __future__ import annotations

from fathom.errors import FathomError


class MessageError(FathomError, ValueError):
    """A message that cannot be converted: the topic, the field, its value and the limit."""

    def __init__(self, topic: str, reason: str, kind: str) -> None:
        super().__init__(topic, reason, kind)
        self.topic = topic
        self.reason = reason
        self.kind = kind
        """What is wrong, the same for all messages with this error, such as "encoding"."""

    def __str__(self) -> str:
        return f"{self.topic}: {self.reason}"
