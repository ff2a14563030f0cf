"""Composite messages: an ICD with unusual ones, and their parts according to the
reference codec.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from icdgen import codec
from icdgen.icd.model import Icd, Message
from icdgen.icd.places import raw_fields_in

BASE = """\
icdgen: 1
node: {name: base, title: Base, byte_order: little, bit_order: lsb0}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, name: Active}]}
messages:
  - name: Label
    id: 130
    kind: telemetry
    length: 8
    fields:
      - {at: 0, bits: 32, name: Text, type: text}
      - {at: 32, bits: 24, name: Octets, type: bytes}
      - {at: 56, bits: 4, name: Mode, type: enum, enum: Mode}
      - {at: 60, bits: 4, name: Spare, type: int}
      - {at: 56, bits: 8, name: All, type: uint, view: true}
  - {name: Nothing, id: 131, kind: telemetry, length: 0}
"""
DEMO = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
include: [base.yaml]
messages:
  - name: Wheel
    id: 140
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 16, name: Speed, type: int, unit: rpm, formula: raw*0.1}
      - {at: 16, bits: 8, name: type, type: uint, const: 3}
  - name: Heat
    id: 141
    kind: telemetry
    length: 10
    fields:
      - {at: 0, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
      - {at: 48, bits: 32, name: Factor, type: float}
  - name: Bits
    id: 142
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 5, name: Number, type: uint}
      - {at: 5, bits: 1, name: Ready, type: bool}
      - {at: 6, bits: 2, count: 1, name: Pair, type: uint}
  - name: All
    set_id: 20
    get_id: 143
    kind: configuration
    length: 36
    contains:
      - {message: Label, at: 0}
      - {message: Wheel, at: 64}
      - {message: Nothing, at: 64}
      - {message: Heat, at: 104}
      - {message: Wheel, at: 264}
      - {message: Bits, at: 90}
      - {message: Heat, at: 184}
    fields:
      - {at: 0, bits: 32, name: Name, type: text}
      - {at: 32, bits: 24, name: Octets, type: bytes}
      - {at: 56, bits: 4, name: Base Mode, type: enum, enum: Mode}
      - {at: 60, bits: 4, name: Wheel, type: int}
      - {at: 64, bits: 16, name: First Speed, type: int, unit: rpm, formula: raw*0.1}
      - {at: 80, bits: 8, name: First, type: uint, const: 3}
      - {at: 90, bits: 5, name: Bits Number, type: uint}
      - {at: 95, bits: 1, name: Bits Ready, type: bool}
      - {at: 96, bits: 2, name: Bits Pair, type: uint}
      - {at: 104, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
      - {at: 152, bits: 32, name: Factor, type: float}
      - {at: 184, bits: 16, name: T0, type: int, unit: C, formula: raw*0.01}
      - {at: 200, bits: 16, name: T1, type: int, unit: C, formula: raw*0.01}
      - {at: 216, bits: 16, name: T2, type: int, unit: C, formula: raw*0.01}
      - {at: 232, bits: 32, name: Factor 2, type: float}
      - {at: 264, bits: 16, name: Second Speed, type: int, unit: rpm, formula: raw*0.1}
      - {at: 280, bits: 8, name: Second, type: uint, const: 3}
      - {at: 64, bits: 24, name: Word, type: uint, view: true}
"""


def write(folder: Path) -> Path:
    """Write the ICDs and return the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("base", BASE), ("demo", DEMO)):
        (folder / f"{name}.yaml").write_text(text, "utf-8")
    return folder


class PartFrame(NamedTuple):
    """A part of a composite message with its frame."""

    part: Message
    index: int  # among equal parts of the message
    frame: bytes


class CompositeCase(NamedTuple):
    """A frame of a composite message with the frames of its parts."""

    message: Message
    frame: bytes
    parts: tuple[PartFrame, ...]


def cases(icd: Icd, count: int = 4) -> Iterator[CompositeCase]:
    """Yield ``count`` random frames of each composite message."""
    random_bytes = random.Random(14).randbytes
    for node in icd.nodes:
        messages_by_name = {message.name: message for message in icd.messages_of(node)}
        for message in node.messages:
            for _ in range(count if message.contains else 0):
                frame = random_bytes(message.length)
                raw = codec.decode(node, message, frame)
                values = {
                    field.at: raw[field.name] for field in raw_fields_in(message.layout)
                }
                parts: list[PartFrame] = []
                for placement in message.contains:
                    part = messages_by_name[placement.message]
                    if raw_fields_in(part.layout):
                        index = sum(other.part is part for other in parts)
                        theirs = {
                            field.name: values[placement.at + field.at]
                            for field in raw_fields_in(part.layout)
                        }
                        parts.append(
                            PartFrame(
                                part,
                                index,
                                codec.encode(icd.node(part.node), part, theirs),
                            )
                        )
                yield CompositeCase(message, frame, tuple(parts))
