"""Kinds of parts that the links of all nodes have.

The wire layer tests them as constants, so a compiler leaves out the code for kinds that
no node has.
"""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.c.facts import MOST_SIGNED
from icdgen.backends.c.stream_rows import content_name, stream_flags
from icdgen.describe.links import LinkDescription
from icdgen.frozen import NamedTuple
from icdgen.icd.responses import REPLY
from icdgen.protocol.exchange import Exchange


class Kinds(NamedTuple):
    """Kinds of parts: name of the mask, its bits, and a comment."""

    name: str
    bits: list[str]
    about: str


def kinds_of(links: Iterable[LinkDescription]) -> list[Kinds]:
    """Return the kinds of parts of these links."""
    facts = [link.facts for link in links]
    streams = [each.stream for each in facts if each.stream]
    packets = [packet for stream in streams for packet in stream.packets]
    rows = [
        (stream, row)
        for stream in streams
        for row in (*stream.telecommands, *stream.telemetry)
    ]
    exchanges = [exchange for each in facts for exchange in each.exchanges]
    verdicts = {REPLY}  # a caller can specify a reply
    for exchange in exchanges:
        for response in exchange.responses:
            verdicts.add(response.verdict)
            verdicts.update(verdict for _, verdict in response.meanings)
    return [
        _kinds_with_prefix(
            "DELIMITERS",
            "ICD_DELIMITED_BY",
            (stream.delimited_by for stream in streams),
            "icd_delimiter_t",
        ),
        _kinds_with_prefix(
            "CHECKS",
            "ICD_CHECK",
            (checksum.kind for each in facts for checksum in each.checksums.values()),
            "icd_check_kind_t",
        ),
        _kinds_with_prefix(
            "CONTENTS",
            "ICD_PACKET",
            map(content_name, packets),
            "icd_packet_content_t",
        ),
        _kinds_with_prefix(
            "ROLES",
            "ICD_FIELD",
            (field.role for packet in packets for field in packet.fields),
            "icd_field_role_t",
        ),
        Kinds(
            "STREAM_FLAGS",
            sorted(
                {flag for stream, row in rows for flag in stream_flags(stream, row)}
            ),
            "Flags of messages in packets.",
        ),
        _kinds_with_prefix("VERDICTS", "ICD_VERDICT", verdicts, "icd_verdict_t"),
        Kinds("RESPONSES", _response_parts(exchanges), "Parts of responses."),
        _kinds_with_prefix(
            "BUSES",
            "ICD_BUS",
            (bus for each in facts for bus in each.bus_exchanges),
            "icd_bus_t",
        ),
    ]


def _response_parts(exchanges: Iterable[Exchange]) -> list[str]:
    parts = set()
    for exchange in exchanges:
        parts |= {"ECHO"} if exchange.sources else set()
        parts |= {"HEADER_ECHO"} if exchange.in_header else set()
        for response in exchange.responses:
            parts |= {"STATUS"} if response.status else set()
            parts |= {"REASON"} if response.reason else set()
            parts |= {"DETAIL"} if response.detail else set()
    return [f"ICDGEN_RESPONSE_{part}" for part in sorted(parts)]


def length_type(links: Iterable[LinkDescription]) -> str:
    """Return the type that holds the number of data bytes that any length field of these
    links says.
    """
    largest = 0
    for stream in (link.facts.stream for link in links if link.facts.stream):
        largest = max(largest, stream.longest)
        for packet in stream.packets:
            for field in packet.fields:
                if field.role in ("length", "response_length"):
                    size = field.mask * field.unit + abs(field.plus) + packet.overhead
                    largest = max(largest, size)
    return "int_fast32_t" if largest <= MOST_SIGNED else "int64_t"


def _kinds_with_prefix(
    name: str, prefix: str, kinds: Iterable[str], type: str
) -> Kinds:
    bits = sorted(f"ICDGEN_BIT({prefix}_{kind.upper()})" for kind in {*kinds})
    return Kinds(name, bits, f"Of {type}.")
