"""Encoder of consecutive messages of one direction, with header and trailer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Optional, Union

from .._base import Message
from .._errors import RangeError
from .._hints import Buffer
from .envelope import Direction
from .errors import UnsupportedError, need
from .link import Link
from .stream import CHOSEN_ROLES, stream_encode


class Sender:
    """Add header, trailer and sequence numbers to messages.

    ``values`` are the values of ``source``, ``destination``, ``type``, ``flags``,
    ``time``, and the first ``sequence``. Defaults are in the ICD. Raise
    `UnsupportedError` for a field that the frame format does not have, and `RangeError`
    for a value out of range.
    """

    def __init__(
        self,
        link: Link,
        direction: Direction = "telecommand",
        values: Optional[Mapping[str, int]] = None,
    ) -> None:
        form = need(link.stream, "stream")
        self._link = link
        self._direction: Direction = direction
        self._values = dict(values or {})
        for role, value in self._values.items():
            field = form.of(role) if role in CHOSEN_ROLES else None
            if field is None:
                raise UnsupportedError(f"the envelope has no field `{role}` to choose")
            if not 0 <= value < 1 << field.bits:
                raise RangeError(role, f"0 to {(1 << field.bits) - 1}", value)
        self._sequence = form.of("sequence")
        self._per_id = form.per_id
        self._next: dict[Optional[int], int] = {}

    def encode(self, message: Union[Message, int], data: Buffer = b"") -> bytes:
        """Encode a message, or the data of an id. Raise as `stream_encode`."""
        field = self._sequence
        if field is None:
            return stream_encode(
                self._link, message, data, self._direction, **self._values
            )
        index = 0 if self._direction == "telecommand" else -1
        id = message.IDS[index] if isinstance(message, Message) else message
        key = id if self._per_id else None
        first = field.values[self._direction == "telemetry"]
        number = self._next.get(key, self._values.get("sequence", first))
        values = {**self._values, "sequence": number}
        line = stream_encode(self._link, message, data, self._direction, **values)
        self._next[key] = (number + 1) & ((1 << field.bits) - 1)
        return line
