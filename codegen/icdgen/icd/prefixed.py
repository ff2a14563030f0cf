"""Copy of ICDs with a prefix before the names of nodes, for languages without packages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from icdgen.icd.enumeration import Enum
from icdgen.icd.layout import Array, Layout, Overlay, Scalar, StructRef
from icdgen.icd.model import Icd, Message, Node, Struct

# Attributes of each class of the model that contain objects with the name of a node.
_PARTS: dict[type, tuple[str, ...]] = {
    Node: ("enums", "structs", "messages"),
    Message: ("layout",),
    Struct: ("layout",),
    Layout: ("fixed", "sequence"),
    Array: ("item",),
    StructRef: ("layout",),
    Overlay: ("scalar",),
    Scalar: ("enum",),
    Enum: (),
}


def with_prefix(icd: Icd, prefix: str) -> Icd:
    """Return ICDs with ``prefix`` before the name of each node; the same object if the
    prefix is empty.
    """
    if not prefix:
        return icd
    # id() of an object -> the object and its copy. The reference to the object prevents
    # the reuse of its id().
    copies: dict[int, tuple[Any, Any]] = {}

    def renamed(part: Any) -> Any:
        if isinstance(part, tuple):
            return tuple(map(renamed, part))
        if type(part) not in _PARTS:
            return part
        if id(part) not in copies:
            changes = {key: renamed(getattr(part, key)) for key in _PARTS[type(part)]}
            if isinstance(part, Node):
                changes |= {
                    "name": prefix + part.name,
                    "includes": tuple(prefix + name for name in part.includes),
                }
            elif isinstance(part, Message | Struct | Enum):
                changes["node"] = prefix + part.node
            elif isinstance(part, Layout):
                changes["owner"] = prefix + part.owner
            copies[id(part)] = part, replace(part, **changes)
        return copies[id(part)][1]

    return Icd(renamed(icd.nodes))
