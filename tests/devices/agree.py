"""What generated code reads of random frames, beside what the library reads."""

from __future__ import annotations

import json
import random
import struct
from dataclasses import dataclass, field
from fractions import Fraction

from icdgen import codec
from icdgen.icd.build import special
from icdgen.icd.formula import parse
from icdgen.icd.model import Field
from tests.conformance.driver import Answering
from tests.devices.definition import Definition, NotHeld

ROUNDS_OFF = 1e-9  # as far as a library's double may be from the exact value, relative to it or as so many units


@dataclass
class Agreement:
    """What came of the comparison in one language."""

    messages: int = 0
    frames: int = 0
    values: int = 0
    rounded: int = 0  # ours is the double nearest to the exact value, the library's is not
    impossible: int = 0  # the library's value has more bits than the field
    special: int = 0  # values that have a meaning, where the library has a value or says that there is none
    refused: int = 0  # frames that the library takes for another message
    differences: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{self.messages} messages, {self.frames} frames, {self.values} values, {len(self.differences)} differences, "
            f"{self.special} special values, "
            f"{self.rounded} rounded wrongly by the library, {self.impossible} of it wider than the field, "
            f"{self.refused} frames of other layouts"
        )


def compare(node: str, messages: list[Definition], testee: Answering, frames: int, seed: int, into: Agreement) -> None:
    """Puts ``frames`` random frames of each message to the testee and to the library."""
    chance = random.Random(f"{seed} {node}")
    asked = [(one, data) for one in messages for data in _frames(one.length, chance, frames)]
    requests = [
        {"op": "decode", "node": node, "kind": one.kind, "id": one.id, "bytes": data.hex()} for one, data in asked
    ]
    answers = testee.ask([json.dumps(request).encode() for request in requests])
    for (one, data), answer in zip(asked, answers, strict=True):
        try:
            raw, physical = one.raw(data), one.physical(data)
        except NotHeld:
            into.refused += 1
            continue
        into.frames += 1
        said = json.loads(answer or b"{}")
        about = f"{node} {one.name} {data.hex()}"
        if not said.get("ok"):
            into.differences.append(f"{about}: {said}")
            continue
        for part in one.fields:
            name = part["name"]
            if name in raw:
                into.values += 1
                value = raw[name]
                if value is None or (isinstance(value, int) and _means_something(value, part)):
                    into.special += 1
                if value is None:
                    if not _means_something(_ours(said["raw"], part), part):
                        into.differences.append(f"{about}: {name} is a number, the library says it is none")
                elif isinstance(value, int) and value.bit_length() > part["bits"]:
                    into.impossible += 1
                elif not _same(_ours(said["raw"], part), value, part):
                    into.differences.append(
                        f"{about}: {name} is {_ours(said['raw'], part)!r}, the library says {value!r}"
                    )
        for name, bits in said["physical"].items():
            if name in physical:
                into.values += 1
                formula = next(part["formula"] for part in one.fields if part["name"] == name)
                _physical(about, name, _double(bits), physical[name], _exact(formula, said["raw"][name]), into)
    into.messages += len(messages)


def _ours(raw: dict[str, object], part: dict) -> object:
    """A raw value of an answer; of an array a list."""
    name = part["name"]
    return [raw[f"{name}[{index}]"] for index in range(part["count"])] if "count" in part else raw[name]


def _means_something(raw: object, part: dict) -> bool:
    """Whether a raw value is one that the ICD gives a meaning; of a float its bits are given."""
    if part["type"] != "float":
        return any(one["value"] == raw for one in part.get("special", ()))
    named = (special("float", part["bits"], one["value"], one["meaning"]) for one in part.get("special", ()))
    one = Field("", 0, part["bits"], "float", special=tuple(found for found in named if found))
    return codec.special_of(one, int(str(raw), 16)) is not None


def _physical(about: str, name: str, ours: float, theirs: object, exact: float, into: Agreement) -> None:
    assert isinstance(theirs, (int, float))
    if ours != exact:
        into.differences.append(f"{about}: {name} is {ours!r}, exactly {exact!r}")
    elif ours != theirs:
        if abs(ours - theirs) <= ROUNDS_OFF * max(1.0, abs(ours)):
            into.rounded += 1
        else:
            into.differences.append(f"{about}: {name} is {ours!r}, the library says {theirs!r}")


def _frames(length: int, chance: random.Random, count: int) -> list[bytes]:
    fixed = [bytes(length), b"\xff" * length] if length else [b""]
    return [*fixed, *(chance.randbytes(length) for _ in range(count - 2))] if length else fixed


def _exact(formula: str, raw: int) -> float:
    value = parse(formula).physical(Fraction(raw))
    return value.numerator / value.denominator  # true division of integers is correctly rounded


def _double(bits: str) -> float:
    return struct.unpack(">d", bytes.fromhex(bits))[0]


def _same(ours: object, theirs: object, part: dict) -> bool:
    """Whether a testee's raw value is the library's. Of text a library keeps what stands before a NUL."""
    if part["type"] in ("bytes", "text"):
        wide = isinstance(theirs, int)  # some read bytes as one number
        data = theirs.to_bytes(part["bits"] // 8, "little") if wide else bytes(theirs)  # type: ignore
        mine = bytes.fromhex(str(ours))
        return mine == data or (part["type"] == "text" and mine.startswith(data + b"\0"))
    if isinstance(theirs, (list, tuple)):
        return isinstance(ours, list) and all(_same(*pair, part) for pair in zip(ours, theirs, strict=True))
    if isinstance(theirs, float) and isinstance(ours, str):
        code = {16: "e", 32: "f", 64: "d"}[part["bits"]]
        value = struct.unpack(f">{code}", bytes.fromhex(ours))[0]
        return struct.pack(">d", value) == struct.pack(">d", theirs) or (
            value != value and theirs != theirs
        )  # both NaN
    return ours == theirs
