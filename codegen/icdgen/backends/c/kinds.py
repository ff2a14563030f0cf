"""Kinds of parts that the links of all nodes have.

The wire layer tests them as constants, so a compiler leaves out the code for kinds that
no node has.
"""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.c.stream_rows import content_name, stream_flags
from icdgen.describe.links import LinkDescription
from icdgen.frozen import NamedTuple
from icdgen.icd.responses import REPLY


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
    exchanges = [exchange for stream in streams for exchange in stream.exchanges]
    for each in facts:
        for bus in each.bus_exchanges.values():
            exchanges += [bus.request, *([bus.command] if bus.command else [])]
    verdicts = {
        verdict
        for exchange in exchanges
        for response in exchange.responses
        for verdict in (response.verdict, *(each for _, each in response.meanings))
    }
    verdicts.add(REPLY)  # a caller can specify a reply
    return [
        _kinds(
            "DELIMITERS",
            "ICD_DELIMITED_BY",
            (stream.delimited_by for stream in streams),
            "icd_delimiter_t",
        ),
        _kinds(
            "CHECKS",
            "ICD_CHECK",
            (checksum.kind for each in facts for checksum in each.checksums.values()),
            "icd_check_kind_t",
        ),
        _kinds(
            "CONTENTS",
            "ICD_PACKET",
            map(content_name, packets),
            "icd_packet_content_t",
        ),
        _kinds(
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
        _kinds("VERDICTS", "ICD_VERDICT", verdicts, "icd_verdict_t"),
    ]


def _kinds(name: str, prefix: str, kinds: Iterable[str], type: str) -> Kinds:
    bits = sorted(f"ICDGEN_BIT({prefix}_{kind.upper()})" for kind in {*kinds})
    return Kinds(name, bits, f"Of {type}.")
