"""The ICDs with a prefix before the names of their nodes, for a language that has no packages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from icdgen.icd.enumeration import Enum
from icdgen.icd.layout import Array, Layout, Overlay, Scalar, StructRef
from icdgen.icd.model import Icd, Message, Node, Struct

# Where the parts of the model that name a node, or lead to such parts, stand.
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
    """Return the ICDs with ``prefix`` before the name of each node; the same object if it is empty."""
    if not prefix:
        return icd
    known: dict[int, tuple[Any, Any]] = {}  # the original is kept, so that its id stays its own

    def renamed(part: Any) -> Any:
        if isinstance(part, tuple):
            return tuple(map(renamed, part))
        if type(part) not in _PARTS:
            return part
        if id(part) not in known:
            changes = {key: renamed(getattr(part, key)) for key in _PARTS[type(part)]}
            if isinstance(part, Node):
                changes |= {"name": prefix + part.name, "includes": tuple(prefix + one for one in part.includes)}
            elif isinstance(part, Message | Struct | Enum):
                changes["node"] = prefix + part.node
            elif isinstance(part, Layout):
                changes["owner"] = prefix + part.owner
            known[id(part)] = part, replace(part, **changes)
        return known[id(part)][1]

    return Icd(renamed(icd.nodes))
