"""Link of a node as a tree of constructor calls, with the types and keywords of
``wire/link.py`` in the Python runtime.

The Python backend writes the calls into generated code. `icdgen.runtime_objects`
evaluates them, so that the commands of icdgen have the same link without generating
code. A call has the name of the class of the part: `icdgen.protocol.sections` uses the
names of the runtime.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

from icdgen.describe.links import Assumptions, LinkDescription, SentMessage
from icdgen.icd.model import Message
from icdgen.protocol.declared import facts_of
from icdgen.protocol.exchange import BusExchanges, Exchange, NumberPlace, Response
from icdgen.protocol.packet_formats import (
    MESSAGE,
    Escaping,
    PacketField,
    PacketFormat,
    Stream,
    StreamRow,
    TelemetryRequest,
)
from icdgen.protocol.procedures import (
    Blocks,
    Input,
    Output,
    PacketMap,
    Procedure,
    Send,
)
from icdgen.protocol.sections import (
    ChecksumAlgorithm,
    Crc,
    LogFile,
    LogMessage,
    Report,
)

# Types that have another name in generated code.
_TYPES = {Crc: "CrcForm", LogFile: "LogFileForm", LogMessage: "LogMessageForm"}


def type_name(part: type) -> str:
    """Return the name of the type of a part of the link in the module ``link``."""
    return _TYPES.get(part, part.__name__)


@dataclass(frozen=True, slots=True)
class Call:
    """Call ``name(positional, keyword=value)``."""

    name: str
    positional: tuple[object, ...] = ()
    keywords: Mapping[str, object] = field(default_factory=dict)
    is_flat: bool = False  # written on one line


@dataclass(frozen=True, slots=True)
class Verbatim:
    """Name that the generated code defines elsewhere, such as ``TELEMETRY``."""

    text: str


@dataclass(frozen=True, slots=True)
class Commented:
    """Item of a call or a mapping, with comments above it."""

    item: object
    comments: tuple[str, ...]


def link_call(link: LinkDescription) -> Call:
    """Return the call that makes the link.

    Assumed values have the reason in a comment above them.
    """
    return _LinkBuilder(link).link()


def _call(name: str, /, **keywords: object) -> Call:
    """Return the call of a type of the module ``link``."""
    return Call(f"link.{name}", (), keywords)


def _row(name: str, *positional: object, **keywords: object) -> Call:
    """Return the call of a type of the module ``link``, written on one line."""
    return Call(f"link.{name}", positional, keywords, is_flat=True)


class _LinkBuilder:
    """Builds the calls for the parts of a link."""

    def __init__(self, link: LinkDescription) -> None:
        self.description, self.facts = link, link.facts
        self.assumed = Assumptions(link.facts)

    def link(self) -> Call:
        """Return the call of ``Link``."""
        facts, node = self.facts, self.facts.node
        parts: dict[str, object] = {
            "node": node.name,
            "order": "little" if facts.little else "big",
            "node_type": node.node_type,
            "interface_version": node.interface_version,
            "longest": facts.longest,
            "longest_data": facts.longest_data,
            "telemetry_ids": (facts.telemetry_ids.first, facts.telemetry_ids.last),
            "settings": self.part(facts.client),
            "commands": {
                each.id: self.sent(each) for each in self.description.telecommands
            },
            "frames": {
                each.id: each.message.length for each in self.description.telemetry
            },
            "TELECOMMANDS": Verbatim("TELECOMMANDS"),
            "TELEMETRY": Verbatim("TELEMETRY"),
        }
        # Before the checksums: the reasons for assumptions about its use are here.
        checksum = self.checksum()
        time = {name: _flat("TimePart", part) for name, part in facts.time.items()}
        # None: the link has no such part, and the keyword is omitted.
        optional = {
            "framing": self.part(facts.framing),
            "acknowledge_bytes": self.acknowledge(),
            "i2c_address": facts.i2c_address,
            # True is the default of the runtime.
            "i2c_repeated_start": None if facts.i2c_repeated_start else False,
            "can": self.can(),
            "checksums": self.checksums() or None,
            "checksum": checksum,
            "mask": self.mask(),
            "log_file": self.part(facts.log_file),
            "log_message": self.part(facts.log_message),
            "time": self.with_section_reasons(time or None, "msdos_time"),
            "index_file": self.index(),
            "identification": facts.identification
            and self.report(facts.identification),
            "statistics": facts.statistics and self.report(facts.statistics),
            "boot_time": facts.boot_ms,
            "stream": self.with_section_reasons(
                facts.stream and _stream(facts.stream), "link"
            ),
            "procedures": {
                each.name: _commented(
                    _procedure(each),
                    self.assumed.of_section_tree(f"procedures.{each.name}"),
                )
                for each in facts.procedures
            }
            or None,
            "unsolicited": facts.unsolicited or None,
            "bus_exchanges": {
                bus: self.with_section_reasons(
                    _bus_exchanges(each), f"link.buses.{bus}.commands.ack"
                )
                for bus, each in facts.bus_exchanges.items()
            }
            or None,
            "assumptions": self.assumptions() or None,
        }
        return _call(
            "Link",
            **parts,
            **{key: part for key, part in optional.items() if part is not None},
        )

    def with_section_reasons(self, value: object, section: str) -> object:
        """Return a value, with the reasons for assumptions of a section that no comment
        of its keys has.
        """
        return _commented(
            value, self.assumed.of_section(section) if value is not None else []
        )

    def part(self, part: object, **computed: object) -> object:
        """Return the call for a part of the link: its declared facts, then the keywords
        of ``computed``.
        """
        if part is None:
            return None
        call = _call(type_name(type(part)), **self.declared(part), **computed)
        return _commented(call, self.assumed.of_part(part))

    def declared(self, part: object) -> dict[str, object]:
        """Return the declared facts of a part that have a value."""
        values: dict[str, object] = {}
        for fact in facts_of(part):
            value = getattr(part, fact.name)
            if value is not None:
                values[fact.name] = _explained(value, self.assumed.why_fact(part, fact))
        return values

    def acknowledge(self) -> object:
        """Return the length of the acknowledge on the UART."""
        packet = self.facts.acknowledge
        return packet and self.with_section_reasons(
            packet.overhead, f"link.packets.{packet.name}"
        )

    def can(self) -> object:
        """Return the call for the link over CAN."""
        can = self.facts.can
        if can is None:
            return None
        parts = {role: _flat("CanPart", part) for role, part in can.parts.items()}
        computed = {
            "parts": _explained(
                parts, self.assumed.why("link.buses.can", "identifier")
            ),
            "types": can.types,
            "extended_types": can.extended_types,
        }
        computed |= {"extended": self.part(can.extended)} if can.extended else {}
        return self.part(can, **computed)

    def checksums(self) -> dict[str, object]:
        """Return the calls for the checksums by name."""
        calls: dict[str, object] = {}
        for name, algorithm in self.facts.checksums.items():
            crc = _call("CrcForm", **self.declared(algorithm.crc))
            call = _call("ChecksumAlgorithm", kind=algorithm.kind, crc=crc)
            calls[name] = _commented(call, self.assumed.of_section(algorithm.section))
        return calls

    def checksum(self) -> object:
        """Return the call for the checksum of messages."""
        form = self.facts.checksum
        if form is None:
            return None
        call = self.part(form, name=form.algorithm.name)
        return _commented(call, self.assumed.of_section_tree("link.packets"))

    def mask(self) -> object:
        """Return the call for the log mask."""
        mask = self.facts.mask
        if mask is None:
            return None
        bits = {
            bit: _row("LogBit", row.bit, row.id, row.length, row.name or "")
            for bit, row in sorted(mask.bits.items())
        }
        return self.part(mask, bits=bits)

    def index(self) -> object:
        """Return the call for the index of files."""
        index = self.facts.index
        if index is None:
            return None
        fields = {role: (field.at, field.bytes) for role, field in index.fields.items()}
        return self.part(index, fields=fields)

    def report(self, report: Report) -> Call:
        """Return the call for telemetry that the link reads."""
        message = report.message
        ids = {"telecommand": message.telecommand_id, "telemetry": message.telemetry_id}
        fields = {
            role: field.name for role, field in self.description.report(report).places
        }
        return _call(
            "Report",
            **{key: id for key, id in ids.items() if id is not None},
            fields=fields,
        )

    def sent(self, telecommand: SentMessage) -> object:
        """Return the call for the length and the acknowledge of a telecommand."""
        flags = {} if telecommand.message.acknowledge else {"acknowledged": False}
        flags |= {"setting": True} if telecommand.is_setting else {}
        message = telecommand.message
        return self.with_section_reasons(
            _row("Sent", message.length, **flags), f"message {message.name}"
        )

    def assumptions(self) -> tuple[Call, ...]:
        """Return the calls for all assumptions of the ICD."""
        return tuple(
            _call(
                "Assumption",
                section=each.section,
                key=each.key,
                value=_plain(each.value),
                why=str(each.why),
            )
            for each in self.facts.assumptions
        )


def _explained(value: object, why: str) -> object:
    """Return a value, with the reason as a comment if it is an assumption of the ICD."""
    return Commented(value, (f"Assumed: {why}",)) if why else value


def _commented(value: object, reasons: list[tuple[str, str]]) -> object:
    """Return a value, with keys and reasons as comments."""
    if not reasons:
        return value
    return Commented(value, tuple(f"Assumed, {key}: {why}" for key, why in reasons))


def _stream(form: Stream) -> Call:
    """Return the framing of sync, header, payload and checksum."""
    parts = _members(form)
    parts["packets"] = tuple(map(_packet, form.packets))
    parts["telecommands"] = _stream_rows(form.telecommands, form.exchanges)
    # Telemetry has no exchange of its own: the packet that requests it has.
    parts["telemetry"] = _stream_rows(form.telemetry, ())
    request, escaping = parts.pop("request"), parts.pop("escaping")
    if isinstance(request, TelemetryRequest):
        # Many messages share an exchange, so rows have its index in the list.
        exchange = form.exchanges.index(request.exchange)
        parts["request"] = _row("TelemetryRequest", request.packet, exchange)
    if form.exchanges:
        parts["exchanges"] = tuple(map(_exchange, form.exchanges))
        parts["confirming"] = form.confirming
    if isinstance(escaping, Escaping):
        parts["escaping"] = _call("Escaping", **_members(escaping))
    return _call("Stream", **parts)


def _packet(packet: PacketFormat) -> Call:
    """Return the call for a packet format."""
    parts: dict[str, object] = {
        "header_bytes": packet.header_bytes,
        "trailer_bytes": packet.trailer_bytes,
        "fields": tuple(map(_packet_field, packet.fields)),
    }
    if packet.check:
        check = _members(packet.check)
        algorithm = packet.check.algorithm
        del check["algorithm"]
        parts["check"] = _row(
            "CheckForm", algorithm.kind, _crc(algorithm.crc), *check.values()
        )
    # A link with one packet format needs no name for it.
    if packet.name:
        parts |= {"name": packet.name, "directions": packet.directions}
    if packet.content != MESSAGE:
        parts["content"] = packet.content
    if packet.reserved:
        parts["reserved"] = packet.reserved
    return _call("PacketForm", **parts)


def _crc(crc: Crc) -> Call:
    """Return the call for the parameters of a CRC, on one line."""
    declared = {fact.name: getattr(crc, fact.name) for fact in facts_of(crc)}
    return _row(
        "CrcForm", **{key: each for key, each in declared.items() if each is not None}
    )


def _packet_field(field: PacketField) -> Call:
    """Return the call for a field of a header or trailer."""
    parts = _members(field)
    defaults = {"id_shift": 0, "unit": 1, "plus": 0}
    # By keyword and only if needed: most fields of a header have the defaults.
    own = {name: parts.pop(name) for name in defaults}
    more = {name: value for name, value in own.items() if value != defaults[name]}
    return _row("PacketField", *parts.values(), **more)


def _stream_rows(
    rows: tuple[StreamRow, ...], exchanges: tuple[Exchange, ...]
) -> tuple[Call, ...]:
    """Return the calls for the messages of a direction."""
    calls = []
    for row in rows:
        more: dict[str, object] = {}
        if row.exchange:
            more["exchange"] = exchanges.index(row.exchange)
        if row.repeats:
            more["repeats"] = True
        if row.requests is not None:
            more["requests"] = row.requests
        if row.packet:
            more["packet"] = row.packet
        if row.is_requested:
            more["is_requested"] = True
        calls.append(
            _row(
                "StreamRow",
                row.id,
                row.least,
                row.most,
                row.cuts_zeros,
                row.seed,
                **more,
            )
        )
    return tuple(calls)


def _bus_exchanges(exchanges: BusExchanges) -> Call:
    """Return the call for the exchanges on a bus."""
    parts = {"request": _exchange(exchanges.request)}
    if exchanges.command:
        parts["command"] = _exchange(exchanges.command)
    return _call("BusExchanges", **parts)


def _exchange(exchange: Exchange) -> Call:
    """Return the call for the responses to a telecommand."""
    parts: dict[str, object] = {
        "sources": tuple(map(_number_place, exchange.sources)),
        "responses": tuple(map(_response, exchange.responses)),
    }
    if exchange.timeout:
        parts["timeout"] = exchange.timeout
    if exchange.in_header:
        parts["in_header"] = exchange.in_header
    if exchange.poll:
        until = _number_place(exchange.poll.until)
        parts["poll"] = _row("ResponsePoll", exchange.poll.telemetry, until)
    return _call("Exchange", **parts)


def _response(response: Response) -> Call:
    places = {
        "status": response.status,
        "reason": response.reason,
        "detail": response.detail,
    }
    echoes = tuple(
        _row("Echo", _number_place(echo.place), echo.source) for echo in response.echoes
    )
    optional = {
        "echoes": echoes,
        **{key: place and _number_place(place) for key, place in places.items()},
        "meanings": response.meanings,
        "reasons": response.reasons,
    }
    return _call(
        "Response",
        telemetry=response.telemetry,
        verdict=response.verdict,
        **{key: value for key, value in optional.items() if value},
        **({} if response.packet is None else {"packet": response.packet}),
    )


def _procedure(procedure: Procedure) -> Call:
    """Return the call for a procedure."""
    blocks, entry = procedure.blocks, procedure.entry
    parts: dict[str, object] = {
        "inputs": tuple(map(_input, procedure.inputs)),
        "outputs": tuple(map(_output, procedure.outputs)),
        "registers": procedure.registers,
        "time": procedure.time,
        "requests": procedure.requests,
        "steps": tuple(map(_step_row, procedure.steps)),
    }
    if blocks:
        parts["blocks"] = _call(
            "Blocks", **{**_members(blocks), "map": _packet_map(blocks)}
        )
    if entry:
        parts |= {
            "entry": entry.telemetry_id,
            "most_entries": procedure.most_entries,
        }
    return _call("ProcedureForm", **parts)


def _input(each: Input) -> Call:
    defaults = {"is_bytes": False, "values": (), "is_optional": False}
    members = {"is_bytes": each.is_bytes, "most": each.most, "values": each.values}
    members["is_optional"] = each.is_optional
    own = {key: part for key, part in members.items() if part != defaults.get(key)}
    return _row("Input", each.name, **own)


def _output(each: Output) -> Call:
    return _row("Output", each.name, each.register)


def _packet_map(blocks: Blocks) -> Call | None:
    """Return the call for the map of received packets."""
    form: PacketMap | None = blocks.map
    if form is None:
        return None
    members = _members(form)
    # The runtime has no objects of messages: it needs their ids and length.
    del members["messages"]
    return _call(
        "PacketMap",
        telecommands=_ids(message.telecommand_id for message in form.messages),
        telemetry=_ids(message.telemetry_id for message in form.messages),
        length=form.messages[0].length,
        **members,
    )


def _ids(ids: Iterable[int | None]) -> tuple[int, ...]:
    return tuple(id for id in ids if id is not None)


_STEP_DEFAULTS: dict[str, object] = {
    "puts": (),
    "packet_at": None,
    "repeats": False,
    "ignores_timeout": False,
    "requested_on": (),
}
"""Defaults of members of steps in ``wire/procedure_forms.py``."""


def _step_row(step: object) -> Call:
    """Return the call for a step of a procedure. Its message is an id."""
    members = {}
    for name, member in _members(step).items():
        if isinstance(member, Message):
            is_sent = isinstance(step, Send)
            name = "telecommand" if is_sent else "telemetry"
            member = member.telecommand_id if is_sent else member.telemetry_id
        if isinstance(member, ChecksumAlgorithm):
            name, member = "checksum", member.name
        if name not in _STEP_DEFAULTS or member != _STEP_DEFAULTS[name]:
            members[name] = _step_part(member)
    # A step with several fields has a line for each.
    is_flat = not any(isinstance(each, tuple) and each for each in members.values())
    return Call(f"link.{type(step).__name__}", (), members, is_flat)


def _step_part(part: object) -> object:
    """Return a member of a step: a call for each part that is an object."""
    if isinstance(part, tuple):
        return tuple(map(_step_part, part))
    if isinstance(part, NumberPlace):
        return _number_place(part)
    if isinstance(part, Crc):
        return _crc(part)
    if is_dataclass(part):
        parts = map(_step_part, _members(part).values())
        return _row(type(part).__name__, *parts)
    return part


def _number_place(place: NumberPlace) -> Call:
    return _row("NumberPlace", *_members(place).values())


def _flat(name: str, part: Any) -> Call:
    """Return the call for a small part, with all its members."""
    return _row(name, **_members(part))


def _members(part: Any) -> dict[str, object]:
    """Return the members of a dataclass object by name."""
    return {member.name: getattr(part, member.name) for member in fields(part)}


def _plain(value: object) -> object:
    """Return a value of the ICD as plain tuples, dicts and scalars, without places."""
    if isinstance(value, dict):
        return {
            _plain(key): _plain(item)
            for key, item in value.items()
            if key not in ("assumptions", "source")
        }
    if isinstance(value, list | tuple):
        return tuple(_plain(item) for item in value)
    # Before `int`, because a bool is an int in Python.
    if isinstance(value, bool) or value is None:
        return value
    for kind in (str, int, float):
        if isinstance(value, kind):
            return kind(value)
    return str(value)
