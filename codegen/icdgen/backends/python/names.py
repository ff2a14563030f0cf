"""Identifiers of the Python package, and all that it declares, for the name rules."""

from __future__ import annotations

import keyword
from collections.abc import Iterator
from typing import Any
from zlib import crc32

from icdgen.backends import Identifier
from icdgen.describe import Description, EnumDescription
from icdgen.describe.description import Composite
from icdgen.naming import DEVICES, camel

RESERVED = frozenset(keyword.kwlist)

# What generated classes declare or refer to besides the names of the fields.
IN_MESSAGE = {
    **dict.fromkeys(
        ("as_dict", "decode_many", "decode_table", "from_bytes", "from_dict", "from_json"), "the method `{}`"
    ),
    **dict.fromkeys(("from_part", "from_physical", "iter_parts", "to_bytes", "to_json"), "the method `{}`"),
    **dict.fromkeys(("bool", "bytes", "float", "int", "str", "tuple"), "Python's `{}`"),
    **dict.fromkeys(("self", "cls"), "the parameter `{}`"),
    **dict.fromkeys(
        """ACKNOWLEDGED BIT_ORDER BYTE_ORDER FIELDS GET_ID ID IDS KIND LENGTH NAME NODE PARTS SET_ID TABLE VIEWS""".split(),
        "the attribute `{}`",
    ),
}
IN_PACKAGE = dict.fromkeys(("getattr", "globals", "import_module", "sorted"), "the function `{}`")
IN_PACKAGE["wire"] = "the package `wire`"

TYPES = "_types"  # the subpackage of a node that holds its messages and enumerations
_LONGEST = 200  # characters of a module's name, for the sake of file systems


def class_name(one: Composite[Any] | EnumDescription) -> str:
    """``EstimatedAttitudeAngles``"""
    return camel(one.words)


def module_name(one: Composite[Any] | EnumDescription) -> str:
    """``estimated_attitude_angles``; it never stands in a user's program."""
    if len(one.name) > _LONGEST:
        return f"{one.name[:_LONGEST]}_{crc32(one.name.encode()):08x}"
    return f"{one.name}_" if one.name in RESERVED else one.name


def home(one: Composite[Any] | EnumDescription, node: str, up: str) -> str:
    """The module, as one that stands ``up`` dots below the package imports it; ``node`` is that one's node."""
    start = "." if one.node.name == node else f"{up}{one.node.name}."
    return f"{start}{TYPES}.{module_name(one)}"


def declared_names(description: Description, package: str) -> Iterator[Identifier]:
    """All names that come from the ICDs, and what they clash with of the names that are always there."""
    for node in description.nodes:
        scope, within = f"package {package}", f"{package}.{node.name}"
        yield node.identifier(scope, node.name)
        if node.name in IN_PACKAGE:
            yield Identifier(scope, node.name, IN_PACKAGE[node.name].format(node.name), None)
        for name in DEVICES:
            yield Identifier(f"files of {within}", name, "a device of Windows", None)
        for owner in map(description.node, (*description.icd.included(node.model), node.model)):
            for one in owner.declared:
                yield one.identifier(f"module {within}", class_name(one))
        for struct in node.structs:
            yield struct.identifier(f"files of {within}", module_name(struct))
            yield from _fields(struct, f"members of {within}.{class_name(struct)}")
        for enum in node.enums:  # messages have files in every language
            yield enum.identifier(f"files of {within}", module_name(enum))
            for member in enum.members:
                yield member.identifier(f"members of {within}.{class_name(enum)}", member.name.upper())
        for message in node.messages:
            yield from _fields(message, f"members of {within}.{class_name(message)}")


def _fields(one: Composite[Any], scope: str) -> Iterator[Identifier]:
    for field in one.declared_members:
        if field.model.is_count:
            continue
        exact, physical = field.integer_scale, [field.physical_name] if field.has_physical else []
        physical += [field.integer_name(exact.per)] if exact is not None else []
        for name in (field.name, *physical, *(constant.name.upper() for constant in field.constants)):
            yield field.identifier(scope, name)
            if name in IN_MESSAGE:
                yield Identifier(scope, name, IN_MESSAGE[name].format(name), None)
