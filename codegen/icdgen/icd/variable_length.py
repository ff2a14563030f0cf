"""Variable-length fields of a message as a file declares them, and their faults.

They follow the fixed part, one directly after another, and fields of fixed size can
follow them. Another field, or the end of the frame, gives the number of elements.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import takewhile

from icdgen.frozen import NamedTuple
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


def sequence_of(owner: Map) -> list[Map]:
    """Return the variable-length fields of a message or struct and the fields that name
    the field in front of them, in the order of the file; none without a variable-length
    field.
    """
    items = placed_fields(owner, lambda item: is_variable(item) or "after" in item)
    return items if any(map(is_variable, items)) else []


def fixed_fields_after(message: Map) -> list[Map]:
    """Return the fields of fixed size that are placed at or after the start of the
    first variable-length field and do not name the field in front of them.
    """
    first = next(iter(variable_fields(message)), None)
    if first is None or _is_unknown(message, first):
        return []
    fixed = placed_fields(
        message,
        lambda item: (
            not is_variable(item) and not item.get("view") and "after" not in item
        ),
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
    most = (1 << counter["bits"]) - 1 + plus
    elements = "bytes" if key == "size" else "elements"
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
    """Yield the faults of the position and the type of a variable-length field, or of a
    field of fixed size behind one.
    """
    # `faults_of_count` reports an unknown counter. The field may be meant as a fixed
    # array, so its position is not checked.
    if is_variable(item) and _is_unknown(message, item):
        return
    sequence = sequence_of(message)
    index = next(index for index, row in enumerate(sequence) if row is item)
    fault = _fault_of_order(message, sequence, index)
    if fault is not None:
        yield fault
        return
    if is_variable(item):
        yield from _faults_of_variable_type(item, structs)
    else:
        yield from faults_of_bytes(item, structs)
        yield from faults_of_keys(item, ("view", "bitfields"))
    longest = message["length"] + sum(_most_bytes(row, structs) for row in sequence)
    if longest > MOST_BYTES and item is [*filter(is_variable, sequence)][-1]:
        text = f"`{message['name']}` can have {longest:,} bytes with all of `{item['name']}`, more than the limit of {MOST_BYTES:,}"
        yield Fault.at(item, "up_to", text, "correct `up_to`")


def _fault_of_order(message: Map, sequence: list[Map], index: int) -> Fault | None:
    """Return the first fault of the position of a field of the sequence; None if it has
    none. Further faults would only follow from it.
    """
    item, earlier = sequence[index], sequence[:index]
    name, fixed = f"`{item['name']}`", 8 * message["length"]
    before = earlier[-1] if earlier else None
    # The fault of the field that names this one is reported there.
    if any(row.get("after") == item["name"] for row in earlier):
        return None
    if item.get("after") in [row["name"] for row in sequence[index + 1 :]]:
        text = f"{name} follows `{item['after']}`, which is listed later in the file"
        help = (
            "list variable-length fields, and fields behind them, in the order of the frame; "
            "`after` names the one directly in front"
        )
        return Fault.at(item, "after", text, help)
    if before is None and "after" in item:
        text = f"{name} has `after: {item['after']}`, but no field in front of it has a variable length"
        help = (
            "remove `after`: the first variable-length field begins where `length` ends"
            if is_variable(item)
            else "list it behind the variable-length field, or remove `after` and correct `at`"
        )
        return Fault.at(item, "after", text, help)
    if before is not None and item.get("after") != before["name"]:
        text = (
            f"{name} is not the first variable-length field of `{message['name']}`"
            if is_variable(item) and is_variable(before)
            else f"{name} is behind `{before['name']}`, whose end is not at a fixed place"
        )
        help = f"write `after: {before['name']}`, the field in front of it"
        if "after" in item:
            return Fault.at(item, "after", text, help, yaml_text(before["name"]))
        return Fault.at(item, "name", text, help)
    to_end = next(
        (row for row in earlier if is_variable(row) and counting(row).name == REST),
        None,
    )
    if to_end is not None and is_variable(item):
        text = (
            f"{name} follows `{to_end['name']}`, which extends to the end of the frame"
        )
        help = (
            f"let a field count `{to_end['name']}`: write its name instead of `{REST}`"
        )
        return Fault.at(item, "after", text, help)
    if "reserved" in message:
        text = f"`{message['name']}` has `reserved` bytes, which cannot follow {name}, a variable-length field"
        help = (
            "remove `reserved`, and describe bytes at the end of a frame as `bytes` with `after`; "
            f"`length` ends where `{sequence[0]['name']}` begins"
        )
        return Fault.at(message, "reserved", text, help)
    if item["at"] != fixed:
        is_behind = "is behind a field of" if not is_variable(item) else "has a"
        text = f"{name} {is_behind} variable length and begins at bit {item['at']:,}, but `length` ends at bit {fixed:,}"
        help = (
            "`length` is that of the fields in front of the first variable-length field; "
            "this field and all fields with `after` have `at` there"
        )
        return Fault.at(item, "at", text, help)
    return None


def _most_bytes(item: Map, structs: Lengths) -> int:
    """Return the greatest number of bytes of a field of the sequence of a message."""
    key = "up_to" if is_variable(item) else "count"
    return _integer(item, key) * element_bits(item, structs) // 8


def _integer(item: Map, key: str) -> int:
    """Return a number of a field; 1 if it is absent or, which the schema check reports,
    not a number.
    """
    value = item.get(key)
    return value if type(value) is int else 1


def faults_of_bytes(item: Map, structs: Lengths) -> Iterator[Fault]:
    """Yield the fault of a field that other fields follow and that ends within a byte."""
    count = 1 if is_variable(item) else _integer(item, "count")
    if element_bits(item, structs) * count % 8:
        text = (
            f"`{item['name']}` does not have whole bytes, so what follows has no place"
        )
        help = "combine it with its neighbours to whole bytes: write them as a struct"
        yield Fault.at(item, "bits", text, help)


def faults_of_keys(item: Map, keys: Iterable[str]) -> Iterator[Fault]:
    """Yield the faults of keys that a field without a fixed place cannot have."""
    for key in keys:
        if item.get(key):
            text = f"`{item['name']}` has no fixed place, so it cannot have `{key}`"
            front = item.get("after")
            help = f"remove `{key}`, or place the field in front of `{front}`"
            yield Fault.at(item, key, text, help)


def _faults_of_variable_type(item: Map, structs: Lengths) -> Iterator[Fault]:
    """Yield the faults of the type and the keys of a variable-length field."""
    name, is_octets = f"`{item['name']}`", item.get("type") in _OCTETS
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


def faults(message: Map, item: Map, structs: Lengths) -> Iterator[Fault]:
    """Yield all faults of a variable-length field, or of a field behind one."""
    if is_variable(item):
        yield from faults_of_count(message, item)
    yield from faults_of_place(message, item, structs)
