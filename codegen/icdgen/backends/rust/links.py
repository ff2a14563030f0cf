"""Links: the protocol facts of a node as the constant ``LINK`` of its module, and sizes
of buffers for all nodes.

Input is a `LinkDescription`; output is one nested struct expression of the types in
``runtime/rust/src/wire/link``. Packet formats and responses are in
`icdgen.backends.rust.streams`.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.literals import Brackets, Item, written
from icdgen.backends.rust import procedures
from icdgen.backends.rust.facts import member_name, type_name, value_of
from icdgen.backends.rust.literals import (
    Expression,
    flat,
    flat_rows,
    members,
    part,
    rows,
    some,
    spelled,
    struct,
)
from icdgen.backends.rust.streams import (
    algorithm_of,
    bus_exchanges_of,
    crc_tables,
    stream_of,
)
from icdgen.backends.rust.text import doc, integer, prose, string
from icdgen.describe import FieldDescription
from icdgen.describe.comments import sentence
from icdgen.describe.links import (
    CAN_PARTS,
    INDEX_PARTS,
    Assumptions,
    LinkDescription,
    ReportDescription,
    SentMessage,
)
from icdgen.protocol.declared import facts_of
from icdgen.protocol.sections import CAN_KINDS

_RENAMED = {"type": "kind", "channel": "id"}  # `type` is a keyword


def values(link: LinkDescription) -> dict[str, object]:
    """Return the values for the template of a link.

    ``tables`` has the name and the CRC of each lookup table.
    """
    facts, link_literal = link.facts, _LinkLiteral(link)
    text = written(link_literal.link_expression(), _note)
    about = [
        f"The protocol of node `{facts.node.name}`. Facts that the manual omits are marked as assumed."
    ]
    for section, key, why in link_literal.assumed.remaining():
        if section.startswith(procedures.SECTION):
            continue  # the module of the procedures shows it
        about.append(f"Assumed (`{section}`, `{key}`): {prose(sentence(why))}")
    tables = crc_tables(facts.stream)
    return {
        "node": facts.node.name,
        "doc": doc(about),
        "literal": text,
        "longest": integer(longest_buffer(link)),
        "sequences": integer(facts.stream.sequences) if facts.stream else "",
        "tables": [(name, written(crc, _note)) for crc, name in tables.items()],
    }


def longest_buffer(link: LinkDescription) -> int:
    """Return the size of each buffer of the wire layer: the longest message, CAN
    packets of a message, or entry of a log.
    """
    log = link.facts.log_file
    header = log.header_bytes if log and link.facts.mask else 0
    return max(link.facts.longest, link.joined_bytes, link.log_entry_bytes, header)


def _note(why: str, indent: str) -> str:
    return doc([f"Assumed. {prose(sentence(why))}"], indent, "//")


class _LinkLiteral:
    """Expression of the link of a node."""

    def __init__(self, link: LinkDescription) -> None:
        self.description = link
        self.facts = link.facts
        self.assumed = Assumptions(link.facts)

    def link_expression(self) -> Brackets:
        facts, link = self.facts, self.description
        packet = facts.acknowledge
        # Before the checksums: it shows the assumptions about its use.
        checksum = self.checksum_form()
        unsolicited = (
            f"({integer(first)}, {integer(id)})"
            for first, id in sorted(facts.unsolicited.items())
        )
        return struct(
            "Link",
            part("node", string(facts.node.name)),
            part("node_type", some(facts.node.node_type)),
            part("interface_version", some(facts.node.interface_version)),
            part("longest", integer(facts.longest)),
            part("longest_data", integer(facts.longest_data)),
            part("little", spelled(facts.little)),
            part("telemetry_ids", flat("Ids", **members(facts.telemetry_ids))),
            part("telecommands", rows(map(_message_form, link.telecommands))),
            part("telemetry", rows(map(_message_form, link.telemetry))),
            part("client", self.struct_of_facts(facts.client) or ""),
            part("reasons", flat_rows(map(integer, link.reasons))),
            part("framing", some(self.struct_of_facts(facts.framing))),
            part(
                "acknowledge_bytes",
                some(packet.overhead if packet else None),
                self.assumed.why(f"link.packets.{packet.name}", "header")
                if packet
                else "",
            ),
            part("i2c_address", some(facts.i2c_address)),
            part("i2c_repeated_start", spelled(facts.i2c_repeated_start)),
            part("can", some(self.can_form())),
            part("checksums", rows(self.checksum_pairs())),
            part("checksum", some(checksum)),
            part("mask", some(self.mask_form())),
            part("log_file", some(self.struct_of_facts(facts.log_file))),
            part(
                "log_message",
                some(self.struct_of_facts(facts.log_message)),
                self.assumed.why("unsolicited_log", "framed"),
            ),
            part("time", some(self.time_form())),
            part("index", some(self.index_form())),
            part("unsolicited", flat_rows(unsolicited)),
            part("exchanges", bus_exchanges_of(facts.bus_exchanges)),
            part("identification", some(_identification(link.identification))),
            part("boot_ms", some(facts.boot_ms)),
            part("stream", some(stream_of(facts.stream) if facts.stream else None)),
        )

    def struct_of_facts(self, declared: object, *further: Item) -> Brackets | None:
        """Return the facts of a part as a struct, with further items."""
        if declared is None:
            return None
        items = []
        for fact in facts_of(declared):
            items.append(
                part(
                    member_name(fact),
                    value_of(fact, declared),
                    self.assumed.why_fact(declared, fact),
                )
            )
        return struct(type_name(type(declared)), *items, *further)

    def can_form(self) -> Brackets | None:
        can = self.description.can
        if can is None:
            return None
        parts = (
            part(_RENAMED.get(role, role), flat("CanPart", **members(can.parts[role])))
            for role in CAN_PARTS
        )
        extended = self.struct_of_facts(
            can.extended, part("types", _can_types(can.extended_types))
        )
        return self.struct_of_facts(
            can,
            *parts,
            part("types", _can_types(can.types)),
            part("extended", some(extended)),
        )

    def checksum_pairs(self) -> Iterator[str]:
        for name, algorithm in self.facts.checksums.items():
            yield f"({string(name)}, {written(algorithm_of(algorithm), _note)})"

    def checksum_form(self) -> Brackets | None:
        form = self.facts.checksum
        return (
            self.struct_of_facts(form, part("algorithm", algorithm_of(form.algorithm)))
            if form
            else None
        )

    def mask_form(self) -> Brackets | None:
        mask = self.facts.mask
        if mask is None:
            return None
        bits = (
            flat("LogBit", **{**members(row), "name": string(row.name or "")})
            for _, row in sorted(mask.bits.items())
            if row.id is not None
        )
        return self.struct_of_facts(
            mask,
            part("bits", rows(bits), self.assumed.why("log_mask", "unassigned_bits")),
        )

    def time_form(self) -> Brackets | None:
        parts = [
            part(name, flat("TimePart", **members(time_part)))
            for name, time_part in self.description.time
        ]
        return struct("TimeForm", *parts) if parts else None

    def index_form(self) -> Brackets | None:
        form = self.description.index
        fields = [(name, form.fields[name]) for name in INDEX_PARTS] if form else []
        spans = (
            part(_RENAMED.get(name, name), flat("Span", **members(span)))
            for name, span in fields
        )
        return self.struct_of_facts(form, *spans)


def _message_form(sent: SentMessage) -> Brackets:
    message = sent.message
    return flat(
        "Form",
        id=sent.id,
        length=message.length,
        acknowledged=message.acknowledge,
        repeatable=sent.is_setting,
    )


def _can_types(types: dict[str, int]) -> Brackets:
    return struct(
        "CanTypes", *(part(name, some(types.get(name))) for name in CAN_KINDS)
    )


def _number_pieces(field: FieldDescription) -> Expression:
    """Return the position of a number."""
    return flat_rows(flat("Piece", **piece._asdict()) for piece in field.pieces)


def _identification(report: ReportDescription | None) -> Brackets | None:
    if report is None:
        return None
    fields = {place.role: place.field for place in report.places}
    return struct(
        "Identification",
        part("length", integer(report.message.length)),
        *(
            part(role, _number_pieces(fields[role]) if role in fields else "&[]")
            for role in ("node_type", "interface_version")
        ),
    )
