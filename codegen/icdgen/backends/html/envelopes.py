"""Packet format of a link on the pages: its fields, the bytes that it adds to a
message, and data for scripts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any, NamedTuple

from icdgen_runtime.wire.envelope import Direction
from icdgen_runtime.wire.stream import stream_encode

from icdgen.describe.ids import pair_bytes
from icdgen.describe.numbers import bit_range
from icdgen.icd.model import Message
from icdgen.protocol.envelope import (
    COBS,
    CRC,
    DATA,
    GIVEN,
    HDLC,
    LENGTH,
    PACKET,
    SLIP,
    Check,
    Stream,
)
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Crc
from icdgen.wording import count

ENDS = {
    LENGTH: "where its length says",
    SLIP: "at the byte C0: in the message C0 is sent as DB DC, and DB as DB DD (SLIP, RFC 1055)",
    HDLC: "at the byte 7E: in the message 7E is sent as 7D 5E, and 7D as 7D 5D (HDLC, RFC 1662)",
    COBS: "at the byte 00; zeros in the message are stuffed (COBS)",
    PACKET: "with the packet that carries it",
}
_ROLES = {
    "sync": "begins a message",
    "constant": "is always the same",
    "id": "identifies the message",
    "length": "says how long it is",
    "sequence": "counts messages",
    "source": "says who sends",
    "destination": "says whom it is for",
    "checksum": "shows damage",
}
# Attributes of a field that the decoder in JavaScript reads.
_FIELD_KEYS = ("role", "in_trailer", "at", "size", "shift", "bits", "little", "values")
_KINDS = {
    "fletcher": "Fletcher's, sums modulo 256",
    "fletcher_255": "Fletcher's, sums modulo 255",
    "sum": "sum of the bytes",
    "xor": "exclusive or of the bytes",
}


class Place(NamedTuple):
    """Field of the packet format: role, position, purpose and value."""

    role: str
    place: str
    about: str
    holds: str


class Sum(NamedTuple):
    """Checksum with its parameters; for a CRC, also the parameters of the calculator."""

    name: str
    rows: list[tuple[str, str]]
    crc: Crc | None


def script_facts(form: Stream, message: Message | None = None) -> dict[str, object]:
    """Return the data on the packet format for scripts.

    ``message``: include only rows of this message.
    """
    # A message page contains only its own rows, which keeps it small.
    ids = None if message is None else set(message.ids)
    script_data: dict[str, object] = {
        "delimited_by": form.delimited_by,
        "header": form.header_bytes,
        "trailer": form.trailer_bytes,
        "plus": form.length_plus,
        "longest": form.longest,
        "given": GIVEN,
        "fields": [
            {name: getattr(field, name) for name in _FIELD_KEYS}
            for field in form.fields
        ],
    }
    if form.check:
        script_data["check"] = _check(form.check)
    if size := pair_bytes(form):
        script_data["id_pairs"] = size
    for direction in ("telecommand", "telemetry"):
        rows = [row for row in form.rows(direction) if ids is None or row.id in ids]
        script_data[direction] = [
            [row.id, row.least, row.most, row.seed] for row in rows
        ]
    return script_data


def _check(check: Check) -> dict[str, object]:
    places = {
        "from": check.covered_from,
        "trailer": check.covered_trailer,
        "seeded": check.is_seeded,
    }
    return {"kind": check.kind, "crc": crc_numbers(check.crc), **places}


def crc_numbers(crc: Crc) -> dict[str, object]:
    """Return the defined parameters of a checksum."""
    return {key: value for key, value in asdict(crc).items() if value is not None}


def boxes(section: Mapping[str, Any]) -> list[tuple[str, str, float, str]]:
    """Return text, subtitle, share of the width, and bit number of each field and of
    the data.
    """
    form = section["stream"]
    return [
        *_boxes(form.get("header", ())),
        ("data", "", 3.0, ""),
        *_boxes(form.get("trailer", ())),
    ]


def _boxes(rows: Any) -> Iterator[tuple[str, str, float, str]]:
    for row in sorted(rows, key=lambda row: int(row["at"])):
        # The minimum width leaves room for the name of the role.
        yield row["role"], f"{row['bits']} bits", max(
            1.0, row["bits"] / 16
        ), f"{row['at']}"


def places(section: Mapping[str, Any]) -> list[Place]:
    """Return each field, in order."""
    form = section["stream"]
    return [
        Place(
            row["role"],
            f"{part}, {bit_range(row['at'], row['bits'])}",
            _about(row),
            _holds(row),
        )
        for part in ("header", "trailer")
        for row in sorted(form.get(part, ()), key=lambda row: int(row["at"]))
    ]


def _about(row: Mapping[str, Any]) -> str:
    about = _ROLES.get(row["role"], "is the sender's choice")
    if row["role"] == "length":
        about += (
            ": of header, data and trailer"
            if row.get("counts") == "message"
            else ": of the data"
        )
        about += (
            f", {'+' if row['plus'] > 0 else '−'} {abs(row['plus'])}"
            if row.get("plus")
            else ""
        )
    if row["role"] == "sequence" and row.get("per") == "id":
        about += " of each id"
    return about + (f", {row['byte_order']} endian" if "byte_order" in row else "")


def _holds(row: Mapping[str, Any]) -> str:
    if row["role"] == "checksum":
        return str(row["checksum"])
    value = row.get("value")
    if isinstance(value, Mapping):
        return ", ".join(
            f"{_number(number)} in {direction}{'s' * (direction == 'telecommand')}"
            for direction, number in value.items()
        )
    return "" if value is None else _number(value)


def _number(value: int | list[int]) -> str:
    return (
        " ".join(f"{byte:02X}" for byte in value)
        if isinstance(value, list)
        else f"{value} (0x{value:X})"
    )


def sums(section: Mapping[str, Any], node_facts: Facts) -> list[Sum]:
    """Return the named checksums."""
    checksums = []
    for name, declaration in section.get("checksums", {}).items():
        form = node_facts.stream.check if node_facts.stream else None
        kind, covers = declaration["kind"], declaration["covers"]
        rows = [
            (
                "Kind",
                (
                    f"CRC of {declaration['width']} bits"
                    if kind == CRC
                    else f"{_KINDS[kind]}, {declaration['width']} bits"
                ),
            )
        ]
        rows += [
            (key.replace("_", " ").capitalize(), _value(declaration[key]))
            for key in _PARAMETERS
            if key in declaration
        ]
        rows.append(("Covers", _covered(covers)))
        if declaration.get("seeds"):
            seeds = ", ".join(
                f"{message} {seed}" for message, seed in declaration["seeds"].items()
            )
            rows.append(("A byte after all others, by message", seeds))
        checksums.append(Sum(name, rows, form.crc if form and kind == CRC else None))
    return checksums


_PARAMETERS = ("polynomial", "init", "reflect_in", "reflect_out", "xor_out")


def _value(value: object) -> str:
    return ("yes" if value else "no") if isinstance(value, bool) else f"0x{value:X}"


def _covered(covers: Mapping[str, str]) -> str:
    first, last = covers["from"], covers["to"]
    return f"the {DATA}" if first == last == DATA else f"from the {first} to the {last}"


class Part(NamedTuple):
    """Transmitted bytes with their meaning."""

    kind: str
    data: bytes
    title: str


def packet(
    form: Stream, link: Any, id: int, direction: Direction, data: bytes
) -> list[Part]:
    """Return the parts of a message in its packet format, before byte stuffing."""
    # Without delimiter: byte stuffing would move the borders of the parts.
    packet_bytes = stream_encode(
        link._replace(stream=link.stream._replace(delimited_by=PACKET)),
        id,
        data,
        direction,
    )
    head, end = form.header_bytes, len(packet_bytes) - form.trailer_bytes
    before, behind = (
        ", ".join(f.role for f in form.fields if f.in_trailer == where)
        for where in (False, True)
    )
    parts = [
        Part("id", packet_bytes[:head], f"header: {before}"),
        Part("data", packet_bytes[head:end], f"data, {count(end - head, 'byte')}"),
        Part("crc", packet_bytes[end:], f"trailer: {behind}"),
    ]
    return [part for part in parts if part.data]
