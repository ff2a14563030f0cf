"""The device's half of a link with header and trailer: responses to telecommands and
requests, for simulators and for tests of a client.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple, Optional, Union

from .._base import Message
from .._errors import RangeError
from .._hints import Buffer
from .errors import need
from .link import Link
from .message_ids import message_id
from .packet_formats import (
    CHOSEN_ROLES,
    Exchange,
    NumberPlace,
    PacketForm,
    Response,
    Stream,
    Verdict,
)
from .stream import values_of

_NO_VALUES: Mapping[str, int] = {}
_ID_BYTES = 4  # of the id in front of the data, in `Exchange.sources`


class TelemetryData(NamedTuple):
    """Data of telemetry and its id, for `Sender.encode`."""

    id: int
    data: bytes


class PacketData(NamedTuple):
    """A packet without a message: its index in `Stream.packets`, its id and the values
    of its frame fields by role, for `Sender.encode_packet`.
    """

    packet: int
    id: int
    values: Mapping[str, int]


def response_to(
    link: Link,
    telecommand: Union[Message, int],
    data: Buffer = b"",
    verdict: Verdict = "ack",
    reason: Optional[int] = None,
    telemetry: Buffer = b"",
    is_request: bool = False,
    header: Buffer = b"",
    values: Mapping[str, int] = _NO_VALUES,
) -> Union[TelemetryData, PacketData, None]:
    """Return the response of a device to a telecommand; None if the ICD has no such
    response. `Sender.respond` encodes it too.

    ``is_request``: instead of a telecommand, the device has received the request of the
    telemetry with this id (the event ``"request"`` of `StreamDecoder`).

    The telecommand is a message, or an id and its data. An id that the node does not
    have can be refused (``"nak"``). The response repeats the numbers of the telecommand
    that the ICD describes as `echo`, and has the status for ``verdict``: of several
    values, the one that the ICD lists first. ``reason`` is the reason of a refusal;
    without one, the reason in ``telemetry`` remains; it is 0 in a packet without a
    message.
    ``header`` is the header of the telecommand (`StreamEvent.header`), if responses
    repeat numbers of it; without, these are the defaults of the ICD, or 0.
    ``telemetry`` has the data of the telemetry that responds; missing bytes are 0.
    ``values``: header and trailer values of a packet without a message, by role.
    Raise `RangeError` for a reason whose number is the status of another verdict, and
    for a value that does not fit into its field.
    """
    form = need(link.stream, "stream")
    if isinstance(telecommand, Message):
        id = message_id(link, "telecommand", type(telecommand))
        data = telecommand.to_bytes()
    else:
        id = telecommand
    exchange = _exchange_of(form, id, verdict, is_request)
    response = _response(exchange, verdict) if exchange else None
    if exchange is None or response is None:
        return None
    responding = id if response.telemetry is None else response.telemetry
    if response.packet is None:
        row = form.row("telemetry", responding)
        if row is None:
            return None
        filled = bytearray(telemetry)
        filled.extend(bytes(max(0, row.least - len(filled))))
    else:
        filled = _empty(form.packets[response.packet], values)
    sent = id.to_bytes(_ID_BYTES, "big") + bytes(data)
    numbers = exchange.numbers(sent)
    if header:
        numbers += exchange.numbers_in(bytes(header))
    for echo in response.echoes:
        if echo.source < len(numbers):
            echo.place.put(numbers[echo.source], filled)
    if response.status:
        response.status.put(_status(response, verdict), filled)
    if reason is not None and response.reason:
        response.reason.put(reason, filled)
        is_kept = response.reason.of(bytes(filled)) == reason
        says = response.verdict_of(bytes(filled))
        # A refusal can say that the telecommand was damaged.
        if not is_kept or ("nak" if says == "again" else says) != verdict:
            raise RangeError("reason", f"a reason of the verdict {verdict}", reason)
    if response.packet is not None:
        id_of_packet, filled_values = values_of(
            form.packets[response.packet], bytes(filled)
        )
        return PacketData(response.packet, id_of_packet, filled_values)
    return TelemetryData(responding, bytes(filled))


def _empty(packet: PacketForm, values: Mapping[str, int]) -> bytearray:
    """Return a packet without a message, with these values or the defaults of the ICD."""
    filled = bytearray(packet.overhead + packet.reserved)
    for field in packet.fields:
        if field.role in CHOSEN_ROLES:
            start = packet.header_bytes + packet.reserved if field.in_trailer else 0
            place = NumberPlace(
                start + field.at, field.size, field.shift, field.bits, field.little
            )
            value = values.get(field.role, field.values[1])
            if value >> field.bits:
                raise RangeError(field.role, f"0 to {(1 << field.bits) - 1}", value)
            place.put(value, filled)
    return filled


def response_of(
    form: Stream, id: int, verdict: Verdict, is_request: bool = False
) -> Optional[Response]:
    """Return the response that says ``verdict`` about a telecommand, or about the
    request of telemetry; None without one.

    If the node does not have the telecommand, it refuses it by the first response that
    repeats no part of a telecommand but its id.
    """
    exchange = _exchange_of(form, id, verdict, is_request)
    return _response(exchange, verdict) if exchange else None


def _exchange_of(
    form: Stream, id: int, verdict: Verdict, is_request: bool
) -> Optional[Exchange]:
    if is_request:
        request = need(form.request, "requests")
        return form.exchanges[request.exchange]
    row = next((row for row in form.telecommands if row.id == id), None)
    if row is None:
        return _refusing(form) if verdict == "nak" else None
    return None if row.exchange is None else form.exchanges[row.exchange]


def _response(exchange: Exchange, verdict: Verdict) -> Optional[Response]:
    """Return the response of a verdict.

    A response that only refuses precedes one whose status can also refuse.
    """
    for response in exchange.responses:
        # `again` is a refusal for a certain reason.
        meanings = {meaning for _, meaning in response.meanings} - {"again"}
        if verdict in (meanings or {response.verdict}):
            return response
    for response in exchange.responses:
        place = response.status
        is_left = place is not None and len(response.meanings) < 1 << place.bits
        if is_left and response.verdict == verdict:
            return response
    return None


def _refusing(form: Stream) -> Optional[Exchange]:
    """Return the exchange by whose response an unknown telecommand is refused."""
    for exchange in form.exchanges:
        response = _response(exchange, "nak")
        end = len(exchange.sources) - exchange.in_header
        if response and all(
            echo.source >= end or _is_in_id(exchange.sources[echo.source])
            for echo in response.echoes
        ):
            return exchange
    return None


def _is_in_id(place: NumberPlace) -> bool:
    return place.at + place.size <= _ID_BYTES


def _status(response: Response, verdict: Verdict) -> int:
    """Return the status that says ``verdict``: the first listed value; otherwise, the
    smallest number that is not listed.
    """
    listed = next((value for value, says in response.meanings if says == verdict), None)
    if listed is not None:
        return listed
    taken = {value for value, _ in response.meanings}
    return next(value for value in range(len(taken) + 1) if value not in taken)
