"""Compare what generated code decodes from random frames with what the library decodes."""

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

# Largest deviation of a library's double from the exact value, relative or in units.
ROUNDS_OFF = 1e-9


@dataclass
class Agreement:
    """Counts and differences of the comparison in one language."""

    messages: int = 0
    frames: int = 0
    values: int = 0
    # ours is the double nearest to the exact value, the library's is not
    rounded: int = 0
    impossible: int = 0  # the library's value has more bits than the field
    # Special values of the ICD, and values that the library reports as absent.
    special: int = 0
    # frames of the library, from its raw values and from its physical ones
    encoded: int = 0
    refused: int = 0  # frames that the library identifies as another message
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
    """Decode ``frames`` random frames of each message with the testee and the library.

    Supported frames are also encoded again and compared with the library's frame.
    Counts and differences are added to ``into``.
    """
    chance = random.Random(f"{seed} {node}")
    samples = [
        (definition, data)
        for definition in messages
        for data in random_frames(definition, chance, frames)
    ]
    sharing = Counter((definition.kind, definition.id) for definition in messages)
    requests = [
        {
            "op": "decode",
            "node": node,
            "kind": definition.kind,
            "id": definition.id,
            "bytes": data.hex(),
        }
        for definition, data in samples
    ]
    # If messages share the id, this response identifies the message.
    plain = testee.ask([json.dumps(request).encode() for request in requests])
    named = [
        {**request, "message": definition.name}
        for request, (definition, _) in zip(requests, samples, strict=True)
    ]
    shares_id = [
        sharing[definition.kind, definition.id] > 1 for definition, _ in samples
    ]
    # The second request names the message, so that the values can be compared.
    of_shared = iter(
        testee.ask(
            [
                json.dumps(request).encode()
                for request, is_shared_id in zip(named, shares_id, strict=True)
                if is_shared_id
            ]
        )
    )
    read, to_encode = set(), []
    for (definition, data), answer, is_shared_id in zip(
        samples, plain, shares_id, strict=True
    ):
        identified = (
            json.loads(answer or b"{}").get("message")
            if is_shared_id
            else definition.name
        )
        answer = next(of_shared) if is_shared_id else answer
        try:
            raw, physical = definition.raw(data), definition.physical(data)
        except NotSupported:
            into.refused += 1
            continue
        into.frames += 1
        read.add(definition.name)
        decoded = json.loads(answer or b"{}")
        about = f"{node} {definition.name} {data.hex()}"
        if not decoded.get("ok"):
            into.differences.append(f"{about}: {decoded}")
            continue
        if identified != definition.name:
            into.differences.append(f"{about}: taken for {identified}")
        formulas = {}
        for name, part, ours in _values(definition, decoded["raw"]):
            formulas[name] = part.get("formula", "")
            _compare_raw(about, name, part, ours, raw, into)
        for name, bits in decoded["physical"].items():
            if name in physical and bits is not None:
                into.values += 1
                exact = _exact(formulas[name], decoded["raw"][name])
                _compare_physical(
                    about, name, _double(bits), physical[name], exact, into
                )
        if definition.encoded is not None:
            expected = definition.encoded(data).hex()
            if decoded["bytes"] != expected:
                into.differences.append(
                    f"{about}: is encoded as {decoded['bytes']}, by the library as {expected}"
                )
            request = {
                "op": "encode",
                "node": node,
                "kind": definition.kind,
                "id": definition.id,
            }
            to_encode.append(
                (
                    {**request, **_to_encode(definition, decoded["raw"], physical)},
                    expected,
                )
            )
        for end in definition.ends:
            elements = _present_elements(end, decoded["raw"])
            extra = [
                name for name in raw if name.startswith(f"{end['name']}[{elements}]")
            ]
            into.differences += [
                f"{about}: {elements} elements, the library says more"
                for _ in extra[:1]
            ]
    responses = testee.ask([json.dumps(request).encode() for request, _ in to_encode])
    for (request, expected), answer in zip(to_encode, responses, strict=True):
        into.encoded += 1
        if json.loads(answer or b"{}").get("bytes") != expected:
            into.differences.append(
                f"{request}: is encoded as {answer!r}, by the library as {expected}"
            )
    into.messages += len(messages)
    into.unread |= {definition.name for definition in messages} - read


def _compare_raw(
    about: str, name: str, part: dict, ours: object, theirs: Values, into: Agreement
) -> None:
    """Compare the raw value of a field with the library's, if it has one."""
    # An optional field is absent in both readings or in none.
    if "when" in part and (ours is None) != (name not in theirs):
        into.differences.append(
            f"{about}: {name} is {ours!r}, the library says {theirs.get(name, 'nothing')!r}"
        )
        return
    if name not in theirs:
        return
    into.values += 1
    value = theirs[name]
    if value is None or (isinstance(value, int) and _is_special(value, part)):
        into.special += 1
    if value is None:
        if not _is_special(ours, part):
            into.differences.append(
                f"{about}: {name} is a number, the library has no value"
            )
    elif isinstance(value, int) and value.bit_length() > part["bits"]:
        into.impossible += 1
    elif not _is_equal(ours, value, part):
        into.differences.append(
            f"{about}: {name} is {ours!r}, the library says {value!r}"
        )


def _to_encode(
    definition: Definition, raw: dict[str, object], physical: Values
) -> dict[str, dict[str, object]]:
    """Return the values of a frame for an encode request.

    Values that the library has as physical values are given as such if they can be set.
    """
    own = [part for part in definition.fields if "view" not in part]
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
            part["name"]: raw[part["name"]] for part in own if part["name"] not in given
        },
        "physical": given,
    }


def _values(
    definition: Definition, raw: dict[str, object]
) -> Iterator[tuple[str, dict, object]]:
    """Yield name, field and value of everything that was decoded.

    The value of an array is a list. Of a variable-length field it has the present
    elements.
    """
    for part in definition.fields:
        name = part["name"]
        count = _present_elements(part, raw) if "up_to" in part else part.get("count")
        if "size" in part:
            yield name, part, str(raw[name])[: 2 * count]
        else:
            yield from _values_of(definition, part, name, count, raw)


def _values_of(
    definition: Definition,
    part: dict,
    name: str,
    count: int | None,
    raw: dict[str, object],
) -> Iterator[tuple[str, dict, object]]:
    """Yield a single field or an array; of an array of structs, the fields of each
    element.
    """
    if "struct" not in part:
        yield name, part, _value(raw, name, count)
        return
    for index in range(count or 0):
        for inner in definition.parts(part):
            elements = (
                _present_elements(inner, raw)
                if "up_to" in inner
                else inner.get("count")
            )
            yield from _values_of(
                definition, inner, f"{name}[{index}].{inner['name']}", elements, raw
            )


def _value(raw: dict[str, object], name: str, count: int | None) -> object:
    return (
        raw[name]
        if count is None
        else [raw[f"{name}[{index}]"] for index in range(count)]
    )


def _present_elements(end: dict, raw: dict[str, object]) -> int:
    """Return how many elements, or bytes, of a variable-length field are present."""
    counter, plus = _counter(end)
    return (
        int(
            str(
                raw[
                    (
                        f"{end['name']} {'Size' if 'size' in end else 'Count'}"
                        if counter == "rest"
                        else counter
                    )
                ]
            )
        )
        + plus
    )


def _counter(end: dict) -> tuple[str, int]:
    """Return the counter of a variable-length field, and the number that is added to
    it.
    """
    counter = end.get("count") or end["size"]
    return (
        (counter["field"], counter["plus"])
        if isinstance(counter, dict)
        else (str(counter), 0)
    )


def _is_special(raw: object, part: dict) -> bool:
    """Return whether a raw value is a special value of the ICD; a float is given as its
    bits.
    """
    if part["type"] != "float":
        return any(entry["value"] == raw for entry in part.get("special", ()))
    specials = (
        special("float", part["bits"], entry["value"], entry["meaning"])
        for entry in part.get("special", ())
    )
    scalar = Scalar(
        name="",
        at=0,
        bits=part["bits"],
        type="float",
        special=tuple(filter(None, specials)),
    )
    return codec.special_of(scalar, int(str(raw), 16)) is not None


def _compare_physical(
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


def random_frames(
    definition: Definition, chance: random.Random, count: int
) -> list[bytes]:
    """Return frames of a message: all zeros, all ones, then random bytes.

    Constants are set, and the variable-length fields have as many elements as their
    counters state.
    """
    if not definition.ends and not definition.length:
        return [b""]
    frames = []
    for number in range(count):
        lengths = [(end, _elements(end, number, chance)) for end in definition.ends]
        # Arrays in elements can have the same counter.
        inner = {
            _counter(part)[0]: (part, _elements(part, number, chance))
            for part in definition.inner
        }
        counts = {name: elements for name, (_, elements) in inner.items()}
        length = definition.length + sum(
            elements * definition.element(end, counts) for end, elements in lengths
        )
        if number < 2:
            data = bytes([0xFF * number]) * length
        else:
            data = chance.randbytes(length)
        if len(lengths) == 1 and lengths[0][0].get("type") == "text":
            data = data[: definition.length] + bytes(
                chance.choices(range(32, 127), k=length - definition.length)
            )
        for part in definition.fields:
            if "const" in part:
                data = _with_value(data, part, part["const"])
            for end, elements in (*lengths, *inner.values()):
                if part["name"] == _counter(end)[0]:
                    data = _with_value(data, part, elements - _counter(end)[1])
        data = _with_discriminators(definition, data, chance) if number % 4 else data
        # Zeros at the end are not sent.
        if definition.may_end_early and number % 2:
            data = data[: chance.randint(1, len(data))].rstrip(b"\0") or data[:1]
        frames.append(data)
    return frames


def _with_discriminators(
    definition: Definition, data: bytes, chance: random.Random
) -> bytes:
    """Return the frame with a random one of the values on which optional fields depend."""
    wanted: dict[str, list[int]] = {}
    for part in definition.fields:
        for name, values in part.get("when", {}).items():
            wanted.setdefault(name, []).extend(values)
    for part in definition.fields:
        if part["name"] in wanted:
            data = _with_value(data, part, chance.choice(wanted[part["name"]]))
    return data


def _elements(end: dict, number: int, chance: random.Random) -> int:
    """Return the number of elements in the frame with a number.

    The first frames have the fewest, the most and one more than the fewest elements;
    others have a random number.
    """
    least, most = max(0, _counter(end)[1]), end["up_to"]
    return (
        (least, most, min(least + 1, most))[number]
        if number < 3
        else chance.randint(least, most)
    )


def _with_value(data: bytes, part: dict, value: int) -> bytes:
    """Return the frame with another value in a field.

    Bits are counted from the least significant bit unless the bit order is ``msb0``.
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


def _is_equal(ours: object, theirs: object, part: dict) -> bool:
    """Return whether the testee's raw value equals the library's.

    Libraries return text only up to its first NUL.
    """
    if isinstance(ours, list) and part["type"] == "text":
        return isinstance(theirs, list) and all(
            _is_equal(*pair, part) for pair in zip(ours, theirs, strict=True)
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
            _is_equal(*pair, part) for pair in zip(ours, theirs, strict=True)
        )
    if isinstance(theirs, float) and isinstance(ours, str):
        code = {16: "e", 32: "f", 64: "d"}[part["bits"]]
        value = struct.unpack(f">{code}", bytes.fromhex(ours))[0]
        return struct.pack(">d", value) == struct.pack(">d", theirs) or (
            value != value and theirs != theirs
        )  # both NaN
    return ours == theirs
