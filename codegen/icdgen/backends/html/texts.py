"""Numbers and phrases in the notation of the pages.

Unlike `icdgen.describe.numbers`, pages use typographic signs: a minus sign, an ellipsis
between the ends of a range.
"""

from __future__ import annotations

import json
from fractions import Fraction

from icdgen.describe.bounds import allowed_ends
from icdgen.describe.ids import id_text, pair_bytes
from icdgen.describe.numbers import exact_text, factor_text
from icdgen.frozen import NamedTuple
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.icd.places import NodePlace
from icdgen.protocol.packet_formats import Stream

MINUS = "\N{MINUS SIGN}"
BUSES = {"uart": "UART", "i2c": "I²C", "can": "CAN"}


def number(value: Fraction | int) -> str:
    """Return an exact number with a typographic minus sign."""
    return exact_text(value).replace("-", MINUS)


def factor(value: Fraction) -> str:
    """Return a factor: ``0.01``; ``5/9`` for an infinite decimal."""
    return factor_text(value).replace("-", MINUS)


def span(low: str, high: str) -> str:
    """Return a range: ``0 … 255``."""
    return f"{low} … {high}" if low or high else ""


def raw_range(field: NodePlace) -> str:
    """Return the range of raw values; empty if it is not informative."""
    if field.type in ("uint", "int"):
        return span(number(field.raw_min), number(field.raw_max))
    return ""


def physical_range(field: NodePlace) -> str:
    """Return the range of physical values by type and limits; empty if it equals the
    raw range.
    """
    if field.type in ("uint", "int") and not (
        field.has_formula or field.limits or field.unit
    ):
        return ""
    return span(
        *("" if bound is None else number(bound) for bound in allowed_ends(field))
    )


def type_name(field: NodePlace) -> str:
    """Return the type of a field: ``uint16``, ``float32``, ``bytes``, ``derived``."""
    if field.derived is not None:
        return "derived"
    return (
        f"{field.type}{field.bits}"
        if field.type in ("uint", "int", "float")
        else field.type
    )


class PageId(NamedTuple):
    """One id of a message, with its purpose: ``id``, ``set`` or ``get``."""

    purpose: str
    value: int
    # The notation of the protocol: ``146``, or ``0A 04`` if a header has class and
    # number as two bytes.
    text: str
    hexadecimal: str  # ``92``; empty if the text is hexadecimal


def ids(message: Message, form: Stream | None) -> list[PageId]:
    """Return the ids of a message in the notation of the packets of its node."""
    if message.kind == CONFIGURATION:
        values = [("set", message.set_id or 0), ("get", message.get_id or 0)]
    else:
        values = [("id", message.id or 0)]
    is_hexadecimal = bool(pair_bytes(form))
    return [
        PageId(purpose, id, id_text(form, id), "" if is_hexadecimal else f"{id:02X}")
        for purpose, id in values
    ]


def capitalized(text: str) -> str:
    """Return the text with an initial capital letter; other letters are unchanged."""
    return text[:1].upper() + text[1:]


def clip(text: str, most: int) -> str:
    """Return the text, shortened with an ellipsis if it is too long."""
    return text if len(text) <= most else text[: most - 1].rstrip() + "…"


def script_json(value: object) -> str:
    """Return JSON that is safe within a script element."""
    text = json.dumps(value, separators=(",", ":"))
    # `</script>` in a name would end the script element.
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
