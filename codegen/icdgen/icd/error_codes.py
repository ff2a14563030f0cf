"""Enumeration of the error codes in acknowledges, as the ICD names it."""

from __future__ import annotations

from icdgen.icd.model import Enum, Icd, Node


def error_enum(icd: Icd, node: Node) -> Enum | None:
    """Return the enumeration of the error codes of a node; None without one."""
    name = icd.protocol_of(node).get("link", {}).get("reasons", {}).get("enum")
    enums = (enum for owner in (node, *icd.included(node)) for enum in owner.enums)
    return next((enum for enum in enums if enum.name == name), None)
