"""Identifiers of the Python package."""

from __future__ import annotations

import keyword
from zlib import crc32

from icdgen.icd.model import Enum, Field, Member, Message, Node
from icdgen.naming import camel, snake, upper, words

RESERVED = frozenset(keyword.kwlist)

# What generated classes declare or refer to besides the names of the fields.
IN_MESSAGE = {
    **dict.fromkeys(
        ("as_dict", "decode_many", "decode_table", "from_bytes", "from_physical", "to_bytes"), "the method `{}`"
    ),
    **dict.fromkeys(("bool", "bytes", "classmethod", "float", "int", "property"), "Python's `{}`"),
    **dict.fromkeys(("self", "cls"), "the parameter `{}`"),
}
IN_PACKAGE = dict.fromkeys(("getattr", "globals", "import_module", "sorted"), "the function `{}`")
IN_PACKAGE["wire"] = "the package `wire`"

WIRE = "wire"  # the subpackage that says how messages travel
TYPES = "_types"  # the subpackage of a node that holds its messages and enumerations
_LONGEST = 200  # characters of a module's name, for the sake of file systems


def class_name(one: Message | Enum, node: Node) -> str:
    """``EstimatedAttitudeAngles``"""
    return camel(words(one.identifier or one.name, node.vocabulary))


def module_name(one: Message | Enum, node: Node) -> str:
    """``estimated_attitude_angles``; it never stands in a user's program."""
    name = snake(words(one.identifier or one.name, node.vocabulary))
    if len(name) > _LONGEST:
        return f"{name[:_LONGEST]}_{crc32(name.encode()):08x}"
    return f"{name}_" if name in RESERVED else name


def attribute(field: Field, node: Node) -> str:
    """``estimated_roll_angle``"""
    return snake(words(field.identifier or field.name, node.vocabulary))


def physical(field: Field, attribute: str) -> str:
    """``estimated_roll_angle_deg``, or ``..._physical`` where there is no unit; empty without a scale."""
    if field.scale is None:
        return ""
    return f"{attribute}_{field.unit.identifier if field.unit else 'physical'}"


def member(one: Member, node: Node) -> str:
    """``Y_THOMSON_SPIN``"""
    return upper(words(one.identifier or one.name, node.vocabulary))
