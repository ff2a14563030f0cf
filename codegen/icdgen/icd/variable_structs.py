"""Variable-length arrays in structs as a file declares them, and their faults.

They follow the fixed part of the struct, and fields of fixed size can follow them.
Fields of the message count their elements, so all elements of an array of such structs
have the same size.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.suggestions import yaml_text
from icdgen.icd.variable_length import (
    MOST_ELEMENTS,
    REST,
    Lengths,
    count_key,
    counting,
    fault_without_most,
    faults_of_bytes,
    faults_of_keys,
    is_variable,
    placed_fields,
    reason_against,
    sequence_of,
    variable_fields,
)


def arrays_of_struct(struct: Map) -> Iterator[Map]:
    """Yield the variable-length arrays of a struct."""
    return filter(is_variable, sequence_of(struct))


def is_variable_struct(struct: Map) -> bool:
    """Return whether a struct has a variable-length array."""
    return any(arrays_of_struct(struct))


def faults_in_struct(
    struct: Map, structs: Lengths, variable: Container[str]
) -> Iterator[Fault]:
    """Yield the faults of the variable-length arrays of a struct and of the fields
    behind them.

    `variable` has the names of structs with variable-length arrays. Their counters are
    fields of a message; `faults_of_inner_counts` checks them.
    """
    before: Map | None = None
    for item in sequence_of(struct):
        name = f"`{item['name']}`"
        key = count_key(item)
        # A field at the wrong place makes the places of all fields behind it wrong.
        # Therefore only the first error of this kind is reported.
        if before is None and not is_variable(item):
            text = f"{name} has `after: {item['after']}`, but no field in front of it has a variable length"
            yield Fault.at(
                item,
                "after",
                text,
                "write it in front of the fields with `after`, and remove `after`",
            )
            return
        if before is not None and item.get("after") != before["name"]:
            text = f"{name} is behind `{before['name']}`, whose end is not at a fixed place"
            fix = yaml_text(before["name"]) if "after" in item else ""
            help = f"write `after: {before['name']}`, the field in front of it"
            yield Fault.at(
                item, "after" if "after" in item else "name", text, help, fix
            )
            return
        if before is None and "after" in item:
            text = f"{name} is the first field of `{struct['name']}` with a variable length"
            yield Fault.at(
                item, "after", text, "remove `after`: it begins where `length` ends"
            )
            return
        if item["at"] != 8 * struct["length"]:
            text = f"{name} begins at bit {item['at']:,}, but `length` ends at bit {8 * struct['length']:,}"
            help = (
                "`length` is that of the fields in front of the first variable-length array; "
                "this array and all fields with `after` have `at` there"
            )
            yield Fault.at(item, "at", text, help)
            return
        before = item
        if "size" in item and is_variable(item):
            text = f"{name} is `{item.get('type')}` of variable length, which is not supported in a struct"
            yield Fault.at(
                item,
                key,
                text,
                "write an array of numbers: `bits: 8`, `type: uint` and `count`",
            )
        elif is_variable(item) and counting(item).name == REST:
            text = f"{name} extends to the end of the frame, which is not supported in a struct"
            yield Fault.at(
                item, key, text, "name a field of the message that counts the elements"
            )
        elif is_variable(item) and "up_to" not in item:
            yield fault_without_most(item)
        elif is_variable(item) and item["up_to"] > MOST_ELEMENTS:
            text = f"{name} has up to {item['up_to']:,} elements: an array has at most {MOST_ELEMENTS:,}"
            yield Fault.at(item, "up_to", text, f"write up to {MOST_ELEMENTS:,}")
        elif is_variable(item) and counting(item).plus > item["up_to"]:
            text = f"{name} has at least {counting(item).plus:,} elements, and up to {item['up_to']:,}"
            yield Fault.at(item, "up_to", text, "correct `up_to`, or `plus`")
        if item.get("struct") in variable:
            text = f"`{item['struct']}` has a variable length, and so has `{struct['name']}`, which contains it"
            yield Fault.at(
                item,
                "struct",
                text,
                "write its fields into the outer struct: one level is supported",
            )
        else:
            yield from faults_of_bytes(item, structs)
        yield from faults_of_keys(item, ("view", "bitfields", "when"))


def faults_of_inner_counts(
    message: Map, item: Map, structs: Mapping[str, Map]
) -> Iterator[Fault]:
    """Yield the faults of the counters of a struct with variable-length arrays, at the
    field of a message that uses it.
    """
    struct = structs.get(item["struct"])
    if struct is None or not is_variable_struct(struct):
        return
    name, part = f"`{item['name']}`", f"struct `{struct['name']}`"
    if not is_variable(item) or counting(item).name == REST:
        text = f"the {part} has a variable length, and {name} is no array that a field counts"
        help = "let a field of the message count the elements: write its name as `count`, and `up_to`"
        yield Fault.at(item, "count" if "count" in item else "struct", text, help)
        return
    counters = {counting(other).name for other in variable_fields(message)}
    for inner in arrays_of_struct(struct):
        counter_name, plus = counting(inner)
        if counter_name == REST:
            continue  # `faults_in_struct` reports it
        array = f"`{inner['name']}` of the {part}"
        counter = next(
            (
                field
                for field in placed_fields(message)
                if field["name"] == counter_name
            ),
            None,
        )
        if counter is None or "struct" in counter:
            text = f"`{message['name']}` has no field `{counter_name}` that could count {array}"
            yield Fault.at(
                item,
                "struct",
                text,
                f"add `{counter_name}` to the message, or correct `count` in the struct",
            )
            continue
        if counter_name in counters:
            text = f"`{counter_name}` counts both {array} and a variable-length field of the message"
            yield Fault.at(item, "struct", text, "name another counter in the struct")
            continue
        reason = reason_against(counter, message)
        most = (1 << counter["bits"]) - 1 + plus
        if reason:
            text = f"`{counter_name}` cannot count {array}: it {reason}"
            help = "name an unsigned number without a formula, within the `length` of the message"
            yield Fault.at(item, "struct", text, help)
        elif "up_to" in inner and most < inner["up_to"]:
            up_to = f"counts up to {max(most, 0):,}, and {array} has up to {inner['up_to']:,}"
            text = f"`{counter_name}` ({counter['bits']} bits) {up_to}"
            yield Fault.at(
                item,
                "struct",
                text,
                f"correct `up_to` in the struct, or the `bits` of `{counter_name}`",
            )
        # Several arrays can have one counter, if there is a number that all of them can
        # have.
        for other in _inner_arrays_before(message, inner, structs):
            other_name, other_plus = counting(other)
            low = max(0, -plus, -other_plus)
            high = min(inner.get("up_to", 0) - plus, other.get("up_to", 0) - other_plus)
            if other_name == counter_name and low > high:
                text = f"`{counter_name}` counts {array} and `{other['name']}`, and no value suits both"
                yield Fault.at(
                    item,
                    "struct",
                    text,
                    "correct `up_to` or `plus`, or name another counter",
                )
                break


def _inner_arrays_before(
    message: Map, inner: Map, structs: Mapping[str, Map]
) -> Iterator[Map]:
    """Yield the variable-length arrays of structs that a message uses, up to one of
    them.
    """
    for item in variable_fields(message):
        struct = structs.get(item.get("struct", ""))
        for other in arrays_of_struct(struct) if struct is not None else ():
            if other is inner:
                return
            yield other
