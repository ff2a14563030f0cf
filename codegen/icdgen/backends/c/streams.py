"""The envelope of a node's link as values of the tables of the wire layer."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends.c.facts import boolean
from icdgen.protocol.envelope import COBS, HDLC, LENGTH, PACKET, SLIP, Check, Stream

DELIMITERS = {
    LENGTH: "ICD_DELIMITED_BY_LENGTH", SLIP: "ICD_DELIMITED_BY_SLIP", COBS: "ICD_DELIMITED_BY_COBS",
    HDLC: "ICD_DELIMITED_BY_HDLC", PACKET: "ICD_DELIMITED_BY_PACKET",
}  # fmt: skip


def field_rows(form: Stream) -> Iterator[str]:
    """The fields of header and trailer."""
    for one in form.fields:
        numbers = f"{one.at}u, {one.size}u, {one.shift}u, {one.bits}u"
        values = ", ".join(f"{value:#x}u" for value in one.values)
        role = f"ICD_ENVELOPE_{one.role.upper()}"
        yield f"{{{role}, {boolean(one.in_trailer)}, {numbers}, {boolean(one.little)}, {{{values}}}}}"


def covered(check: Check) -> str:
    """What the checksum covers."""
    return f"{check.covered_from}u, {check.covered_trailer}u, {boolean(check.is_seeded)}"


def sizes(form: Stream) -> list[tuple[str, int, str]]:
    """Sizes of buffers: name, bytes, what it is."""
    return [
        ("LONGEST", form.longest, "Bytes of a decoder's buffer: the longest message with its envelope."),
        ("LINE_BYTES", form.longest_line, "Most bytes of a message on the line."),
        ("SEQUENCES", form.sequences, "Numbers that a decoder remembers to notice gaps."),
        (
            "REQUEST_BYTES",
            form.longest_request,
            "Bytes of a client's buffer for each request, beside the longest message.",
        ),
    ]
