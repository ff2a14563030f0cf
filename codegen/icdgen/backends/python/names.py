"""Names of classes and modules of the Python package, and names that it uses itself.

The symbol table (`symbols`) reports a name of the ICD that would hide one of the
latter.
"""

from __future__ import annotations

import keyword
from collections.abc import Iterator
from typing import Any
from zlib import crc32

from icdgen.describe import EnumDescription, FieldDescription
from icdgen.describe.accessors import Accessor, accessors_of
from icdgen.describe.description import Composite

RESERVED = frozenset(keyword.kwlist)

# What generated classes declare or refer to besides the names of the fields.
IN_MESSAGE = {
    **dict.fromkeys(
        (
            "as_dict",
            "decode_many",
            "decode_table",
            "from_bytes",
            "from_dict",
            "from_json",
        ),
        "the method `{}`",
    ),
    **dict.fromkeys(
        ("from_part", "from_physical", "iter_parts", "to_bytes", "to_json"),
        "the method `{}`",
    ),
    **dict.fromkeys(("bool", "bytes", "float", "int", "str", "tuple"), "Python's `{}`"),
    **dict.fromkeys(("self", "cls"), "the parameter `{}`"),
    **dict.fromkeys(
        """ACKNOWLEDGED BIT_ORDER BYTE_ORDER FIELDS GET_ID ID IDS KIND LENGTH NAME NODE PARTS SET_ID TABLE VIEWS""".split(),
        "the attribute `{}`",
    ),
}
IN_PACKAGE = dict.fromkeys(
    ("getattr", "globals", "import_module", "sorted"), "the function `{}`"
)
IN_PACKAGE["wire"] = "the package `wire`"

PROCEDURES = "procedures"  # the module of a node that holds its procedures
BLOCK = "block"  # the parameter of a procedure with the bytes of a block
IN_PROCEDURES = {
    "LINK": "the attribute `{}`",
    "Optional": "Python's `{}`",
}
IN_PROCEDURE = dict.fromkeys(
    """bus blocks data deadline entries event form frames link next output progress result""".split(),
    "the attribute `{}`",
)
IN_PARAMETERS = {"self": "the parameter `self`", "super": "Python's `super`"}

TYPES = "_types"  # the subpackage of a node that holds its messages and enumerations
_LONGEST = 200  # characters of a module's name, for the sake of file systems


def accessors_in_python(field: FieldDescription) -> Iterator[Accessor]:
    """List the accessors of a physical value.

    Classes have no integers of read-only values.
    """
    if field.model.is_read_only:
        return accessors_of(field, "double")
    return accessors_of(field, "text", "double", "integer", "long integer")


def module_name(part: Composite[Any] | EnumDescription) -> str:
    """Return the name of the module: ``estimated_attitude_angles``.

    It never stands in a user's program.
    """
    name = part.name
    if len(name) > _LONGEST:
        # The checksum keeps names apart that differ only behind the cut.
        return f"{name[:_LONGEST]}_{crc32(name.encode()):08x}"
    return f"{name}_" if name in RESERVED else name


def import_path(part: Composite[Any] | EnumDescription, node: str, up: str) -> str:
    """Return the module of a part as another module imports it.

    The other one is of ``node``, and stands ``up`` dots below the package.
    """
    start = "." if part.node.name == node else f"{up}{part.node.name}."
    return f"{start}{TYPES}.{module_name(part)}"


def constant_name(name: str) -> str:
    """Return the name of an attribute of a class that does not change: ``IDLE``,
    ``TIMEOUT_NO_TIMEOUT``.
    """
    return name.upper()
