"""Variable-length fields of a message as a file declares them, and their faults.

They follow the fixed part, one directly after another. Another field, or the end of the
frame, gives the number of elements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise, takewhile
from typing import NamedTuple

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.roles import COUNTER, reasons_against
from icdgen.icd.suggestions import suggestion, yaml_text
from icdgen.icd.trees import mappings

REST = "rest"
MOST_BYTES = 65535  # of a frame
MOST_ELEMENTS = 1024  # as of any array
_OCTETS = ("bytes", "text")
Lengths = Mapping[str, int]  # bytes of the structs that a message may name


class Counting(NamedTuple):
    """Source of the number of elements of a variable-length field."""

    name: str  # of the counter, or REST if the end of the frame gives the number
    plus: int = 0  # number of elements minus value of the counter


def is_variable(item: Map) -> bool:
    """Return whether a field has a variable length: up to the end of the frame, or
    counted by another field.
    """
    count = item.get(count_key(item))
    if isinstance(count, dict):
        return isinstance(count.get("field"), str) and type(count.get("plus")) is int
    return isinstance(count, str)


def count_key(item: Map) -> str:
    """Return the key for the number of elements: `size` for bytes and text, else
    `count`.
    """
    return "size" if "size" in item else "count"


def counting(item: Map) -> Counting:
    """Return the source of the number of elements of a variable-length field."""
    count = item[count_key(item)]
    return (
        Counting(count["field"], count["plus"])
        if isinstance(count, dict)
        else Counting(count)
    )


def variable_fields(message: Map) -> list[Map]:
    """Return the variable-length fields of a message, in the order of the file."""
    return [
        item
        for item in placed_fields(message, is_variable)
        if type(item.get("up_to", 0)) is int
    ]


def fixed_fields_after(message: Map) -> list[Map]:
    """Return the fields of fixed size that are placed at or after the start of the
    first variable-length field.
    """
    first = next(iter(variable_fields(message)), None)
    if first is None or _is_unknown(message, first):
        return []
    fixed = placed_fields(
        message,
        lambda item: not is_variable(item)
        and not item.get("view")
        and "after" not in item,
    )
    return [item for item in fixed if item["at"] >= first["at"]]


def element_bits(item: Map, structs: Lengths) -> int:
    """Return the bits of an element of a variable-length field: 8 for bytes and text, 0
    for an unknown struct.
    """
    if "struct" in item:
        return 8 * structs.get(item["struct"], 0)
    bits: int = 8 if "size" in item else item["bits"]
    return bits


def counter_of(message: Map, item: Map) -> Map | None:
    """Return the field that counts the elements; None if it is unknown, or if the end
    of the frame gives their number.
    """
    name = counting(item).name
    if name == REST:
        return None
    counter = next(
        (field for field in placed_fields(message) if field.get("name") == name), None
    )
    return None if counter is None or "struct" in counter else counter


def placed_fields(
    message: Map, wanted: Callable[[Map], bool] | None = None
) -> list[Map]:
    """Return the fields of a message with a valid position and width.

    The schema check reports the other fields.
    """
    fields = filter(wanted, mappings(message.get("fields")))
    return [field for field in fields if _is_placed(field)]


def _is_placed(item: Map) -> bool:
    """Return whether a field has a name, and a valid position and width."""
    return (
        isinstance(item.get("name"), str)
        and type(item.get("at")) is int
        and (_is_sized(item) or (type(item.get("bits")) is int and item["bits"] > 0))
    )


def _is_sized(item: Map) -> bool:
    """Return whether `size` or a struct gives the width, so that the field has no
    `bits`.
    """
    return "size" in item or isinstance(item.get("struct"), str)


def fault_without_most(item: Map) -> Fault:
    """Return the fault of a variable-length array without `up_to`."""
    text = f"`{item['name']}` has no fixed count and no `up_to`"
    help = "add `up_to:`, the greatest number of elements: buffers have that size"
    return Fault.at(item, "count", text, help)


def faults_of_count(message: Map, item: Map) -> Iterator[Fault]:
    """Yield the faults of the number of elements of a variable-length field: its
    counter, `plus` and `up_to`.
    """
    name = f"`{item['name']}`"
    key, (counter_name, plus) = count_key(item), counting(item)
    if _is_unknown(message, item):
        text = (
            f"`{message['name']}` has no field `{counter_name}` that could count {name}"
        )
        numbers = "a number, " if key == "count" else ""
        counters = [
            *(
                field["name"]
                for field in placed_fields(message)
                if _can_count(field, message)
            ),
            REST,
        ]
        help, fix = suggestion(
            counter_name,
            counters,
            f"`{key}` is {numbers}the name of an earlier field, or `{REST}`",
        )
        yield Fault.at(
            item, key, text, help, "" if isinstance(item[key], dict) else fix
        )
        return
    if "up_to" not in item:
        if key == "count":
            yield fault_without_most(item)
        return
    if item["up_to"] > MOST_ELEMENTS and key == "count":
        text = f"{name} has up to {item['up_to']:,} elements: an array has at most {MOST_ELEMENTS:,}"
        yield Fault.at(
            item, "up_to", text, "use `type: bytes` with `size: rest` for longer data"
        )
    if counter_name == REST:
        return
    counter = counter_of(message, item)
    assert counter is not None
    earlier_parts = takewhile(lambda part: part is not item, variable_fields(message))
    earlier = next(
        (part for part in earlier_parts if counting(part).name == counter_name), None
    )
    if earlier is not None:
        text = f"`{counter_name}` counts both `{earlier['name']}` and {name}"
        yield Fault.at(
            item,
            key,
            text,
            "name another counter: each variable-length field needs its own",
        )
    reason = reason_against(counter, message)
    if reason:
        text = f"`{counter['name']}` cannot count {name}: it {reason}"
        help = "name an unsigned number without a formula, within the `length` of the message"
        yield Fault.at(item, key, text, help)
        return
    # The largest number of elements that the counter can express.
    most, elements = (1 << counter["bits"]) - 1 + plus, (
        "bytes" if key == "size" else "elements"
    )
    if most < item["up_to"]:
        added = f" plus {plus}" if plus else ""
        counter_text = f"`{counter['name']}` ({counter['bits']} bits{added})"
        text = f"{counter_text} counts up to {max(most, 0):,}, and {name} has up to {item['up_to']:,} {elements}"
        smaller = f"write `up_to: {most}`" if most > 0 else "correct `up_to`"
        also = "`plus` or " if plus else ""
        help = f"{smaller}, or correct {also}the `bits` of `{counter['name']}`"
        yield Fault.at(item, "up_to", text, help, str(most) if most > 0 else "")
    elif plus > item["up_to"]:
        text = f"{name} has at least {plus:,} {elements}, and up to {item['up_to']:,}"
        yield Fault.at(item, "up_to", text, "correct `up_to`, or `plus`")


def _is_unknown(message: Map, item: Map) -> bool:
    """Return whether the message does not have the field that counts a variable-length
    field.
    """
    return counting(item).name != REST and counter_of(message, item) is None


def _can_count(field: Map, message: Map) -> bool:
    """Return whether a field can count elements."""
    return not _is_sized(field) and not reason_against(field, message)


def reason_against(counter: Map, message: Map) -> str:
    """Return why a field cannot count elements, as the end of a sentence; empty if it
    can.
    """
    reasons = reasons_against(counter, COUNTER)
    if reasons:
        return reasons[0]
    is_behind = counter["at"] + counter["bits"] > 8 * message["length"]
    return "is placed after the `length` of the message" if is_behind else ""


def faults_of_place(message: Map, item: Map, structs: Lengths) -> Iterator[Fault]:
    """Yield the faults of the position and the type of a variable-length field."""
    name, fixed = f"`{item['name']}`", 8 * message["length"]
    # `faults_of_count` reports an unknown counter. The field may be meant as a fixed
    # array, so its position is not checked.
    if _is_unknown(message, item):
        return
    # Each fault below returns at once: further faults of the position would only follow
    # from it.
    parts = variable_fields(message)
    before = next(
        (part for part, following in pairwise(parts) if following is item), None
    )
    names = [part["name"] for part in parts]
    if item.get("after") in names[names.index(item["name"]) + 1 :]:
        text = f"{name} follows `{item['after']}`, which is listed later in the file"
        help = "list variable-length fields in the order of the frame; `after` names the one directly in front"
        yield Fault.at(item, "after", text, help)
        return
    if before is None and "after" in item:
        text = f"{name} has `after: {item['after']}`, but no field in front of it has a variable length"
        yield Fault.at(
            item,
            "after",
            text,
            "remove `after`: the first variable-length field begins where `length` ends",
        )
        return
    if before is not None and item.get("after") != before["name"]:
        text = f"{name} is not the first variable-length field of `{message['name']}`"
        help = f"write `after: {before['name']}`, the field in front of it"
        if "after" in item:
            yield Fault.at(item, "after", text, help, yaml_text(before["name"]))
        else:
            yield Fault.at(item, "name", text, help)
        return
    if before is not None and counting(before).name == REST:
        text = (
            f"{name} follows `{before['name']}`, which extends to the end of the frame"
        )
        help = (
            f"let a field count `{before['name']}`: write its name instead of `{REST}`"
        )
        yield Fault.at(item, "after", text, help)
        return
    if "reserved" in message:
        text = f"`{message['name']}` has `reserved` bytes, which cannot follow {name}, a variable-length field"
        help = f"remove `reserved`; `length` is that of the shortest frame, which ends where `{parts[0]['name']}` begins"
        yield Fault.at(message, "reserved", text, help)
        return
    if item["at"] != fixed:
        text = f"{name} has a variable length and begins at bit {item['at']:,}, but `length` ends at bit {fixed:,}"
        help = "`length` is that of the shortest frame: it must end where the variable-length field begins"
        yield Fault.at(item, "at", text, help)
        return
    is_octets = item.get("type") in _OCTETS
    if "size" in item and not is_octets:
        text = f"{name} is `{item.get('type')}`: `size` is for bytes and text"
        yield Fault.at(
            item,
            "size",
            text,
            "for numbers, write the `bits` of an element and `count`",
        )
    elif element_bits(item, structs) % 8:
        text = f"an element of {name} has {element_bits(item, structs)} bits, but a frame has whole bytes"
        yield Fault.at(
            item,
            "bits",
            text,
            "describe elements of whole bytes, or the data as `bytes` with `size`",
        )
    for key in ("view", "bitfields"):
        if item.get(key):
            text = f"{name} has a variable length, so it cannot have `{key}`"
            yield Fault.at(item, key, text, f"remove `{key}`")
    longest = message["length"] + sum(
        part.get("up_to", 0) * element_bits(part, structs) // 8 for part in parts
    )
    if longest > MOST_BYTES and item is parts[-1]:
        text = f"`{message['name']}` can have {longest:,} bytes with all of {name}, more than the limit of {MOST_BYTES:,}"
        yield Fault.at(item, "up_to", text, "correct `up_to`")


def faults(message: Map, item: Map, structs: Lengths) -> Iterator[Fault]:
    """Yield all faults of a variable-length field."""
    yield from faults_of_count(message, item)
    yield from faults_of_place(message, item, structs)
