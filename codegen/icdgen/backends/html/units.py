"""Reference page of units and types.

`values` returns the units that fields use, by quantity, and each type with its number
of fields.
"""

from __future__ import annotations

from collections import defaultdict

from icdgen.backends.html import texts
from icdgen.backends.html.relations import Relations
from icdgen.icd.lines import lines

_FEW = 8
_TYPES = {
    "uint": "Unsigned integer of 1 to 64 bits.",
    "int": "Signed integer in two's complement.",
    "bool": "One bit: 1 is true.",
    "enum": "Integer whose values have names, unsigned unless one of them is negative. Values without a name stay numbers.",
    "float": "IEEE 754 number of 32 or 64 bits. Every NaN keeps its bits.",
    "bytes": "Whole bytes, in order.",
    "text": "ASCII characters in whole bytes, filled with NUL.",
}


def values(relations: Relations) -> dict[str, object]:
    """Return the values of the page: used units by quantity, and types with their
    number of fields.
    """
    quantities: dict[str, list[dict[str, object]]] = defaultdict(list)
    for unit, uses in relations.units.values():
        quantities[unit.quantity].append(
            {"unit": unit, "uses": uses[:_FEW], "more": uses[_FEW:]}
        )
    counts: dict[str, int] = defaultdict(int)
    widths: dict[str, set[int]] = defaultdict(set)
    for node in relations.icd.nodes:
        for message in node.messages:
            for field in lines(message.layout):
                counts[field.type] += field.count or 1
                widths[field.type].add(field.bits)
    return {
        "quantities": sorted(quantities.items()),
        "types": [
            (name, text, counts[name], _widths(name, widths[name]))
            for name, text in _TYPES.items()
        ],
        "numberings": _numberings(relations),
    }


def _numberings(relations: Relations) -> list[tuple[str, str, str]]:
    """Return the titles of the nodes for each combination of byte order and bit
    numbering.
    """
    titles_by_orders: dict[tuple[str, str], list[str]] = defaultdict(list)
    for node in relations.icd.nodes:
        titles_by_orders[f"{node.byte_order}-endian", node.bit_order].append(node.title)
    return [
        ("all nodes" if len(titles_by_orders) == 1 else ", ".join(titles), *order)
        for order, titles in titles_by_orders.items()
    ]


def _widths(kind: str, widths: set[int]) -> str:
    # Byte strings occur in many widths, so a range is shown.
    if kind in ("bytes", "text") and len(widths) > 6:
        return texts.span(str(min(widths)), str(max(widths)))
    return ", ".join(map(str, sorted(widths)))
