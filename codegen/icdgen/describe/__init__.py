"""What every output says of an ICD, worked out once and in no language: names in words, widths of integers, steps of scales,
values with names, and the paragraphs of comments. A backend only spells it.

`describe` gives the `Description` of a set of ICDs; from there ``node``, ``message`` and ``enum`` lead to the parts.
"""

from __future__ import annotations

from icdgen.describe.description import FieldDescription, StructDescription
from icdgen.describe.enums import EnumDescription
from icdgen.describe.nodes import Description, MessageDescription, NodeDescription, describe

__all__ = [
    "Description",
    "EnumDescription",
    "FieldDescription",
    "MessageDescription",
    "NodeDescription",
    "StructDescription",
    "describe",
]
