"""Reader of the responses of a checked ICD (`icdgen.icd.responses`) on framed links, on
UART, I2C and CAN, into the classes of `icdgen.protocol.exchange`.

`exchange_of`, `request_exchange` and `bus_exchanges` are the entries. `Sources` finds
the places of numbers in the telemetry and packets that respond.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.buses import BusLink
from icdgen.icd.enumeration import Enum
from icdgen.icd.model import TELECOMMAND, Message, Node
from icdgen.icd.packets import ID_ROLE, Packets
from icdgen.icd.places import NodePlace
from icdgen.icd.responses import (
    AGAIN,
    HEADER,
    ID,
    ID_BYTES,
    MOST_SOURCES,
    NAK,
    REPLY,
    STATUS_SETS,
    Section,
    declared_responses,
    echoes_of,
    field_of,
    id_byte_of,
    number_of,
    number_run,
    reason_of,
    responses_in,
    status_of,
)
from icdgen.protocol.exchange import (
    BusExchanges,
    Echo,
    Exchange,
    NumberPlace,
    Response,
    ResponsePoll,
)
from icdgen.protocol.packet_formats import PacketField, PacketFormat


class Number(NamedTuple):
    """Number of a response: its place, and the enumeration of its values."""

    place: NumberPlace
    enum: Enum | None

    def raw(self, value: object) -> int | None:
        """Return a value, which is given as a number or as a member, without sign: as
        clients compare it. None if there is no such member.
        """
        number = number_of(value, self.enum)
        return None if number is None else number & (1 << self.place.bits) - 1

    @property
    def names(self) -> tuple[tuple[int, str], ...]:
        """Return the values with names, without sign."""
        mask = (1 << self.place.bits) - 1
        names: list[tuple[int, str]] = []
        for member in self.enum.members if self.enum else ():
            for value in range(member.value, member.last + 1):
                names.append((value & mask, member.name))
        return tuple(names)


class Sources(NamedTuple):
    """Messages and packets of a link that respond."""

    node: Node
    packets: Packets
    formats: tuple[PacketFormat, ...]  # of the packets, in the same order
    enums: Mapping[str, Enum]
    telemetry: Mapping[str, tuple[int, Message]]  # id and message, by name

    def packet_of(self, row: Section) -> int | None:
        """Return the index of the packet of a response; None for telemetry."""
        return self.packets.number_of(row.get("packet"))

    def number(self, row: Section, name: str | None) -> Number | None:
        """Return a number of a response; None without a name, or a field of it."""
        index = self.packet_of(row)
        if index is None:
            _, message = self.telemetry[row["message"]]
            field = field_of(message, name)
            place = place_of(self.node, field)
            return Number(place, field.scalar.enum) if field and place else None
        packet, form = self.packets.all[index], self.formats[index]
        declared = packet.named(name or "")
        if declared is None:
            return None
        (part,) = (
            field
            for field, each in zip(form.fields, packet.rows, strict=True)
            if each is declared
        )
        enum = self.enums.get(declared.get("enum", ""))
        return Number(_place_in_packet(form, part), enum)

    def in_header(self, packet: int, name: str) -> NumberPlace | None:
        """Return the place of a field in the header of a packet; None without one."""
        form, declared = self.formats[packet], self.packets.all[packet]
        for field, row in zip(form.fields, declared.rows, strict=True):
            if row is declared.named(name) and not field.in_trailer:
                return _place_in_packet(form, field)
        return None

    def id_parts(self, packet: int, name: str) -> list[tuple[NumberPlace, NumberPlace]]:
        """Return the place of each part of the id of a packet, with its place in
        `Exchange.sources`; none if ``name`` is not a field of the id.
        """
        form = self.formats[packet]
        declared = self.packets.all[packet].named(name) or {}
        if declared.get("role") != ID_ROLE:
            return []
        return [
            (
                _place_in_packet(form, part),
                NumberPlace(0, ID_BYTES, part.id_shift, part.bits, False),
            )
            for part in form.fields
            if part.role == ID_ROLE
        ]


def _place_in_packet(form: PacketFormat, part: PacketField) -> NumberPlace:
    """Return the place of a field in a packet without a message."""
    # The data have a fixed length.
    start = form.header_bytes + form.reserved if part.in_trailer else 0
    return NumberPlace(start + part.at, part.size, part.shift, part.bits, part.little)


def exchange_of(
    sources: Sources, commands: Section, message: Message
) -> Exchange | None:
    """Return the exchange of a telecommand; None if nothing responds to it."""
    # A model from the cache has plain mappings.
    own: Any = message.response
    timeout = own.get("timeout_ms", 0) if isinstance(own, Mapping) else 0
    rows = declared_responses(commands, message)
    (packet,) = sources.packets.packets_of_message(message.name, TELECOMMAND)[:1]
    number = sources.packets.all.index(packet)
    source_of = partial(_source, sources.node, message)
    reasons = commands.get("reasons", {})
    exchange = _exchange(
        sources, rows, source_of, timeout, number, reasons.get("checksum")
    )
    return exchange if exchange.responses else None


def request_exchange(sources: Sources, requests: Section) -> Exchange:
    """Return the exchange of a request of telemetry by a packet with its id: the
    requested telemetry, and what ``requests`` declares.
    """
    return _with_reply(
        _exchange(
            sources,
            responses_in(requests),
            partial(_id_source, sources.node),
            requests.get("timeout_ms", 0),
            sources.packets.number_of(sources.packets.requesting) or 0,
        )
    )


def bus_exchanges(sources: Sources, bus: BusLink) -> BusExchanges:
    """Return the exchanges on UART, I2C or CAN. ``sources`` has the packets of
    `BusLink.responses`.
    """
    id_of = partial(_id_source, sources.node)
    damage = bus.reasons.get("checksum")
    command = _exchange(sources, bus.commands, id_of, reason_of_damage=damage)
    request = _exchange(sources, bus.requests, id_of)
    return BusExchanges(command if command.responses else None, _with_reply(request))


def _with_reply(exchange: Exchange) -> Exchange:
    """Return an exchange to which the requested telemetry responds, too."""
    requested = Response(None, REPLY, (), None, (), None, ())
    return replace(exchange, responses=(requested, *exchange.responses))


def _exchange(
    sources: Sources,
    rows: Mapping[str, Section],
    source_of: Callable[[str], NumberPlace | None],
    timeout: int = 0,
    sent_in: int = 0,
    reason_of_damage: object = None,
) -> Exchange:
    """Return an exchange.

    ``rows``: responses by kind. ``source_of`` returns the place of what a response
    repeats. ``sent_in``: index of the packet that is sent. ``reason_of_damage``:
    that of a wrong checksum, after which a telecommand is sent again at once.
    """
    # Places that responses repeat, with whether the place is in the header.
    repeated_places: list[tuple[bool, NumberPlace]] = []
    responses, poll = [], None
    for kind, row in rows.items():
        packet = sources.packet_of(row)
        if packet is None and row.get("message") not in sources.telemetry:
            continue  # a mistake that rule ICD176 reports
        echoes = []
        for name, repeated in echoes_of(row).items():
            number = sources.number(row, name)
            in_header = repeated.startswith(HEADER)
            source = (
                sources.in_header(sent_in, repeated.removeprefix(HEADER))
                if in_header
                else source_of(repeated)
            )
            assert number and source, f"rule ICD177 checks {name} and {repeated}"
            pairs = [(number.place, source)]
            # Several fields of a packet can contain parts of the id. Each repeats its
            # own part.
            if packet is not None and repeated == ID:
                pairs = sources.id_parts(packet, name) or pairs
            for place, source in pairs:
                # Responses that repeat the same number share a source: `MOST_SOURCES`
                # limits their number.
                key = in_header, source
                if key not in repeated_places:
                    repeated_places.append(key)
                echoes.append(Echo(place, repeated_places.index(key)))
        telemetry = None if packet is not None else sources.telemetry[row["message"]][0]
        until = sources.number(row, row.get("until"))
        if until and telemetry is not None:
            poll = ResponsePoll(telemetry, until.place)
        detail = sources.number(row, row.get("detail"))
        status = sources.number(row, status_of(kind, row))
        reason = sources.number(row, reason_of(row))
        damage = None
        if reason and reason_of_damage is not None:
            damage = reason.raw(reason_of_damage)
        if damage is not None and kind == NAK:
            status = reason
        meanings = dict(_meanings(kind, row, status)) if status else {}
        if damage is not None and status == reason:
            meanings.setdefault(damage, AGAIN)
        responses.append(
            Response(
                telemetry,
                # A status that no set lists refuses the telecommand.
                NAK if status else kind,
                tuple(echoes),
                status and status.place,
                tuple(meanings.items()),
                reason and reason.place,
                reason.names if reason else (),
                packet,
                reason.enum if reason else None,
                detail and detail.place,
            )
        )
    assert len(repeated_places) <= MOST_SOURCES, "rule ICD177 checks the number"
    # `Exchange.sources` has the places in the header last, so the echoes get new indexes.
    order = sorted(
        range(len(repeated_places)), key=lambda source: repeated_places[source][0]
    )
    renumbered = []
    for response in responses:
        echoes_in_order = tuple(
            Echo(echo.place, order.index(echo.source)) for echo in response.echoes
        )
        renumbered.append(replace(response, echoes=echoes_in_order))
    places = tuple(repeated_places[source][1] for source in order)
    count = sum(is_in_header for is_in_header, _ in repeated_places)
    return Exchange(places, tuple(renumbered), timeout, count, poll)


def _id_source(node: Node, name: str) -> NumberPlace | None:
    """Return the place of the id, or of a byte of it, in `Exchange.sources`; None if the
    name is neither.
    """
    if name == ID:
        return NumberPlace(0, ID_BYTES, 0, 8 * ID_BYTES, False)
    byte = id_byte_of(node, name)
    return None if byte is None else NumberPlace(byte, 1, 0, 8, False)


def _source(node: Node, message: Message, name: str) -> NumberPlace | None:
    """Return the place of a number of a telecommand in `Exchange.sources`."""
    return _id_source(node, name) or place_of(node, field_of(message, name), ID_BYTES)


def place_of(
    node: Node, field: NodePlace | None, offset: int = 0
) -> NumberPlace | None:
    """Return the place of a number after ``offset`` bytes; None without a field, or if
    its bits are not one run in at most 4 bytes.
    """
    run = number_run(field, node) if field else None
    if field is None or run is None:
        return None
    return NumberPlace(offset + run.byte, run.size, run.shift, field.bits, run.little)


def _meanings(kind: str, row: Section, status: Number) -> Iterator[tuple[int, str]]:
    """Yield each listed value of the status, with its verdict."""
    for key, verdict in STATUS_SETS.items():
        for value in row.get(key, ()):
            raw = status.raw(value)
            if raw is not None:
                yield raw, verdict or kind
