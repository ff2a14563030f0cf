"""Entries of XTCE containers at their positions. Creates the ICD fields of the first
variable-length entry and of all later entries.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

from icdgen.definitions import containers
from icdgen.definitions.containers import (
    Counter,
    bits_of_counted,
    in_sequence,
    variable_field,
)
from icdgen.definitions.frames import ORDERS
from icdgen.definitions.model import Definitions, Item, NotSupported, replace_keys
from icdgen.definitions.xtce_calibration import number
from icdgen.definitions.xtce_names import ancillary_data
from icdgen.definitions.xtce_types import XtceFieldType
from icdgen.frozen import NamedTuple
from icdgen.icd.roles import COUNTER, reasons_against
from icdgen.icd.variable_length import MOST_BYTES

OPEN = "IMP080"


class Reference(NamedTuple):
    """Parameter or argument. ``path`` leads to a member of an aggregate."""

    of: Element
    path: tuple[str, ...]

    @property
    def name(self) -> str:
        """Name in the notation of XTCE: ``Packet_ID/Version``."""
        return "/".join((self.of.get("name", ""), *self.path))


@dataclass
class XtcePart(containers.ContainerPart):
    """Entry of an XTCE container at its position. A fixed value has no reference."""

    field_type: XtceFieldType = field(kw_only=True)
    reference: Reference | None = None
    is_reserved: bool = False  # has a size but no meaning
    # Earlier parts, and the values with which this one is present.
    conditions: list[tuple[XtcePart, object]] = field(default_factory=list)

    @property
    def width(self) -> int:
        """Bits of the part, or of an element of it."""
        return int(self.item.get("bits", self.bits)) if self.bits else self.element


def names_of_parts(parts: Iterable[XtcePart]) -> dict[int, str]:
    """Return the names of parts by `id`.

    Repeated names get a number: ``Mode``, ``Mode 2``.
    """
    times: dict[str, int] = {}
    names: dict[int, str] = {}
    for part in parts:
        name = part.path[-1]
        times[name] = times.get(name, 0) + 1
        names[id(part)] = name if times[name] == 1 else f"{name} {times[name]}"
    return names


def sequence_fields(
    parts: list[XtcePart],
    front: list[XtcePart],
    names: Mapping[int, str],
    message: Item,
    order: str,
    to: Definitions,
) -> list[Item]:
    """Return the fields of the first part of variable length and of the parts that
    follow it. Parts in ``front`` of it can count elements.

    Raises `NotSupported`.
    """
    at, fields = 8 * message["length"], list[Item]()
    behind = sum(part.bits for part in parts)
    is_open = False  # whether a part extends to the end of the frame
    for part in parts:
        name = names[id(part)]
        if "when" in part.item:
            raise NotSupported(f"`{name}` is behind a part of variable size")
        if part.bits:
            item = {"type": "bytes"} if part.is_reserved else part.item
            item = {"at": at, "bits": part.bits, "name": name, **item}
            field = replace_keys(part.item, item)
        elif is_open:
            raise NotSupported(f"`{name}` follows a part that no parameter counts")
        else:
            _count(part, name, at + behind, front, message["name"], to)
            is_open = part.counter is None
            counted = bits_of_counted(parts) if is_open else 0
            field = variable_field(part, name, at, names, behind + counted)
        is_number = field["type"] not in ("bytes", "text")
        is_ordered = part.width > 8 and (is_number or not part.bits)
        if is_ordered and part.order != message.get("byte_order", order):
            field |= ORDERS[part.order]
        fields.append(field)
    return in_sequence(fields)


def _count(
    part: XtcePart,
    name: str,
    at: int,
    parts: list[XtcePart],
    message: str,
    to: Definitions,
) -> None:
    """Set the counter of a variable-length part, if another part can count it, and its
    maximum number of elements.
    """
    item, field_type = part.item, part.field_type
    most = min(item["up_to"], (8 * MOST_BYTES - at) // part.element)
    if (
        part.reference is not None
        and (limit := ancillary_data(part.reference.of).get("up_to")) is not None
    ):
        most = min(most, max(1, number(limit, "a size")))
    counter = next(
        (other for other in parts if _is_named(other, field_type.size)), None
    )
    counted = _counted(counter, field_type, most) if counter is not None else 0
    if counter is not None and counted:
        part.counter, most = Counter(counter, field_type.plus or 0), counted
    elif counter is not None:
        text = f"message `{message}`: `{name}` is as long as `{field_type.size}` says"
        to.warn(OPEN, text, "it is imported up to the end of the frame")
    item["up_to"] = most


def _is_named(part: XtcePart, reference: str) -> bool:
    """Whether a reference, which may include a path of systems, ends with the name of a
    part.
    """
    return part.reference is not None and f"/{reference}".endswith(
        f"/{part.reference.name}"
    )


def _counted(counter: XtcePart, field_type: XtceFieldType, most: int) -> int:
    """Return the maximum number of elements, or bytes, that a field can count; 0 if it
    cannot count them.
    """
    if (
        field_type.plus is None
        or not counter.bits
        or reasons_against(counter.item, COUNTER)
    ):
        return 0
    counted = min(most, (1 << counter.bits) - 1 + field_type.plus)
    # A counter with the value 0 means `plus` elements, which the maximum must allow.
    return counted if counted >= max(1, field_type.plus) else 0
