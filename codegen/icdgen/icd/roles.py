"""Roles that a field has for other fields: counter of elements, condition, operand of a
derived value, and others.

A `Role` has the requirements on a field. `reasons_against` returns the requirements
that a field does not meet.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.layout import Array, LayoutNode, Overlay, scalar_of

# Features of a field that a role can exclude, with the end of a sentence for messages.
FEATURES = {
    "optional": "is optional",
    "struct": "is a struct",
    "array": "is an array",
    "variable": "has a variable length",
    "split": "is a split field",
    "scaled": "is scaled",
    "constant": "is constant",
    "overlay": "is an overlay field",
}

# Keys of a line in a file that give the field a feature.
_KEYS = {
    "when": "optional",
    "struct": "struct",
    "count": "array",
    "size": "variable",
    "bitfields": "split",
    "formula": "scaled",
    "points": "scaled",
    "const": "constant",
}


class Role(NamedTuple):
    """Requirements on a field for a role."""

    types: tuple[str, ...]
    excluded: tuple[str, ...] = ()  # features
    least_bits: int = 1
    most_bits: int = 0  # 0: no limit


# Types whose raw value is an integer.
INTEGERS = ("uint", "int", "enum", "bool")

# Counts the elements or bytes of a variable-length field.
COUNTER = Role(
    ("uint",),
    (
        "optional",
        "struct",
        "array",
        "variable",
        "split",
        "scaled",
        "constant",
        "overlay",
    ),
)

# Decides whether an optional field is present.
CONDITION = Role(
    INTEGERS, ("optional", "struct", "array", "variable", "split", "scaled", "overlay")
)

# Operand of a derived value.
OPERAND = Role(("uint", "int", "float"), ("optional", "struct", "array"))

# Exponent after `^` in the formula of a derived value.
EXPONENT = Role(("uint", "int"), ("scaled",), most_bits=16)

# Field with `bitfields`.
SPLIT = Role(("uint",), ("array",), most_bits=64)

# Roles in the protocol section, by the key that names the field. Other
# keys allow any integer.
PROTOCOL: dict[str, Role] = {
    "mask": Role(("bytes", "text")),
    "period": Role(INTEGERS, least_bits=8),
}


class _Traits(NamedTuple):
    """Type, width in bits and features of a field."""

    type: object
    bits: object
    features: frozenset[str]


def reasons_against(field: LayoutNode | Mapping[str, Any], role: Role) -> list[str]:
    """Return why a field cannot have a role, each reason as the end of a sentence such
    as `is an array`.

    The field is a node of a layout, or a line of a file, in which `type` and `bits` can
    be invalid.
    """
    traits = (
        _traits_of_node(field)
        if isinstance(field, LayoutNode)
        else _traits_of_line(field)
    )
    reasons = [
        FEATURES[feature] for feature in role.excluded if feature in traits.features
    ]
    if traits.type not in role.types and "struct" not in traits.features:
        reasons.append(f"is `{traits.type}`, not {_alternatives(role.types)}")
    elif isinstance(traits.bits, int) and traits.bits:
        if traits.bits < role.least_bits:
            reasons.append(
                f"has {_bits(traits.bits)}, but needs {role.least_bits} at least"
            )
        elif role.most_bits and traits.bits > role.most_bits:
            reasons.append(
                f"has {_bits(traits.bits)}, but can have {role.most_bits} at most"
            )
    return reasons


def _traits_of_line(line: Mapping[str, Any]) -> _Traits:
    """Return the traits of a field as a file declares it."""
    features = {feature for key, feature in _KEYS.items() if key in line}
    if line.get("view"):
        features.add("overlay")
    return _Traits(line.get("type"), line.get("bits"), frozenset(features))


def _traits_of_node(node: LayoutNode) -> _Traits:
    """Return the traits of a node; for an array, the type and width of its elements."""
    scalar = scalar_of(node)
    has_feature = {
        "optional": bool(node.present_if),
        "struct": scalar is None,
        "array": isinstance(node, Array),
        "variable": scalar is not None and scalar.length is not None,
        "scaled": scalar is not None and scalar.has_formula,
        "constant": scalar is not None and scalar.const is not None,
        "overlay": isinstance(node, Overlay),
    }
    features = frozenset(feature for feature, has in has_feature.items() if has)
    return _Traits(
        scalar.type if scalar else None, scalar.bits if scalar else None, features
    )


def _alternatives(types: tuple[str, ...]) -> str:
    """Return types in words, with `or` before the last."""
    *most, last = (f"`{name}`" for name in types)
    return f"{', '.join(most)} or {last}" if most else last


def _bits(number: int) -> str:
    return "1 bit" if number == 1 else f"{number:,} bits"
