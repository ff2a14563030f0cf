"""Limits of the format: each accepts its own value and refuses the next.

The numbers come from the documents, not from the code. A changed limit must be changed
here as well.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.icd.files import codes
from tests.limits import assert_limits

NODE = "node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0"
LINK = (
    "icdgen: 1\n" + NODE + ", id_bits: 16}\nprotocol:\n  link:\n    framing: {by: slip}"
)
"""A framed link; a header follows."""


def message(
    length: int, *fields: str, kind: str = "telecommand", keys: str = ""
) -> str:
    """Return a message with id 1 and these fields, each the inside of a flow mapping."""
    head = (
        f"messages:\n  - {{name: Message, id: 1, kind: {kind}, length: {length}{keys}"
    )
    rows = ", ".join(f"{{{field}}}" for field in fields)
    return f"{head}, fields: [{rows}]}}\n" if fields else f"{head}}}\n"


def uint(bits: int, keys: str = "", at: int = 0) -> str:
    return f"at: {at}, bits: {bits}, name: Value {at}, type: uint{keys}"


def value(bits: int, keys: str) -> str:
    """Return a message with an unsigned number."""
    return message(bits // 8, uint(bits, keys))


def enum(member: int, type: str) -> str:
    """Return a message with a field of 5 bits whose enumeration has this member."""
    members = f"{{value: 0, name: Stop}}, {{value: {member}, name: Go}}"
    field = f"at: 0, bits: 5, name: State, type: {type}, enum: State"
    return (
        f"enums: [{{name: State, members: [{members}]}}]\n"
        + message(1, field, uint(3, at=5))
    )  # fmt: skip


def header(*rows: str, trailer: str = "", messages: str = "", length: int = 1) -> str:
    """Return an ICD with a framed link that has these fields besides the id."""
    fields = "".join(f"      - {{{row}}}\n" for row in ("bits: 16, role: id", *rows))
    content = messages or message(
        length, f"at: 0, bits: {8 * length}, name: Data, type: bytes", kind="telemetry"
    )
    return f"{LINK}\n    header:\n{fields}{trailer}{content}"


def checksum(width: int, keys: str) -> str:
    """Return an ICD whose messages end with a checksum."""
    trailer = (
        f"    trailer: [{{bits: {width}, role: checksum, checksum: sum, covers: {{from: id, to: data}}}}]\n"
        f"    checksums: {{sum: {{width: {width}, {keys}}}}}\n"
    )
    return header(trailer=trailer)


def crc(width: int, **changes: int) -> str:
    values = {"polynomial": 7, "init": 0, "xor_out": 0} | changes
    keys = ", ".join(f"{key}: {value}" for key, value in values.items())
    return checksum(width, f"kind: crc, {keys}, reflect_in: false, reflect_out: false")


def can(role: str, bits: int, number: int) -> str:
    """Return an ICD with CAN identifiers in which the address ``role`` has ``bits``
    bits.
    """
    widths = {"type": 13 - bits, "channel": 8, "source": 8, "destination": 8}
    widths[role] = bits
    parts = ", ".join(
        f"{{name: Part {name}, bits: {each}, role: {name}}}"
        for name, each in widths.items()
    )
    section = f"node_address: {number}, identifier: [{parts}]"
    return f"protocol: {{link: {{buses: {{can: {{{section}}}}}}}}}\n"


def segments(left_in_last: int, packets: int) -> str:
    """Return an ICD whose long messages count the CAN packets that are left."""
    counts = f"packets_left_in_last: {left_in_last}, max_packets: {packets}"
    section = f"data_bytes: 7, packets_left_byte: 7, {counts}, max_bytes: {7 * packets}"
    return f"protocol: {{link: {{buses: {{can: {{max_data_bytes: 8, segments: {{{section}}}}}}}}}}}\n"


def sends_blocks(
    *,
    total: int = 1,
    size: int = 8,
    number: int = 8,
    offset: int = 16,
    map: int = 64,
    area: int = 0,
) -> str:
    """Return an ICD with a procedure that sends ``total`` bytes in blocks of packets of
    one byte.

    ``number``, ``offset``, and ``map`` are the bits of the fields for the number and the
    offset of a packet, and for the packets that arrived; ``area`` is a constant for a
    field of 4 bits.
    """
    return f"""protocol:
  procedures:
    load:
      inputs: {{image: {{type: bytes, most: {total}}}}}
      limits: {{time_s: 60, requests: 100}}
      steps:
        - blocks:
            of: image
            size: {size}
            rounds: 4
            steps:
              - missing:
                  packet: 1
                  each:
                    - {{send: Write, with: {{Number: packet.number, Offset: packet.offset, Data: packet.data, Area: {area}}}}}
                  steps:
                    - {{map: get, messages: [Map], field: Bits}}
messages:
  - name: Write
    id: 1
    kind: telecommand
    length: 5
    fields:
      - {{at: 0,  bits: {number}, name: Number, type: uint}}
      - {{at: 8,  bits: 4, name: Area, type: uint}}
      - {{at: 16, bits: {offset}, name: Offset, type: uint}}
      - {{at: 32, bits: 8, name: Data, type: bytes}}
  - name: Map
    set_id: 3
    get_id: 131
    kind: configuration
    length: {map // 8}
    fields: [{{at: 0, bits: {map}, name: Bits, type: bytes}}]
"""


def responses(keys: str, last: int = 2) -> str:
    """Return an ICD whose telecommand has responses, with a reason from 1 to ``last``."""
    echoed = ", ".join(
        f"{{at: {8 * at}, bits: 8, name: Echo {at}, type: uint}}" for at in range(8)
    )
    sent = ", ".join(
        f"{{at: {8 * at}, bits: 8, name: Value {at}, type: uint}}" for at in range(8)
    )
    return f"""{LINK}
    header: [{{bits: 16, role: id}}]
    commands: {{ack: {{message: Ack, {keys}}}, nak: {{message: Nak, reason: Reason}}}}
enums: [{{name: Reason, members: [{{value: 0, name: Fine}}, {{value: 1, to: {last}, name: Bad}}]}}]
messages:
  - {{name: Ack, id: 6, kind: telemetry, length: 8, fields: [{echoed}]}}
  - {{name: Nak, id: 7, kind: telemetry, length: 2, fields: [{{at: 0, bits: 16, name: Reason, type: enum, enum: Reason}}]}}
  - {{name: Save, id: 1, kind: telecommand, length: 8, fields: [{sent}]}}
"""


def echoes(count: int) -> str:
    return responses(
        f"echo: {{{', '.join(f'Echo {at}: Value {at}' for at in range(count))}}}"
    )


def counted(bits: int, up_to: int, plus: int = 0) -> str:
    """Return a message with an array of bytes behind its counter."""
    at = max(bits, 8)
    fields = [uint(bits), *([uint(8 - bits, at=bits)] if bits < 8 else [])]
    counter = f"{{field: Value 0, plus: {plus}}}"
    array = f"at: {at}, name: Items, type: bytes, size: {counter}, up_to: {up_to}"
    return message(at // 8, *fields, array)


def array(count: int) -> str:
    return message(count, f"at: 0, bits: 8, name: Items, type: uint, count: {count}")


def open_array(most: int) -> str:
    item = f"at: 0, bits: 8, name: Items, type: uint, count: rest, up_to: {most}"
    return message(0, item)


def open_bytes(most: int) -> str:
    return message(
        2, uint(16), f"at: 16, name: Rest, type: bytes, size: rest, up_to: {most}"
    )


def points(count: int) -> str:
    rows = ", ".join(f"[{number}, {number}]" for number in range(count))
    return value(16, f", points: [{rows}], outside: clamp")


def table(first: int, last: int) -> str:
    """Return a field whose lookup table goes from ``first`` to ``last``."""
    return value(8, f", points: [[{first}, 0], [{last}, 1]], outside: clamp")


def formula(text: str, bits: int = 8) -> str:
    return message(bits // 8, uint(bits, f", formula: {text}"), kind="telemetry")


IDS = {
    "an id of 8 bits": (
        "ICD056",
        lambda id: (
            f"messages: [{{name: Reset, id: {id}, kind: telecommand, length: 0}}]\n"
        ),
        None,
        255,
    ),
}


def member_range(last: int) -> str:
    """Return an enumeration of which a member is a range from 3."""
    members = f"{{value: 0, name: Stop}}, {{value: 3, to: {last}, name: Go}}"
    return f"enums: [{{name: State, members: [{members}]}}]\n"


def id_ranges(last: int, first: int, bit: int = 7) -> str:
    """Return the ids of telecommands up to ``last`` and of telemetry from ``first``."""
    ids = (
        f"direction_bit: {bit}, telecommand: {{direction: 0, first: 0, last: {last}}}, "
        f"telemetry: {{direction: 1, first: {first}, last: 255}}"
    )
    return f"protocol: {{link: {{ids: {{{ids}}}}}}}\n"


def id_in_ranges(id: int) -> str:
    command = f"messages: [{{name: Reset, id: {id}, kind: telecommand, length: 0}}]\n"
    return id_ranges(100, 128) + command


def linked_ids(bits: int) -> str:
    framing = "framing: {by: escape, escape: 0x1F, start: 0x7F, end: 0xFF, data: 0x1F}"
    protocol = f"protocol: {{link: {{buses: {{uart: {{{framing}}}}}}}}}\n"
    return f"icdgen: 1\n{NODE}, id_bits: {bits}}}\n{protocol}"


def can_message(length: int) -> str:
    """Return a message of a node that sends single CAN packets."""
    packet = "packets: {Command: {from: host, buses: [can], type: 3}}"
    can_section = can("source", 8, 1).removeprefix("protocol: {link: {")
    protocol = f"protocol: {{link: {{{packet}, {can_section}"
    protocol = protocol.replace("node_address", "max_data_bytes: 8, node_address")
    data = f"at: 0, bits: {8 * length}, name: Data, type: bytes"
    return protocol + message(length, data)


FIELDS: dict[str, tuple[str, Callable[[int], str], int | None, int | None]] = {
    "bits of an integer": (
        "ICD022",
        lambda bits: message(-(-bits // 8), uint(bits), kind="telemetry"),
        None,
        64,
    ),
    "the end of a field": ("ICD020", lambda bits: message(2, uint(bits)), None, 16),
    "the begin of a field behind another": (
        "ICD021",
        lambda at: message(3, uint(8), uint(8, at=at)),
        8,
        None,
    ),
    "a constant of 8 bits": (
        "ICD031",
        lambda const: value(8, f", const: {const}"),
        0,
        255,
    ),
    "a signed constant of 8 bits": (
        "ICD031",
        lambda const: message(
            1, f"at: 0, bits: 8, name: Value, type: int, const: {const}"
        ),
        -128,
        127,
    ),
    "a member of an enumeration of 5 bits": (
        "ICD030",
        lambda member: enum(member, "enum"),
        None,
        31,
    ),
    "elements of an array": ("ICD010", array, 1, 1024),
    "elements of a variable-length array": ("ICD120", open_array, None, 1024),
    "bytes of a frame": ("ICD121", open_bytes, None, 65533),
    "a count of 4 bits": ("ICD120", lambda most: counted(4, most), None, 15),
    "a count of 4 bits plus 3": ("ICD120", lambda most: counted(4, most, 3), 3, 18),
    "bytes of a frame that can end early": (
        "ICD150",
        lambda length: message(
            length,
            f"at: 0, bits: {8 * length}, name: Data, type: bytes",
            keys=", may_end_early: zeros",
        ),
        2,
        None,
    ),
}

LIMITS = {
    "a minimum of 8 bits": (
        "ICD034",
        lambda least: value(8, f", min: {least}"),
        None,
        255,
    ),
    "a lower limit that is excluded": (
        "ICD034",
        lambda above: value(8, f", above: {above}"),
        None,
        254,
    ),
    "a maximum": ("ICD034", lambda most: value(8, f", max: {most}"), 0, None),
    "an upper limit that is excluded": (
        "ICD034",
        lambda below: value(8, f", below: {below}"),
        1,
        None,
    ),
    "a minimum at the maximum": (
        "ICD033",
        lambda least: value(8, f", min: {least}, max: 7"),
        None,
        7,
    ),
}

FORMULAS = {
    "points of a lookup table": ("ICD010", points, 2, None),
    "a lookup table behind the raw values": (
        "ICD069",
        lambda first: table(first, 300),
        None,
        255,
    ),
    "a lookup table before the raw values": (
        "ICD069",
        lambda last: table(-300, last),
        0,
        None,
    ),
    "the first point without `outside`": (
        "ICD068",
        lambda first: value(8, f", points: [[{first}, 0], [300, 1]]"),
        None,
        0,
    ),
    "the last point without `outside`": (
        "ICD068",
        lambda last: value(8, f", points: [[-5, 0], [{last}, 1]]"),
        255,
        None,
    ),
    "the degree of a polynomial": (
        "ICD060",
        lambda degree: formula(f"raw^{degree}"),
        1,
        15,
    ),
    "digits of a number": (
        "ICD060",
        lambda digits: formula(f"raw + {'1' * digits}"),
        None,
        40,
    ),
    "open parentheses": (
        "ICD060",
        lambda depth: formula("(" * depth + "raw" + ")" * depth),
        None,
        49,
    ),
    "characters of a formula": (
        "ICD010",
        lambda length: formula("raw + 1".replace("+ ", "+" + " " * (length - 6))),
        None,
        1000,
    ),
    "an exponent": ("ICD060", lambda power: formula(f"raw + 1^{power}"), None, 999),
    "bits of an intermediate power": (
        "ICD060",
        lambda power: formula(f"raw + 16^{power} / 16^{power}"),
        None,
        800,
    ),
    "bits of a factor": (
        "ICD064",
        lambda factor: formula(f"raw * (2^180 + {factor})"),
        None,
        0,
    ),
    "bits of a divisor": (
        "ICD064",
        lambda divisor: formula(f"raw / (2^180 + {divisor})"),
        None,
        0,
    ),
    "bits of an offset": (
        "ICD064",
        lambda offset: formula(f"raw + 2^240 + {offset}"),
        None,
        0,
    ),
    "raw values of a polynomial that can be inverted": (
        "ICD066",
        lambda bits: message(
            3, uint(bits, ", formula: raw + raw^2"), uint(24 - bits, at=bits)
        ),
        None,
        16,
    ),
}

FRAMED_LINKS = {
    "bits of a sequence number": (
        "ICD172",
        lambda bits: header(
            f"bits: {bits}, role: sequence",
            f"bits: {40 - bits}, role: constant, value: 0",
        ),
        None,
        31,
    ),
    "bytes that a field spans": (
        "ICD172",
        lambda bits: header(
            "bits: 4, role: constant, value: 0",
            f"bits: {bits}, role: flags",
            f"bits: {36 - bits}, role: constant, value: 0",
        ),
        None,
        28,
    ),
    "a constant of 4 bits": (
        "ICD172",
        lambda const: header(
            f"bits: 4, role: constant, value: {const}", "bits: 4, role: flags"
        ),
        None,
        15,
    ),
    "a length of 4 bits": (
        "ICD172",
        lambda length: header(
            "bits: 4, role: length", "bits: 4, role: flags", length=length
        ),
        None,
        15,
    ),
    "a length of 4 bits that counts the message": (
        "ICD172",
        lambda length: header(
            "bits: 4, role: length, counts: message",
            "bits: 4, role: flags",
            length=length,
        ),
        None,
        12,
    ),
    "a length below zero": (
        "ICD172",
        lambda length: header("bits: 8, role: length, plus: -3", length=length),
        3,
        None,
    ),
    "the initial value of a checksum": (
        "ICD173",
        lambda init: crc(8, init=init),
        None,
        255,
    ),
    "the last XOR of a checksum": (
        "ICD173",
        lambda xor_out: crc(16, xor_out=xor_out),
        None,
        0xFFFF,
    ),
    "the polynomial of a checksum": (
        "ICD173",
        lambda polynomial: crc(8, polynomial=polynomial),
        None,
        255,
    ),
}

BUSES = {
    "the last value of a range": ("ICD035", member_range, 4, None),
    "the last id of telecommands": (
        "ICD103",
        lambda last: id_ranges(last, 128),
        0,
        127,
    ),
    "the first id of telemetry": (
        "ICD103",
        lambda first: id_ranges(100, first),
        128,
        255,
    ),
    "an id of the telecommands": ("ICD056", id_in_ranges, None, 100),
    "bits of ids without frames": ("ICD112", linked_ids, None, 8),
    "bytes of a message in a CAN packet": ("ICD107", can_message, None, 8),
    "a source address of 4 bits": (
        "ICD100",
        lambda number: can("source", 4, number),
        None,
        15,
    ),
    "a destination address of 4 bits": (
        "ICD100",
        lambda number: can("destination", 4, number),
        None,
        15,
    ),
    "the count of packets that are left": (
        "ICD099",
        lambda most: segments(0, most),
        None,
        256,
    ),
    "the count of packets that begins at 1": (
        "ICD099",
        lambda most: segments(1, most),
        None,
        255,
    ),
}

PROCEDURES = {
    "the number of a packet": (
        "ICD193",
        lambda size: sends_blocks(size=size, number=3, total=9),
        None,
        8,
    ),
    "the offset of a packet": (
        "ICD193",
        lambda total: sends_blocks(total=total, offset=4),
        None,
        16,
    ),
    "a constant of a request": (
        "ICD191",
        lambda area: sends_blocks(area=area),
        None,
        15,
    ),
    "the map of packets": (
        "ICD193",
        lambda size: sends_blocks(size=size, map=8),
        None,
        8,
    ),
}

RESPONSES = {
    "values of a reason": (
        "ICD177",
        lambda last: responses("echo: {Echo 0: Value 0}", last=last),
        None,
        256,
    ),
    "parts that responses repeat": ("ICD177", echoes, None, 4),
}

FILES = {
    "characters of a text": (
        "ICD001",
        lambda size: f"vocabulary: ['{'x' * size}']\n" + value(8, ""),
        None,
        20_000,
    ),
    "levels of lists": (
        "ICD001",
        lambda depth: "vocabulary: " + "[" * depth + "]" * depth + "\n",
        None,
        39,
    ),
    "bytes of a file": (
        "ICD001",
        lambda size: f"icdgen: 1\n{NODE}}}\n".ljust(size - 1, "#") + "\n",
        None,
        4_000_000,
    ),
}

TABLES = (
    FILES
    | IDS
    | FIELDS
    | LIMITS
    | FORMULAS
    | FRAMED_LINKS
    | BUSES
    | PROCEDURES
    | RESPONSES
)


@pytest.mark.parametrize("name", TABLES)
def test_a_limit_accepts_its_value_and_refuses_the_next(name, tmp_path: Path):
    code, text, least, most = TABLES[name]
    assert_limits(
        lambda number: code not in codes(tmp_path, text(number)), least=least, most=most
    )
