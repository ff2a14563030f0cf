"""Split fields: a field whose parts are listed under ``bitfields``; each part becomes a
field of the message.

The functions take mappings of a file, because `icdgen.icd.build` needs the parts before
there is a model. `faults` yields what rule ICD025 reports; a field with faults is not
split. `first_bit_of_part` converts the position of a part to a bit of the frame, for
the byte order and bit order in effect.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.pieces import bits_of
from icdgen.icd.roles import SPLIT, reasons_against
from icdgen.icd.trees import mappings
from icdgen.wording import count

# Keys for the meaning of a value. The parts of a split field have them instead of the
# field.
VALUE_KEYS = (
    "unit",
    "formula",
    "points",
    "outside",
    "const",
    "special",
    "min",
    "max",
    "above",
    "below",
    "display",
)

_WITHIN = "correct `at` or `bits`: `at` counts from the start of the split field"


def parts_of(field: Map) -> list[Map]:
    """Return the parts of a split field, without entries that are not mappings."""
    return mappings(field.get("bitfields"))


def faults(field: Map, byte_order: str, bit_order: str) -> Iterator[Fault]:
    """Yield the faults of a split field: its own keys, and gaps and overlaps of its
    parts.
    """
    name, bits = f"`{field['name']}`", field["bits"]
    if reasons := reasons_against(field, SPLIT):
        help = "write a field for each element, or " if "count" in field else ""
        message = f"{name} cannot have `bitfields`: it {reasons[0]}"
        yield Fault.at(
            field, "bitfields", message, f"{help}make the parts fields of the message"
        )
        return
    for key in VALUE_KEYS:
        if key in field:
            message = (
                f"{name} is a split field, so it cannot have `{key}`; its parts can"
            )
            yield Fault.at(
                field,
                key,
                message,
                "move it to the parts; an erratum removes what is printed",
            )
    if field.get("view"):
        message = f"{name} is a split field, so it cannot be an overlay field"
        yield Fault.at(
            field, "view", message, "write each part as an overlay field of the message"
        )
    taken: dict[int, str] = {}
    for part in parts_of(field):
        at, size, title = part.get("at"), part.get("bits"), f"`{part.get('name')}`"
        if not (isinstance(at, int) and isinstance(size, int) and at >= 0 and size > 0):
            continue  # the schema check reports it
        if at + size > bits:
            message = f"{title} ends at bit {at + size} of {name}, which has {count(bits, 'bit')}"
            yield Fault.at(part, "bits", message, _WITHIN)
        elif not is_contiguous(field, part, byte_order, bit_order):
            message = f"the bits of {title} are not contiguous in the frame"
            yield Fault.at(part, "at", message, "make the parts fields of the message")
        clash = next((taken[bit] for bit in range(at, at + size) if bit in taken), None)
        if clash:
            yield Fault.at(part, "at", f"{title} overlaps {clash}", _WITHIN)
        taken.update((bit, title) for bit in range(at, at + size))
    unassigned = [bit for bit in range(bits) if bit not in taken]
    if unassigned:
        message = f"bit {unassigned[0]} of {name} belongs to no part"
        yield Fault.at(
            field, "bitfields", message, "describe it as a part, or mark it as reserved"
        )


def first_bit_of_part(field: Map, part: Map, byte_order: str, bit_order: str) -> int:
    """Return the first bit of a part in the frame."""
    return min(_bits_of_part(field, part, byte_order, bit_order))


def is_contiguous(field: Map, part: Map, byte_order: str, bit_order: str) -> bool:
    """Return whether a field at the position of a part has the bits of the part, in the
    same order.

    This fails if a part crosses a byte boundary and the byte order does not continue
    the bit order.
    """
    bits = _bits_of_part(field, part, byte_order, bit_order)
    return bits_of(min(bits), part["bits"], byte_order, bit_order) == bits


def _bits_of_part(field: Map, part: Map, byte_order: str, bit_order: str) -> list[int]:
    """Return the bits of a part in the frame, the least significant first."""
    return bits_of(field["at"], field["bits"], byte_order, bit_order)[
        part["at"] : part["at"] + part["bits"]
    ]


def summary_of_part(field: Map, part: Map) -> str:
    """Return the summary of a part: its position in the split field, and its own
    summary or that of the field.
    """
    first, last = part["at"], part["at"] + part["bits"] - 1
    bits = f"Bit {first}" if first == last else f"Bits {first} to {last}"
    return f"{bits} of {field['name']}. {part.get('summary') or field.get('summary', '')}".rstrip()
