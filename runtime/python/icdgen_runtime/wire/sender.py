"""Messages of one direction, one after the other, in the envelope that the ICD describes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Optional, Union

from .._base import Message
from .._errors import RangeError
from .._hints import Buffer
from .envelope import Direction
from .errors import UnsupportedError, need
from .link import Link
from .stream import GIVEN, stream_encode


class Sender:
    """Puts messages into their envelopes, and counts them where the link has sequence numbers.

    ``values`` are those of ``source``, ``destination``, ``type``, ``flags``, ``time``, and of
    the first ``sequence``; of what is not given, the ICD's. Raises `UnsupportedError` for a
    field that the envelope does not have, `RangeError` for a value that does not fit it.
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
            field = form.of(role) if role in GIVEN else None
            if field is None:
                raise UnsupportedError(f"the envelope has no field `{role}` to choose")
            if not 0 <= value < 1 << field.bits:
                raise RangeError(role, f"0 to {(1 << field.bits) - 1}", value)
        self._sequence = form.of("sequence")
        self._per_id = form.per_id
        self._next: dict[Optional[int], int] = {}

    def encode(self, message: Union[Message, int], data: Buffer = b"") -> bytes:
        """The message, or the data of that id, as it is sent; raises like `stream_encode`."""
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
