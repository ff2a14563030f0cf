"""The open parts of a message, behind all others: a frame holds as many elements of each as a field says.

In the model they have all their elements; `Message.tail` and `Message.inner` say how many of them a frame may leave out.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise, takewhile
from typing import NamedTuple

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.trees import mappings
from icdgen.suggest import close_to

REST = "rest"
MOST_BYTES = 65535  # of a frame
MOST_ELEMENTS = 1024  # as of any array
_OCTETS = ("bytes", "text")
Lengths = Mapping[str, int]  # bytes of the structs that a message may name


class Counting(NamedTuple):
    """What is said of how many elements there are: the name of a field, or `REST`, and what is added to its value."""

    name: str
    plus: int = 0


def is_open(item: Map) -> bool:
    """Whether a field is said to be there as often, or as long, as the frame goes or a field says."""
    said = item.get(key_of(item))
    if isinstance(said, dict):
        return isinstance(said.get("field"), str) and type(said.get("plus")) is int
    return isinstance(said, str)


def key_of(item: Map) -> str:
    """The key that says how many elements there are."""
    return "size" if "size" in item else "count"


def counting(item: Map) -> Counting:
    """How many elements an open part is said to have."""
    said = item[key_of(item)]
    return Counting(said["field"], said["plus"]) if isinstance(said, dict) else Counting(said)


def open_parts(message: Map) -> list[Map]:
    """The fields of a message that are said to be open."""
    return [item for item in _fields(message, is_open) if type(item.get("up_to", 0)) is int]


def unit(item: Map, structs: Lengths) -> int:
    """Bits of an element of an open part: of bytes and text 8; of a struct that there is not 0."""
    if "struct" in item:
        return 8 * structs.get(item["struct"], 0)
    bits: int = 8 if "size" in item else item["bits"]
    return bits


def counter_of(message: Map, item: Map) -> Map | None:
    """The field that says how many elements there are; None where the end of the frame does, or there is none."""
    name = counting(item).name
    found = None if name == REST else next((one for one in _fields(message) if one.get("name") == name), None)
    return None if found is None or "struct" in found else found


def _fields(message: Map, wanted: Callable[[Map], bool] | None = None) -> list[Map]:
    """Those, or the wanted ones, whose place can be read: what is wrong with the others is the schema's business."""
    return [
        item
        for item in filter(wanted, mappings(message.get("fields")))
        if isinstance(item.get("name"), str)
        and all(type(item.get(key)) is int for key in ("at", "bits")[: 1 if _is_sized(item) else 2])
        and (_is_sized(item) or item["bits"] > 0)
    ]


def _is_sized(item: Map) -> bool:
    """Whether something else than `bits` says how many there are."""
    return "size" in item or isinstance(item.get("struct"), str)


def faults_of_count(message: Map, item: Map) -> Iterator[Fault]:
    """What is wrong with how many elements there are said to be."""
    name = f"`{item['name']}`"
    key, (said, plus) = key_of(item), counting(item)
    if _is_unknown(message, item):
        text = f"`{said}`, which counts {name}, is no field of `{message['name']}`"
        numbers = "a number, " if key == "count" else ""
        near = close_to(said, [*(one["name"] for one in _fields(message) if _can_count(one, message)), REST])
        help = f"did you mean `{near}`?" if near else f"`{key}` is {numbers}the name of an earlier field, or `{REST}`"
        yield Fault.at(item, key, text, help)
        return
    if "up_to" not in item and key == "count":
        text = f"{name} has no fixed {key}, and nothing says how large it can become"
        yield Fault.at(item, key, text, "add `up_to:`, the most elements that there are: buffers are made for them")
    if "up_to" not in item:
        return
    if item["up_to"] > MOST_ELEMENTS and key == "count":
        text = f"{name} has up to {item['up_to']:,} elements: an array has at most {MOST_ELEMENTS:,}"
        yield Fault.at(item, "up_to", text, "what is longer is `bytes` with `size: rest`")
    if said == REST:
        return
    counter = counter_of(message, item)
    assert counter is not None
    others = takewhile(lambda one: one is not item, open_parts(message))
    same = next((one for one in others if counting(one).name == said), None)
    if same is not None:
        text = f"`{said}`, which counts {name}, counts `{same['name']}` already"
        yield Fault.at(item, key, text, "each variable-length field has a counter of its own")
    odd = _odd(counter, message)
    if odd:
        text = f"`{counter['name']}`, which counts {name}, {odd}"
        help = "a counter is an unsigned number without a formula, in the bytes in front of what it counts"
        yield Fault.at(item, key, text, help)
        return
    most, elements = (1 << counter["bits"]) - 1 + plus, "bytes" if key == "size" else "elements"
    if most < item["up_to"]:
        added = f" plus {plus}" if plus else ""
        counter_text = f"`{counter['name']}` ({counter['bits']} bits{added})"
        text = f"{counter_text} counts up to {max(most, 0):,}, and {name} has up to {item['up_to']:,} {elements}"
        smaller = f"write `up_to: {most}`" if most > 0 else "correct `up_to`"
        also = "`plus` or " if plus else ""
        yield Fault.at(item, "up_to", text, f"{smaller}, or correct {also}the `bits` of `{counter['name']}`")
    elif plus > item["up_to"]:
        text = f"{name} has at least {plus:,} {elements}, and up to {item['up_to']:,}"
        yield Fault.at(item, "up_to", text, "correct `up_to`, or `plus`")


def _is_unknown(message: Map, item: Map) -> bool:
    """Whether what is said to count is no field."""
    return counting(item).name != REST and counter_of(message, item) is None


def _can_count(one: Map, message: Map) -> bool:
    return not _is_sized(one) and not _odd(one, message)


def _odd(counter: Map, message: Map) -> str:
    """Why a field cannot count, as the end of a sentence; empty if it can."""
    if counter.get("type") != "uint" or not counter.keys().isdisjoint(("formula", "points")):
        return "is scaled" if counter.get("type") == "uint" else f"is `{counter.get('type')}`"
    for key, words in (("count", "is an array"), ("bitfields", "is divided"), ("const", "is constant")):
        if key in counter:
            return words
    if counter.get("view"):
        return "is a view"
    if counter["at"] + counter["bits"] > 8 * message["length"]:
        return "stands behind it"
    return ""


def faults_of_place(message: Map, item: Map, structs: Lengths) -> Iterator[Fault]:
    """What is wrong with where it stands, and with what it is."""
    name, fixed = f"`{item['name']}`", 8 * message["length"]
    if _is_unknown(message, item):
        return  # perhaps it is not meant to be open
    parts = open_parts(message)
    before = next((one for one, other in pairwise(parts) if other is item), None)
    written = [one["name"] for one in parts]
    if item.get("after") in written[written.index(item["name"]) + 1 :]:
        text = f"{name} comes after `{item['after']}`, which is written behind it"
        yield Fault.at(
            item,
            "after",
            text,
            "write variable-length fields in the order of the frame; `after` names the one directly in front",
        )
        return
    if before is None and "after" in item:
        text = f"{name} comes after `{item['after']}`, and no part in front of it is open"
        yield Fault.at(item, "after", text, "remove `after`: what is open begins where `length` ends")
        return
    if before is not None and item.get("after") != before["name"]:
        text = f"{name} is not the first part of `{message['name']}` that has no fixed size"
        help = f"it stands behind `{before['name']}`: write `after: {before['name']}`"
        yield Fault.at(item, "after" if "after" in item else "name", text, help)
        return
    if before is not None and counting(before).name == REST:
        text = f"{name} comes after `{before['name']}`, which goes up to the end of the frame"
        yield Fault.at(item, "after", text, f"name the field that counts `{before['name']}`")
        return
    if item["at"] != fixed:
        text = f"{name} is open and begins at bit {item['at']:,}; the `length` of `{message['name']}` ends at bit {fixed:,}"
        help = "`length` is that of a frame without any of it, which ends where the open part begins"
        yield Fault.at(item, "at", text, help)
        return
    is_octets = item.get("type") in _OCTETS
    if "size" in item and not is_octets:
        text = f"{name} is `{item.get('type')}`: `size` is for bytes and text"
        yield Fault.at(item, "size", text, "of numbers write `bits` of an element, and `count`")
    elif unit(item, structs) % 8:
        text = f"an element of {name} has {unit(item, structs)} bits, and a frame ends with a byte"
        yield Fault.at(item, "bits", text, "describe its bytes as elements, or count them")
    for key in ("view", "bitfields"):
        if item.get(key):
            text = f"{name} is open, so it has no `{key}`"
            yield Fault.at(item, key, text, f"remove `{key}`")
    if "reserved" in message:
        text = f"`{message['name']}` ends with {name}, so there are no reserved bytes behind it"
        yield Fault.at(message, "reserved", text, "remove `reserved`")
    longest = message["length"] + sum(one.get("up_to", 0) * unit(one, structs) // 8 for one in parts)
    if longest > MOST_BYTES and item is parts[-1]:
        text = f"with all of {name}, `{message['name']}` has {longest:,} bytes: at most {MOST_BYTES:,} are held"
        yield Fault.at(item, "up_to", text, "correct `up_to`")


def obstacles(message: Map, item: Map, structs: Lengths) -> Iterator[Fault]:
    """All that is wrong with an open part."""
    yield from faults_of_count(message, item)
    yield from faults_of_place(message, item, structs)
