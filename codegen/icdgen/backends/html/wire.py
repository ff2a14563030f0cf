"""What goes over UART, I2C and CAN for one message, from the protocol facts of the ICD. A bus without facts is left out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from icdgen.backends.html.texts import count
from icdgen.icd.model import Message
from icdgen.protocol import crc, reading

_SHOWN = 24  # data bytes that are written out


class Chunk(NamedTuple):
    """Bytes of one meaning, as text: ``kind`` is frame, id, data, crc or note."""

    kind: str
    text: str
    title: str


class Line(NamedTuple):
    """What is sent at once."""

    label: str
    chunks: list[Chunk]


@dataclass
class Bus:
    name: str
    note: str
    lines: list[Line]


def buses(message: Message, protocol: dict, checks: list[dict], data: bytes) -> list[Bus]:
    """The bytes of the message on each bus. ``data`` is the frame shown, ``checks`` are the CRC-8 facts of the nodes
    that speak the message."""
    found = [
        _uart(message, protocol, checks, data),
        _i2c(message, protocol, checks, data),
        _can(message, protocol, data),
    ]
    return [bus for bus in found if bus is not None]


def page_facts(message: Message, protocol: dict, checks: list[dict]) -> dict[str, object]:
    """What the decoder of a page needs to know: framing, ids and checksums."""
    framing = protocol.get("uart", {}).get("framing")
    keys = ("width", "polynomial", "init", "reflect_in", "reflect_out", "xor_out", "empty")
    facts: dict[str, object] = {
        "ids": list(message.ids),
        "id": message.telecommand_id if message.telecommand_id is not None else message.telemetry_id,
        "command": message.telecommand_id is not None,
        "crc": [{key: facts[key] for key in keys if key in facts} for facts in checks if facts["width"] == 8],
    }
    if framing:
        facts["framing"] = [framing[k] for k in ("escape", "start_of_message", "end_of_message", "escaped_data")]
    return facts


def _hex(data: bytes) -> str:
    if len(data) <= _SHOWN:
        return data.hex(" ").upper()
    return f"{data[: _SHOWN - 4].hex(' ').upper()} … {data[-4:].hex(' ').upper()}"


def _data(data: bytes, title: str = "data") -> list[Chunk]:
    return [Chunk("data", _hex(data), f"{title}, {count(len(data), 'byte')}")] if data else []


def _id(id: int) -> Chunk:
    return Chunk("id", f"{id:02X}", f"id {id}")


def _check(checks: list[dict], direction: str, bus: str, data: bytes) -> Chunk | None:
    for facts in checks:
        rule = facts.get(direction)
        if facts["width"] == 8 and rule and bus in rule.get("buses", [bus]):
            return Chunk(
                "crc",
                f"{crc.compute(reading.crc(facts), data):02X}",
                "CRC-8" + (", optional" if rule.get("optional") else ""),
            )
    return None


# UART


def _uart(message: Message, protocol: dict, checks: list[dict], data: bytes) -> Bus | None:
    facts = protocol.get("uart", {}).get("framing")
    if not facts:
        return None
    lines = []
    if message.telecommand_id is not None:
        check = _check(checks, "telecommand", "uart", data)
        lines.append(Line("Telecommand", _framed(facts, message.telecommand_id, data)))
        if check:
            lines.append(Line("with CRC", _framed(facts, message.telecommand_id, data, check)))
    if message.telemetry_id is not None:
        lines.append(Line("Request", _framed(facts, message.telemetry_id, b"")))
        lines.append(Line("Answer", _framed(facts, message.telemetry_id, data)))
    return Bus("UART", _uart_note(protocol["uart"]), lines)


def _framed(facts: dict, id: int, data: bytes, check: Chunk | None = None) -> list[Chunk]:
    escape = facts["escape"]

    def escaped(raw: bytes) -> bytes:
        return b"".join(bytes([escape, facts["escaped_data"]]) if byte == escape else bytes([byte]) for byte in raw)

    chunks = [Chunk("frame", f"{escape:02X} {facts['start_of_message']:02X}", "start of message")]
    chunks.append(Chunk("id", _hex(escaped(bytes([id]))), f"id {id}") if id < 256 else _id(id))
    chunks += _data(escaped(data))
    if check:
        chunks.append(Chunk("crc", _hex(escaped(bytes.fromhex(check.text))), check.title))
    return [*chunks, Chunk("frame", f"{escape:02X} {facts['end_of_message']:02X}", "end of message")]


def _uart_note(facts: dict) -> str:
    parts = [f"{facts['baud_rate']:,} baud"] if "baud_rate" in facts else []
    if {"data_bits", "parity", "stop_bits"} <= facts.keys():
        parity = facts["parity"]
        parts.append(f"{facts['data_bits']}{'N' if parity == 'none' else parity[0].upper()}{facts['stop_bits']}")
    framing = facts["framing"]
    doubled = (
        f"{framing['escape']:02X} within id and data is sent as {framing['escape']:02X} {framing['escaped_data']:02X}"
    )
    return ", ".join(parts) + (". " if parts else "") + doubled + "."


# I2C


def _i2c(message: Message, protocol: dict, checks: list[dict], data: bytes) -> Bus | None:
    facts = protocol.get("i2c", {})
    write, read = _address(facts.get("write")), _address(facts.get("read"))
    if write is None or read is None:
        return None
    lines = []
    if message.telecommand_id is not None:
        check = _check(checks, "telecommand", "i2c", data)
        sent = [Chunk("frame", write, "address, write"), _id(message.telecommand_id), *_data(data)]
        lines.append(Line("Telecommand", sent))
        if check:
            lines.append(Line("with CRC", [*sent, check]))
    if message.telemetry_id is not None:
        request = [Chunk("frame", write, "address, write"), _id(message.telemetry_id)]
        again = Chunk("note", "repeated start", " or ".join(facts.get("telemetry_request", [])))
        answer = [*request, again, Chunk("frame", read, "address, read"), *_data(data)]
        lines.append(Line("Request and answer", answer))
        check = _check(checks, "telemetry", "i2c", data)
        if check:
            lines.append(Line("with CRC", [*answer, check]))
    seven = facts["write"].get("address_7bit")
    return Bus("I²C", f"7-bit address {seven:02X}." if isinstance(seven, int) else "", lines)


def _address(facts: dict | None) -> str | None:
    value = (facts or {}).get("address_8bit")
    return f"{value:02X}" if isinstance(value, int) else None


# CAN


def _can(message: Message, protocol: dict, data: bytes) -> Bus | None:
    facts = protocol.get("can", {})
    parts = [part["bits"] for part in facts.get("identifier", [])]
    types = {one["name"]: one["value"] for one in facts.get("message_types", {}).get("values", [])}
    most = facts.get("max_data_bytes")
    if len(parts) != 4 or not types or most is None or not isinstance(facts.get("node_address"), int):
        return None
    node = facts["node_address"]
    lines: list[Line] = []
    for direction, id in (("telecommand", message.telecommand_id), ("telemetry", message.telemetry_id)):
        rules = facts.get(direction, {})
        if id is None or rules.get("request") not in types:
            continue
        if direction == "telecommand":
            lines += _packets(facts, types, rules, "request", parts, (id, 0, node), data, "Telecommand")
        else:
            lines.append(
                Line("Request", [_identifier(rules["request"], types[rules["request"]], parts, (id, 0, node))])
            )
            lines += _packets(facts, types, rules, "response", parts, (id, node, 0), data, "Answer")
    note = f"{sum(parts)}-bit identifiers. Your own address stands as 0: put it in its place."
    return Bus("CAN", note, lines) if lines else None


def _identifier(name: str, kind: int, parts: list[int], rest: tuple[int, int, int]) -> Chunk:
    value = 0
    for bits, one in zip(parts, (kind, *rest), strict=True):
        value = value << bits | one & ((1 << bits) - 1)
    title = f"{name}: type {kind}, channel {rest[0]}, source {rest[1]}, destination {rest[2]}"
    return Chunk("id", f"{value:0{(sum(parts) + 3) // 4}X}", title)


def _packets(
    facts: dict,
    types: dict,
    rules: dict,
    way: str,
    parts: list[int],
    rest: tuple[int, int, int],
    data: bytes,
    label: str,
) -> Iterator[Line]:
    """One packet, or as many extended ones as it takes; of many the first two and the last."""
    most, name = facts["max_data_bytes"], rules.get(way)
    if len(data) <= most:
        if name in types:
            yield Line(label, [_identifier(name, types[name], parts, rest), *_data(data)])
        return
    name, extended = rules.get(f"extended_{way}"), facts.get("extended")
    if name not in types or not extended or extended["packets_left_byte"] != extended["data_bytes"]:
        return
    size = extended["data_bytes"]
    packets = [data[at : at + size] for at in range(0, len(data), size)]
    last = extended.get("packets_left_in_last", 0)
    for index, packet in enumerate(packets):
        if 2 <= index < len(packets) - 1:
            if index == 2:
                yield Line("", [Chunk("note", f"… {count(len(packets) - 3, 'more packet')}", "")])
            continue
        left = len(packets) - 1 - index + last
        chunks = [
            _identifier(name, types[name], parts, rest),
            *_data(packet.ljust(size, bytes([extended.get("fill", 0)]))),
        ]
        yield Line(f"{label} {index + 1}/{len(packets)}", [*chunks, Chunk("crc", f"{left:02X}", "packets left")])
