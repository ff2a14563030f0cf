"""Encoder of consecutive messages of one direction, with header and trailer.

It counts the sequence numbers; `stream` encodes a single message.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Optional, Union

from .._base import Message
from .._errors import RangeError
from .._hints import Buffer
from .device import PacketData, response_to
from .errors import UnsupportedError, need
from .link import Link
from .packet_formats import Direction, Verdict
from .stream import (
    StreamEvent,
    packet_without_message,
    stream_encode,
    stream_encode_packet,
    stream_encode_request,
)
from .stuffing import stuffed

_NO_VALUES: Mapping[str, int] = {}


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
        self._form = form = need(link.stream, "stream")
        # Without delimiters, to see the header.
        self._link = link._replace(stream=form._replace(delimited_by="datagram"))
        self.header = b""
        """Header of the last packet."""
        self._direction: Direction = direction
        self._values = dict(values or {})
        fields = form.chosen(direction)
        for role, value in self._values.items():
            field = fields.get(role)
            if field is None:
                raise UnsupportedError(f"the header has no field `{role}` to choose")
            if not 0 <= value < 1 << field.bits:
                raise RangeError(role, f"0 to {(1 << field.bits) - 1}", value)
        self._next: dict[Optional[int], int] = {}

    def encode(self, message: Union[Message, int], data: Buffer = b"") -> bytes:
        """Encode a message, or the data of an id. Raise as `stream_encode`."""
        index = 0 if self._direction == "telecommand" else -1
        id = message.IDS[index] if isinstance(message, Message) else message

        def encoded(values: Mapping[str, int]) -> bytes:
            return stream_encode(self._link, message, data, self._direction, **values)

        row = self._form.row(self._direction, id)
        packet = 0 if row is None else row.packet
        return self._numbered(packet, id, encoded)

    def encode_request(self, telemetry: int) -> bytes:
        """Encode the packet that requests telemetry of an id. Raise as
        `stream_encode_request`.
        """

        def encoded(values: Mapping[str, int]) -> bytes:
            return stream_encode_request(self._link, telemetry, **values)

        request = self._form.request
        return self._numbered(request.packet if request else 0, None, encoded)

    def encode_packet(self, packet: int, id: int, values: Mapping[str, int]) -> bytes:
        """Encode a packet without a message. Raise as `stream_encode_packet`.

        ``values`` take precedence over the values of the sender. The sequence number is
        an exception if the sender counts the packet.
        """
        packet_without_message(self._form, packet, self._direction)

        def encoded(chosen: Mapping[str, int]) -> bytes:
            return stream_encode_packet(
                self._link, packet, id, self._direction, **chosen
            )

        return self._numbered(packet, None, encoded, values)

    def respond(
        self,
        received: StreamEvent,
        verdict: Verdict = "ack",
        reason: Optional[int] = None,
        telemetry: Buffer = b"",
    ) -> Optional[bytes]:
        """Encode the response of a device to what it has received; None if the ICD has
        no such response. The sender is one of telemetry.

        ``received``: an event of the decoder of telecommands: ``message`` or
        ``request``; to refuse, also ``unknown_id``, ``length`` or ``checksum``. For the
        other parameters and errors see `response_to`.
        """
        if self._direction != "telemetry" or received.id is None:
            return None
        is_request = received.event == "request" or received.is_request
        response = response_to(
            self._link,
            received.id,
            received.data,
            verdict,
            reason,
            telemetry,
            is_request,
            received.header,
            self._values,
        )
        if isinstance(response, PacketData):
            return self.encode_packet(*response)
        return None if response is None else self.encode(*response)

    def _numbered(
        self,
        packet: int,
        id: Optional[int],
        encoded: Callable[[Mapping[str, int]], bytes],
        values: Mapping[str, int] = _NO_VALUES,
    ) -> bytes:
        """Encode a packet with the values of the sender, ``values`` and, if the packet
        is counted, the next sequence number.

        ``id``: id of a message. None for other packets, which are not counted if each
        id has its own sequence.
        """
        chosen = {**self._values, **values}
        field = self._form.packets[packet].of("sequence")
        if field is None or (self._form.per_id and id is None):
            return self._line(packet, encoded(chosen))
        key = id if self._form.per_id else None
        first = field.values[self._direction == "telemetry"]
        number = self._next.get(key, self._values.get("sequence", first))
        frame = encoded({**chosen, "sequence": number})
        # After the encoding, which can raise: a receiver would report a skipped number.
        self._next[key] = (number + 1) & ((1 << field.bits) - 1)
        return self._line(packet, frame)

    def _line(self, packet: int, frame: bytes) -> bytes:
        """Return the transmitted bytes of a packet."""
        self.header = frame[: self._form.packets[packet].header_bytes]
        return stuffed(self._form, frame)
