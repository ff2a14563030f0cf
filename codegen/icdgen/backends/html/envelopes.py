"""The envelope of a link on its pages: what it looks like, what it adds to a message, and what scripts need to take it off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any, NamedTuple

from icdgen_runtime.wire.envelope import Direction
from icdgen_runtime.wire.stream import stream_encode

from icdgen.describe.ids import pair_bytes
from icdgen.describe.numbers import bit_range
from icdgen.icd.model import Message
from icdgen.icd.rules.wording import count
from icdgen.protocol.envelope import COBS, CRC, DATA, GIVEN, HDLC, LENGTH, PACKET, SLIP, Check, Stream
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Crc

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
_KINDS = {
    "fletcher": "Fletcher's, sums modulo 256",
    "fletcher_255": "Fletcher's, sums modulo 255",
    "sum": "sum of the bytes",
    "xor": "exclusive or of the bytes",
}


class Place(NamedTuple):
    """A field of the envelope: its role, where it stands, what it is for, and what it holds."""

    role: str
    place: str
    about: str
    holds: str


class Sum(NamedTuple):
    """A checksum: its parameters, and, of a CRC, what a calculator computes with."""

    name: str
    rows: list[tuple[str, str]]
    crc: Crc | None


def script_facts(form: Stream, message: Message | None = None) -> dict[str, object]:
    """What scripts need to know of the envelope; ``message``: only of its rows."""
    ids = None if message is None else set(message.ids)
    found: dict[str, object] = {
        "delimited_by": form.delimited_by,
        "header": form.header_bytes,
        "trailer": form.trailer_bytes,
        "plus": form.length_plus,
        "longest": form.longest,
        "given": GIVEN,
        "fields": [_field(field) for field in form.fields],
    }
    if form.check:
        found["check"] = _check(form.check)
    if size := pair_bytes(form):
        found["id_pairs"] = size
    for direction in ("telecommand", "telemetry"):
        rows = [row for row in form.rows(direction) if ids is None or row.id in ids]
        found[direction] = [[row.id, row.least, row.most, row.seed] for row in rows]
    return found


def _field(field: Any) -> dict[str, object]:
    names = ("role", "in_trailer", "at", "size", "shift", "bits", "little", "values")
    return {name: getattr(field, name) for name in names}


def _check(check: Check) -> dict[str, object]:
    places = {"from": check.covered_from, "trailer": check.covered_trailer, "seeded": check.is_seeded}
    return {"kind": check.kind, "crc": crc_numbers(check.crc), **places}


def crc_numbers(crc: Crc) -> dict[str, object]:
    """The parameters of a checksum that are known."""
    return {key: value for key, value in asdict(crc).items() if value is not None}


def boxes(section: Mapping[str, Any]) -> list[tuple[str, str, float, str]]:
    """Text, what is below it, share of the width and bits above, of each field and the data between."""
    form = section["stream"]
    return [*_boxes(form.get("header", ())), ("data", "", 3.0, ""), *_boxes(form.get("trailer", ()))]


def _boxes(rows: Any) -> Iterator[tuple[str, str, float, str]]:
    for row in sorted(rows, key=lambda row: int(row["at"])):
        yield row["role"], f"{row['bits']} bits", max(1.0, row["bits"] / 16), f"{row['at']}"


def places(section: Mapping[str, Any]) -> list[Place]:
    """Each field, in order."""
    form = section["stream"]
    return [
        Place(row["role"], f"{part}, {bit_range(row['at'], row['bits'])}", _about(row), _holds(row))
        for part in ("header", "trailer")
        for row in sorted(form.get(part, ()), key=lambda row: int(row["at"]))
    ]


def _about(row: Mapping[str, Any]) -> str:
    about = _ROLES.get(row["role"], "is the sender's choice")
    if row["role"] == "length":
        about += ": of header, data and trailer" if row.get("counts") == "message" else ": of the data"
        about += f", {'+' if row['plus'] > 0 else '−'} {abs(row['plus'])}" if row.get("plus") else ""
    if row["role"] == "sequence" and row.get("per") == "id":
        about += " of each id"
    return about + (f", {row['byte_order']} endian" if "byte_order" in row else "")


def _holds(row: Mapping[str, Any]) -> str:
    if row["role"] == "checksum":
        return str(row["checksum"])
    value = row.get("value")
    if isinstance(value, Mapping):
        return ", ".join(
            f"{_number(one)} in {direction}{'s' * (direction == 'telecommand')}" for direction, one in value.items()
        )
    return "" if value is None else _number(value)


def _number(value: int | list[int]) -> str:
    return " ".join(f"{byte:02X}" for byte in value) if isinstance(value, list) else f"{value} (0x{value:X})"


def sums(section: Mapping[str, Any], known: Facts) -> list[Sum]:
    """The checksums that have a name."""
    found = []
    for name, given in section.get("checksums", {}).items():
        form = known.stream.check if known.stream else None
        kind, covers = given["kind"], given["covers"]
        rows = [("Kind", f"CRC of {given['width']} bits" if kind == CRC else f"{_KINDS[kind]}, {given['width']} bits")]
        rows += [(key.replace("_", " ").capitalize(), _value(given[key])) for key in _PARAMETERS if key in given]
        rows.append(("Covers", _covered(covers)))
        if given.get("seeds"):
            said = ", ".join(f"{message} {seed}" for message, seed in given["seeds"].items())
            rows.append(("A byte after all others, by message", said))
        found.append(Sum(name, rows, form.crc if form and kind == CRC else None))
    return found


_PARAMETERS = ("polynomial", "init", "reflect_in", "reflect_out", "xor_out")


def _value(value: object) -> str:
    return ("yes" if value else "no") if isinstance(value, bool) else f"0x{value:X}"


def _covered(covers: Mapping[str, str]) -> str:
    first, last = covers["from"], covers["to"]
    return f"the {DATA}" if first == last == DATA else f"from the {first} to the {last}"


class Part(NamedTuple):
    """Bytes of the line, and what they are."""

    kind: str
    data: bytes
    title: str


def packet(form: Stream, link: Any, id: int, direction: Direction, data: bytes) -> list[Part]:
    """A message in its envelope, before anything is stuffed."""
    whole = stream_encode(link._replace(stream=link.stream._replace(delimited_by=PACKET)), id, data, direction)
    head, end = form.header_bytes, len(whole) - form.trailer_bytes
    before, behind = (", ".join(f.role for f in form.fields if f.in_trailer == where) for where in (False, True))
    parts = [
        Part("id", whole[:head], f"header: {before}"),
        Part("data", whole[head:end], f"data, {count(end - head, 'byte')}"),
        Part("crc", whole[end:], f"trailer: {behind}"),
    ]
    return [part for part in parts if part.data]
