"""What generated code reads of random frames, beside what the library reads."""

from __future__ import annotations

import json
import random
import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from fractions import Fraction

from icdgen import codec
from icdgen.icd.formula import coefficients, parse
from icdgen.icd.layout import Scalar
from icdgen.icd.meanings import special
from tests.conformance.driver import Answering
from tests.devices.definition import Definition, NotSupported, Values

# As far as a library's double may be from the exact value, relative to it or as so many
# units.
ROUNDS_OFF = 1e-9


@dataclass
class Agreement:
    """What came of the comparison in one language."""

    messages: int = 0
    frames: int = 0
    values: int = 0
    # ours is the double nearest to the exact value, the library's is not
    rounded: int = 0
    impossible: int = 0  # the library's value has more bits than the field
    # Values that have a meaning, where the library has a value or says that there is
    # none.
    special: int = 0
    # frames of the library, from its raw values and from its physical ones
    encoded: int = 0
    refused: int = 0  # frames that the library takes for another message
    unread: set[str] = field(
        default_factory=set
    )  # messages of which the library reads no frame at all
    differences: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        return (
            f"{self.messages} messages, {self.frames} frames, {self.values} values, {len(self.differences)} differences, "
            f"{self.special} special values, "
            + (f"{self.encoded} frames encoded, " if self.encoded else "")
            + f"{self.rounded} rounded wrongly by the library, {self.impossible} of it wider than the field, "
            f"{self.refused} frames of other layouts"
            + (
                f"; the library reads no frame of {', '.join(sorted(self.unread))}"
                if self.unread
                else ""
            )
        )


def compare(
    node: str,
    messages: list[Definition],
    testee: Answering,
    frames: int,
    seed: int,
    into: Agreement,
) -> None:
    """Puts ``frames`` random frames of each message to the testee and to the library."""
    chance = random.Random(f"{seed} {node}")
    asked = [
        (one, data) for one in messages for data in random_frames(one, chance, frames)
    ]
    sharing = Counter((one.kind, one.id) for one in messages)
    requests = [
        {
            "op": "decode",
            "node": node,
            "kind": one.kind,
            "id": one.id,
            "bytes": data.hex(),
        }
        for one, data in asked
    ]
    plain = testee.ask(
        [json.dumps(request).encode() for request in requests]
    )  # of a shared id: which message it is
    named = [
        {**request, "message": one.name}
        for request, (one, _) in zip(requests, asked, strict=True)
    ]
    shared = [sharing[one.kind, one.id] > 1 for one, _ in asked]
    of_shared = iter(
        testee.ask(
            [
                json.dumps(one).encode()
                for one, is_shared in zip(named, shared, strict=True)
                if is_shared
            ]
        )
    )
    read, again = set(), []
    for (one, data), answer, is_shared in zip(asked, plain, shared, strict=True):
        told = json.loads(answer or b"{}").get("message") if is_shared else one.name
        answer = next(of_shared) if is_shared else answer
        try:
            raw, physical = one.raw(data), one.physical(data)
        except NotSupported:
            into.refused += 1
            continue
        into.frames += 1
        read.add(one.name)
        said = json.loads(answer or b"{}")
        about = f"{node} {one.name} {data.hex()}"
        if not said.get("ok"):
            into.differences.append(f"{about}: {said}")
            continue
        if told != one.name:
            into.differences.append(f"{about}: taken for {told}")
        formulas = {}
        for name, part, ours in _values(one, said["raw"]):
            formulas[name] = part.get("formula", "")
            if "when" in part and (ours is None) != (name not in raw):
                into.differences.append(
                    f"{about}: {name} is {ours!r}, the library says {raw.get(name, 'nothing')!r}"
                )
            elif name in raw:
                into.values += 1
                value = raw[name]
                if value is None or (
                    isinstance(value, int) and _means_something(value, part)
                ):
                    into.special += 1
                if value is None:
                    if not _means_something(ours, part):
                        into.differences.append(
                            f"{about}: {name} is a number, the library says it is none"
                        )
                elif isinstance(value, int) and value.bit_length() > part["bits"]:
                    into.impossible += 1
                elif not _same(ours, value, part):
                    into.differences.append(
                        f"{about}: {name} is {ours!r}, the library says {value!r}"
                    )
        for name, bits in said["physical"].items():
            if name in physical and bits is not None:
                into.values += 1
                _physical(
                    about,
                    name,
                    _double(bits),
                    physical[name],
                    _exact(formulas[name], said["raw"][name]),
                    into,
                )
        if one.encoded is not None:
            expected = one.encoded(data).hex()
            if said["bytes"] != expected:
                into.differences.append(
                    f"{about}: is encoded as {said['bytes']}, by the library as {expected}"
                )
            request = {"op": "encode", "node": node, "kind": one.kind, "id": one.id}
            again.append(
                ({**request, **_to_encode(one, said["raw"], physical)}, expected)
            )
        for end in one.ends:
            elements = _there(end, said["raw"])
            extra = [
                name for name in raw if name.startswith(f"{end['name']}[{elements}]")
            ]
            into.differences += [
                f"{about}: {elements} elements, the library says more"
                for _ in extra[:1]
            ]
    made = testee.ask([json.dumps(request).encode() for request, _ in again])
    for (request, expected), answer in zip(again, made, strict=True):
        into.encoded += 1
        if json.loads(answer or b"{}").get("bytes") != expected:
            into.differences.append(
                f"{request}: is encoded as {answer!r}, by the library as {expected}"
            )
    into.messages += len(messages)
    into.unread |= {one.name for one in messages} - read


def _to_encode(
    one: Definition, raw: dict[str, object], physical: Values
) -> dict[str, dict[str, object]]:
    """The values of a frame to be encoded: physical ones as the library has them, where
    they can be set.
    """
    own = [part for part in one.fields if "view" not in part]
    scaled = {
        part["name"] for part in own if "formula" in part and part["type"] != "float"
    }
    given = {
        name: struct.pack(">d", value).hex()
        for name, value in physical.items()
        if name in scaled and isinstance(value, (int, float))
    }
    return {
        "raw": {
            one["name"]: raw[one["name"]] for one in own if one["name"] not in given
        },
        "physical": given,
    }


def _values(
    one: Definition, raw: dict[str, object]
) -> Iterator[tuple[str, dict, object]]:
    """Name, field and value of all that an answer has; of an array a list, of what is
    open at the end as much as there is.
    """
    for part in one.fields:
        name = part["name"]
        count = _there(part, raw) if "up_to" in part else part.get("count")
        if "size" in part:
            yield name, part, str(raw[name])[: 2 * count]
        else:
            yield from _values_of(one, part, name, count, raw)


def _values_of(
    one: Definition, part: dict, name: str, count: int | None, raw: dict[str, object]
) -> Iterator[tuple[str, dict, object]]:
    """A field that stands for itself or is an array; of an array of structs, the fields
    of each element.
    """
    if "struct" not in part:
        yield name, part, _value(raw, name, count)
        return
    for index in range(count or 0):
        for inner in one.parts(part):
            there = _there(inner, raw) if "up_to" in inner else inner.get("count")
            yield from _values_of(
                one, inner, f"{name}[{index}].{inner['name']}", there, raw
            )


def _value(raw: dict[str, object], name: str, count: int | None) -> object:
    return (
        raw[name]
        if count is None
        else [raw[f"{name}[{index}]"] for index in range(count)]
    )


def _there(end: dict, raw: dict[str, object]) -> int:
    """How many elements, or bytes, of an open end are there."""
    said, plus = _counter(end)
    return (
        int(
            str(
                raw[
                    (
                        f"{end['name']} {'Size' if 'size' in end else 'Count'}"
                        if said == "rest"
                        else said
                    )
                ]
            )
        )
        + plus
    )


def _counter(end: dict) -> tuple[str, int]:
    """What counts the elements, or bytes, of an open end, and what is added to it."""
    said = end.get("count") or end["size"]
    return (said["field"], said["plus"]) if isinstance(said, dict) else (str(said), 0)


def _means_something(raw: object, part: dict) -> bool:
    """Whether a raw value is one that the ICD gives a meaning; of a float its bits are
    given.
    """
    if part["type"] != "float":
        return any(one["value"] == raw for one in part.get("special", ()))
    named = (
        special("float", part["bits"], one["value"], one["meaning"])
        for one in part.get("special", ())
    )
    one = Scalar(
        name="",
        at=0,
        bits=part["bits"],
        type="float",
        special=tuple(found for found in named if found),
    )
    return codec.special_of(one, int(str(raw), 16)) is not None


def _physical(
    about: str, name: str, ours: float, theirs: object, exact: float, into: Agreement
) -> None:
    assert isinstance(theirs, (int, float))
    if ours != exact:
        into.differences.append(f"{about}: {name} is {ours!r}, exactly {exact!r}")
    elif ours != theirs:
        if abs(ours - theirs) <= ROUNDS_OFF * max(1.0, abs(ours)):
            into.rounded += 1
        else:
            into.differences.append(
                f"{about}: {name} is {ours!r}, the library says {theirs!r}"
            )


def random_frames(one: Definition, chance: random.Random, count: int) -> list[bytes]:
    """Frames of a message: zeros, ones, random bytes; with its constants, and as many
    elements as they say.
    """
    if not one.ends and not one.length:
        return [b""]
    found = []
    for number in range(count):
        there = [(end, _elements(end, number, chance)) for end in one.ends]
        # Arrays in elements can have the same counter.
        inner = {
            _counter(part)[0]: (part, _elements(part, number, chance))
            for part in one.inner
        }
        counts = {name: elements for name, (_, elements) in inner.items()}
        length = one.length + sum(
            elements * one.element(end, counts) for end, elements in there
        )
        data = (
            bytes(length)
            if number == 0
            else b"\xff" * length
            if number == 1
            else chance.randbytes(length)
        )
        if len(there) == 1 and there[0][0].get("type") == "text":
            data = data[: one.length] + bytes(
                chance.choices(range(32, 127), k=length - one.length)
            )
        for part in one.fields:
            if "const" in part:
                data = _put(data, part, part["const"])
            for end, elements in (*there, *inner.values()):
                if part["name"] == _counter(end)[0]:
                    data = _put(data, part, elements - _counter(end)[1])
        data = _chosen(one, data, chance) if number % 4 else data
        if (
            one.may_end_early and number % 2
        ):  # with zeros at the end, which are not sent
            data = data[: chance.randint(1, len(data))].rstrip(b"\0") or data[:1]
        found.append(data)
    return found


def _chosen(one: Definition, data: bytes, chance: random.Random) -> bytes:
    """The frame with a value on which others depend, for each field that some depend
    on.
    """
    wanted: dict[str, list[int]] = {}
    for part in one.fields:
        for name, values in part.get("when", {}).items():
            wanted.setdefault(name, []).extend(values)
    for part in one.fields:
        if part["name"] in wanted:
            data = _put(data, part, chance.choice(wanted[part["name"]]))
    return data


def _elements(end: dict, number: int, chance: random.Random) -> int:
    """How many elements the frame of a number has: as few as can be, all, one more, or
    any number.
    """
    least, most = max(0, _counter(end)[1]), end["up_to"]
    return (
        (least, most, min(least + 1, most))[number]
        if number < 3
        else chance.randint(least, most)
    )


def _put(data: bytes, part: dict, value: int) -> bytes:
    """The frame with another value in a field, whose bits are counted from the least
    significant one unless it says so.
    """
    at, is_big = part["at"], part.get("bit_order") == "msb0"
    if is_big:  # and the most significant byte first: the frame is one number that begins with its highest bit
        at = 8 * len(data) - at - part["bits"]
        if part.get("byte_order") == "little" and part["bits"] > 8:
            value = int.from_bytes(
                (value % (1 << part["bits"])).to_bytes(part["bits"] // 8, "little"),
                "big",
            )
    mask = (1 << part["bits"]) - 1 << at
    bits = (
        int.from_bytes(data, "big" if is_big else "little") & ~mask | value << at & mask
    )
    return bits.to_bytes(len(data), "big" if is_big else "little")


def _exact(formula: str, raw: int) -> float:
    terms = coefficients(formula)
    if len(terms) > 2:  # docs/guides/scales.md says how a polynomial is computed
        computed = float(terms[-1])
        for term in terms[-2::-1]:
            computed = float(term) + raw * computed
        return computed
    value = parse(formula).physical(Fraction(raw))
    return (
        value.numerator / value.denominator
    )  # true division of integers is correctly rounded


def _double(bits: str) -> float:
    return struct.unpack(">d", bytes.fromhex(bits))[0]


def _same(ours: object, theirs: object, part: dict) -> bool:
    """Whether a testee's raw value is the library's.

    Of text a library keeps what stands before a NUL.
    """
    if isinstance(ours, list) and part["type"] == "text":
        return isinstance(theirs, list) and all(
            _same(*pair, part) for pair in zip(ours, theirs, strict=True)
        )
    if part["type"] in ("bytes", "text"):
        wide = isinstance(theirs, int)  # some read bytes as one number
        data = theirs.to_bytes(part["bits"] // 8, "little") if wide else bytes(theirs)  # type: ignore
        mine = bytes.fromhex(str(ours))
        return mine == data or (
            part["type"] == "text" and mine.startswith(data + b"\0")
        )
    if isinstance(theirs, (list, tuple)):
        return isinstance(ours, list) and all(
            _same(*pair, part) for pair in zip(ours, theirs, strict=True)
        )
    if isinstance(theirs, float) and isinstance(ours, str):
        code = {16: "e", 32: "f", 64: "d"}[part["bits"]]
        value = struct.unpack(f">{code}", bytes.fromhex(ours))[0]
        return struct.pack(">d", value) == struct.pack(">d", theirs) or (
            value != value and theirs != theirs
        )  # both NaN
    return ours == theirs
