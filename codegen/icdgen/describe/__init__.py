"""Decisions that all outputs share. A backend only spells them.

`describe` returns the `Description` of a set of ICDs, with its nodes, messages, fields,
structs and enumerations.

| decisions | modules |
|---|---|
| the set, its nodes, messages and members | `nodes`, `description`, `scalar`, `enums`, `named` |
| integers that store raw values; physical values | `storage`, `steps`, `integer_scale`, `arithmetic`, `derived`, `bounds` |
| accessors of physical values | `accessors` |
| loops, groups of members, bytes of a frame, lengths | `arrays`, `groups`, `lengths`, `contained` |
| constants, errata, comments, numbers for people | `constants`, `errata`, `comments`, `shared_ids`, `numbers`, `display`, `ids` |
| links, examples | `links`, `examples` |
"""

from __future__ import annotations

from icdgen.describe.description import FieldDescription, StructDescription
from icdgen.describe.enums import EnumDescription
from icdgen.describe.nodes import (
    Description,
    MessageDescription,
    NodeDescription,
    describe,
)

__all__ = [
    "Description",
    "EnumDescription",
    "FieldDescription",
    "MessageDescription",
    "NodeDescription",
    "StructDescription",
    "describe",
]
