"""Answer requests of the conformance run about messages: one line of words in, one line
out.

Run ``python -m PACKAGE._testee``. The README of icdgen's conformance tests describes
the words.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple, Optional

from . import _compiled, _floats
from ._base import FieldInfo, Message
from ._curves import on_curve
from ._errors import LengthError, RangeError, UnknownIdError
from ._testee_order import ORDER
from ._testee_words import Refusal, Words, counted

_LIMITS = {"min": "minimum", "max": "maximum", "above": "above", "below": "below"}


def answer(line: str) -> str:
    """Return the answer to a request."""
    words = iter(line.split(" "))
    name = next(words)
    operation = _OPERATIONS.get(name)
    try:
        if operation is None:
            from .wire import _testee

            return "ok" + _testee.answer(name, _node(words), words)
        return "ok" + operation(_node(words), words)
    except Refusal as refusal:
        return f"refused {refusal}"
    except UnknownIdError:
        return "refused unknown-id"
    except LengthError as error:
        return f"refused {counted('length', error)}"
    except RangeError as error:
        return f"refused range field={error.field.encode().hex()}"


def main() -> None:
    """Answer every line of standard input."""
    for line in sys.stdin:
        sys.stdout.write(answer(line.rstrip("\n")) + "\n")
        sys.stdout.flush()


def _node(words: Words) -> Any:
    return import_module(f".{ORDER[int(next(words))]}", __package__)


def _message(node: Any, words: Words) -> type[Message]:
    messages = node.TELEMETRY if next(words) == "1" else node.TELECOMMANDS
    id, _, name = next(words).partition(":")
    if not name:
        return messages[int(id)]  # type: ignore[no-any-return]
    wanted = bytes.fromhex(name).decode()
    sharing: tuple[type[Message], ...] = messages.of(int(id))
    return next(
        message_class for message_class in sharing if wanted == message_class.NAME
    )


def _decode(node: Any, words: Words) -> str:
    message = _message(node, words)
    frame = message.from_bytes(bytes.fromhex(next(words)))
    if isinstance(frame, message):
        return _described(frame, names=True)
    return f" name={_hex(frame.NAME)} bytes={frame.to_bytes().hex()}"


@cache
def _names(message: type[Message]) -> dict[str, str]:
    """Return attribute -> name of each field, including elements and fields of structs."""
    return {
        field_info.attribute: field_info.name
        for info in message.FIELDS
        for line in (info, *info.lines)
        for field_info in (line, *line.parts)
    }


def _encode(node: Any, words: Words) -> str:
    message = _message(node, words)()
    try:
        count = ""
        for owned in _owned_fields(message, is_made=True):
            if owned.info.attribute:
                _set(owned, words)
            else:
                count = next(words)
        if message.TAIL is not None:
            _cut(message, count)
        return _described(message)
    except RangeError as error:
        name = _names(type(message))[error.field]
        raise Refusal(f"range field={_hex(name)}") from None


def _set(owned: OwnedField, words: Words) -> None:
    """Set a field or an array by its raw or its physical value."""
    info, owner = owned.info, owned.owner
    if info.elements:
        _set_elements(owned, words)
        return
    word = next(words)
    try:
        if word == "n":
            setattr(owner, info.attribute, None)
        elif word[0] == "p":
            setattr(owner, info.physical, _physical(info, word[1:]))
        elif info.is_open and len(word) != 1 + info.bits // 4:
            raise Refusal(f"range field={_hex(owned.name)}")
        else:
            setattr(owner, info.attribute, _raw(info, word[1:]))
    except RangeError:
        raise Refusal(f"range field={_hex(owned.name)}") from None


def _set_elements(owned: OwnedField, words: Words) -> None:
    """Set each element of an array by its raw or its physical value."""
    raw: list[Any] = []
    info, owner = owned.info, owned.owner
    for index, word in zip(range(info.elements), words):
        if word[0] == "p":
            values = (_physical(info, word[1:]),) * info.elements
            try:
                setattr(owner, info.physical, values)
            except RangeError:
                raise Refusal(f"range field={_hex(f'{owned.name}[{index}]')}") from None
            raw.append(getattr(owner, info.attribute)[index])
        else:
            raw.append(_raw(info, word[1:]))
    setattr(owner, info.attribute, tuple(raw))


class OwnedField(NamedTuple):
    """A field and its owner: a message, or a struct in a message. ``name`` is the full
    name.
    """

    owner: Any
    info: FieldInfo
    name: str


def _owned_fields(
    owner: Any, head: str = "", is_made: bool = False
) -> Iterator[OwnedField]:
    """Yield the fields of a message, including fields of structs and counters without a
    field.

    Missing elements of a variable-length array read as 0, and with ``is_made`` are
    created.
    """
    for info in owner.FIELDS:
        name = f"{head}{info.name}"
        if info.struct is None:
            yield OwnedField(owner, info, name)
        else:
            yield from _owned_fields_of_struct(owner, info, name, is_made)
        if info.is_open and not owner.TAIL.counter:
            count = _implied(owner)
            yield OwnedField(owner, count, count.name)


def _owned_fields_of_struct(
    owner: Any, info: FieldInfo, name: str, is_made: bool
) -> Iterator[OwnedField]:
    """Yield the fields of a struct, or of each struct in an array."""
    value = getattr(owner, info.attribute)
    if info.is_open:
        value += _full_tail(owner)[len(value) :]
    if info.is_open and is_made:
        setattr(owner, info.attribute, value)
    for index in range(info.elements or 1):
        element = value[index] if info.elements else value
        yield from _owned_fields(
            element, f"{name}[{index}]." if info.elements else f"{name}."
        )


@cache
def _decoder(kind: type[Message]) -> Any:
    """Return the decoder of frames with all elements."""
    return _compiled.longest(kind, "from_bytes")


def _full_tail(message: Any) -> Any:
    """Return the variable-length field of a message with all elements, each 0."""
    kind: type[Message] = type(message)
    zeros = _decoder(kind)(kind, bytes(kind.LENGTH))
    return getattr(zeros, message.TAIL.part)


def _cut(message: Message, word: str) -> None:
    """Drop the elements that do not belong to the frame. The counter gives their
    number, or ``word`` without a counter.
    """
    tail: Any = message.TAIL
    if tail.counter:
        count = getattr(message, tail.counter) + tail.plus
    else:
        count = int(word[1:])
        if not 0 <= count <= tail.most:
            raise Refusal(f"range field={_hex(_implied(message).name)}")
    values = getattr(message, tail.part)
    if isinstance(values, bytes):
        values = values.ljust(tail.most, b"\0")
    setattr(message, tail.part, values[:count])


def _implied(message: Message) -> FieldInfo:
    """Return the number of elements as a field, if no field of the frame contains it."""
    tail: Any = message.TAIL
    info = next(
        field_info for field_info in message.FIELDS if field_info.attribute == tail.part
    )
    name = f"{info.name} {'Count' if info.elements else 'Size'}"
    return FieldInfo("", name, 0, 8, "uint")


class Element:
    """A field, or an element of an array."""

    def __init__(self, owned: OwnedField, index: int) -> None:
        self.owner, self.info, self.index = owned.owner, owned.info, index
        self.name = f"{owned.name}[{index}]" if self.info.elements else owned.name

    def get(self, attribute: str) -> Any:
        """Return the value of the attribute."""
        info, owner = self.info, self.owner
        if not attribute:
            return len(getattr(owner, owner.TAIL.part))
        value = getattr(owner, attribute)
        if not info.elements:
            is_cut = info.is_open and attribute == info.attribute
            return value.ljust(info.bits // 8, b"\0") if is_cut else value
        if self.index < len(value):
            return value[self.index]  # otherwise it is not in the frame
        if info.type in ("bytes", "text"):
            return "" if attribute == info.physical else bytes(info.bits // 8)
        if attribute == info.physical:
            _, c, q = info.scale
            return on_curve(info.curve, 0) if info.curve else c / q
        if info.enum:
            return info.enum(0)
        return 0.0 if info.type == "float" else 0

    def set(self, attribute: str, value: Any) -> None:
        """Set the attribute and leave the other elements unchanged."""
        if self.info.elements:
            present = list(getattr(self.owner, attribute))
            values = [
                present[i] if i < len(present) else 0 for i in range(self.index + 1)
            ]
            values += present[self.index + 1 :]
            values[self.index] = value
            value = tuple(values)
        setattr(self.owner, attribute, value)


def _elements(message: Message) -> list[Element]:
    all_fields = list(_owned_fields(message))
    all_fields += (OwnedField(message, info, info.name) for info in message.VIEWS)
    return [
        Element(owned, index)
        for owned in all_fields
        for index in range(owned.info.elements or 1)
    ]


def _physical(info: FieldInfo, word: str) -> Any:
    """Return a physical value from a word; for text the characters."""
    return (
        bytes.fromhex(word).decode()
        if info.type == "text"
        else _floats.float64(int(word))
    )


def _raw(info: FieldInfo, word: str) -> Any:
    if info.type == "float":
        bits = int(word)
        return _floats.float32(bits) if info.bits == 32 else _floats.float64(bits)
    if info.type in ("bytes", "text"):
        return bytes.fromhex(word)
    return word == "1" if info.type == "bool" and word in "01" else int(word)


def _shown(info: FieldInfo, value: Any) -> Any:
    if value is None:
        return "-"
    if info.type == "float":
        is_single = info.bits == 32
        return (_floats.float32_bits if is_single else _floats.float64_bits)(value)
    return value.hex() if isinstance(value, bytes) else int(value)


def _hex(text: str) -> str:
    return text.encode("utf-8", "surrogatepass").hex()


def _field(element: Element) -> str:
    value = _shown(element.info, element.get(element.info.attribute))
    return f" field field={_hex(element.name)} raw={value}"


def _described(message: Message, names: bool = False) -> str:
    reply = [f" bytes={message.to_bytes().hex()}"]
    for element in _elements(message):
        info = element.info
        reply.append(_field(element))
        if info.type == "text":
            text = element.get(info.physical)
            reply.append("" if "\ufffd" in text else f" physical={_hex(text)}")
        elif info.physical and element.get(info.physical) is not None:
            bits = _floats.float64_bits(element.get(info.physical))
            reply.append(f" physical={bits}")
        if names and info.enum and element.get(info.attribute) is not None:
            label = element.get(info.attribute).label
            reply.append(f" name={_hex(label)}" if label else "")
    return "".join(reply)


def _constants(node: Any, words: Words) -> str:
    message = _message(node, words)()
    ids = ",".join(map(str, message.IDS))
    reply = [f" name={_hex(message.NAME)} length={message.LENGTH} ids={ids}"]
    for element in _elements(message):
        info = element.info
        special = ",".join(str(_shown(info, value)) for value, _ in info.special)
        reply.append(f"{_field(element)} special={special}")
        for key, name in _LIMITS.items():
            bound = getattr(info, name)
            if bound is not None:
                reply.append(f" {key}={_floats.float64_bits(float(bound))}")
    return "".join(reply)


def _enum(node: Any, words: Words) -> str:
    enum = getattr(node, list(node.ENUMS.values())[int(next(words))])
    try:
        label = enum(int(next(words))).label
    except ValueError:  # beyond 64 bits
        label = ""
    return f" name={_hex(label)}" if label else ""


def _about_node(node: Any, words: Words) -> str:
    names = {"node_type": "NODE_TYPE", "interface_version": "INTERFACE_VERSION"}
    return "".join(
        f" {key}={getattr(node, name)}"
        for key, name in names.items()
        if hasattr(node, name)
    )


def _sweep(node: Any, words: Words) -> str:
    message = _message(node, words)()
    element = _elements(message)[int(next(words))]
    info = element.info
    low, high = info.raw_range
    reply = []
    for raw in map(int, words):
        if not low <= raw <= high:
            raise Refusal(f"range field={_hex(element.name)}")
        element.set(info.attribute, _raw(info, str(raw)))
        physical = element.get(info.physical)
        back: Optional[int] = None
        try:
            element.set(info.physical, physical)
            back = _shown(info, element.get(info.attribute))
        except RangeError:
            pass
        reply.append(
            f"{_floats.float64_bits(physical)},{'' if back is None else back},"
        )
    return " values=" + "".join(reply)


_OPERATIONS = {
    "decode": _decode,
    "encode": _encode,
    "constants": _constants,
    "enum": _enum,
    "node": _about_node,
    "sweep": _sweep,
}

if __name__ == "__main__":
    main()
