"""Fields that the manual divides in words: each of their ``bitfields`` is a field of the frame."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.roles import SPLIT, reasons_against
from icdgen.icd.trees import mappings

OF_A_WHOLE = ("unit", "formula", "points", "outside", "const", "special", "min", "max", "above", "below", "display")
"""Keys for the meaning of a value; the parts of a split field have them instead of the field."""

_WITHIN = "correct `at` or `bits`: `at` counts from the start of the split field"


def parts_of(field: Map) -> list[Map]:
    """The parts that can be read."""
    return mappings(field.get("bitfields"))


def obstacles(field: Map, byte_order: str, bit_order: str) -> Iterator[Fault]:
    """What is wrong with the division; the parts are `parts_of` it."""
    name, bits = f"`{field['name']}`", field["bits"]
    if reasons := reasons_against(field, SPLIT):
        help = "write a field for each element, or " if "count" in field else ""
        message = f"{name} cannot have `bitfields`: it {reasons[0]}"
        yield Fault.at(field, "bitfields", message, f"{help}make the parts fields of the message")
        return
    for key in OF_A_WHOLE:
        if key in field:
            message = f"{name} is divided, so its value has no `{key}`: its parts have"
            yield Fault.at(field, key, message, "move it to the parts; an erratum removes what is printed")
    if field.get("view"):
        message = f"{name} is a split field, so it cannot be an overlay field"
        yield Fault.at(field, "view", message, "write each part as an overlay field of the message")
    taken: dict[int, str] = {}
    for part in parts_of(field):
        at, size, title = part.get("at"), part.get("bits"), f"`{part.get('name')}`"
        if not (isinstance(at, int) and isinstance(size, int) and at >= 0 and size > 0):
            continue  # the schema's business
        if at + size > bits:
            message = f"{title} ends at bit {at + size} of {name}, which has {bits} bit{'s' * (bits != 1)}"
            yield Fault.at(part, "bits", message, _WITHIN)
        elif not lies_together(field, part, byte_order, bit_order):
            message = f"the bits of {title} are not contiguous in the frame"
            yield Fault.at(part, "at", message, "make the parts fields of the message")
        clash = next((taken[bit] for bit in range(at, at + size) if bit in taken), None)
        if clash:
            yield Fault.at(part, "at", f"{title} overlaps {clash}", _WITHIN)
        taken.update((bit, title) for bit in range(at, at + size))
    left = [bit for bit in range(bits) if bit not in taken]
    if left:
        message = f"bit {left[0]} of {name} belongs to no part"
        yield Fault.at(field, "bitfields", message, "describe it as a part, or mark it as reserved")


def place(field: Map, part: Map, byte_order: str, bit_order: str) -> int:
    """The bit of the frame at which the part begins."""
    return min(_wanted(field, part, byte_order, bit_order))


def lies_together(field: Map, part: Map, byte_order: str, bit_order: str) -> bool:
    """Whether a field at that place has the part's bits, in their order."""
    wanted = _wanted(field, part, byte_order, bit_order)
    return bits_of(min(wanted), part["bits"], byte_order, bit_order) == wanted


def _wanted(field: Map, part: Map, byte_order: str, bit_order: str) -> list[int]:
    return bits_of(field["at"], field["bits"], byte_order, bit_order)[part["at"] : part["at"] + part["bits"]]


def bits_of(at: int, count: int, byte_order: str, bit_order: str) -> list[int]:
    """Which bit of the frame each bit of a value is, the least significant first."""
    runs: dict[int, list[int]] = {}
    for bit in range(at, at + count):
        runs.setdefault(bit // 8, []).append(bit)
    ordered = list(runs.values()) if byte_order == "little" else list(runs.values())[::-1]
    return [bit for run in ordered for bit in (run if bit_order == "lsb0" else run[::-1])]


def described(field: Map, part: Map) -> str:
    """The summary of the part: where in the divided field it is, and its own words, or else the field's."""
    first, last = part["at"], part["at"] + part["bits"] - 1
    bits = f"Bit {first}" if first == last else f"Bits {first} to {last}"
    return f"{bits} of {field['name']}. {part.get('summary') or field.get('summary', '')}".rstrip()
