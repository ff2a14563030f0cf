"""Numbers and phrases as the pages show them."""

from __future__ import annotations

import json
from fractions import Fraction

from icdgen.describe.bounds import allowed_ends
from icdgen.describe.numbers import exact_text, factor_text
from icdgen.icd.model import CONFIGURATION, Message
from icdgen.icd.places import NodePlace

MINUS = "\N{MINUS SIGN}"
BUSES = {"uart": "UART", "i2c": "I²C", "can": "CAN"}


def number(value: Fraction | int) -> str:
    """An exact number, with a real minus sign."""
    return exact_text(value).replace("-", MINUS)


def factor(value: Fraction) -> str:
    """``0.01``; ``5/9`` where the decimal would not end."""
    return factor_text(value).replace("-", MINUS)


def span(low: str, high: str) -> str:
    """``0 … 255``"""
    return f"{low} … {high}" if low or high else ""


def raw_range(field: NodePlace) -> str:
    """Raw values that the field can hold; empty where that says nothing."""
    if field.type in ("uint", "int"):
        return span(number(field.raw_min), number(field.raw_max))
    return ""


def physical_range(field: NodePlace) -> str:
    """Physical values from the smallest to the largest, as far as type and limits tell; empty where they are the raw ones."""
    if field.type in ("uint", "int") and not (field.has_formula or field.limits or field.unit):
        return ""
    return span(*("" if bound is None else number(bound) for bound in allowed_ends(field)))


def type_name(field: NodePlace) -> str:
    """``uint16``, ``float32``, ``bytes``, ``derived``"""
    if field.derived is not None:
        return "derived"
    return f"{field.type}{field.bits}" if field.type in ("uint", "int", "float") else field.type


def ids(message: Message) -> list[tuple[str, int]]:
    """The ids of a message and what each is for."""
    if message.kind == CONFIGURATION:
        return [("set", message.set_id or 0), ("get", message.get_id or 0)]
    return [("id", message.id or 0)]


def capitalized(text: str) -> str:
    """The text with a capital letter at its beginning, the others as they are."""
    return text[:1].upper() + text[1:]


def clip(text: str, most: int) -> str:
    """The text, or its beginning and an ellipsis."""
    return text if len(text) <= most else text[: most - 1].rstrip() + "…"


def script_json(value: object) -> str:
    """JSON that may stand in a script element, whatever is in it."""
    text = json.dumps(value, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
