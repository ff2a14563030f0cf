"""Page of an enumeration.

`values` returns what the template ``enum.html.j2`` needs: members with anchors, fields
of this type, errata.
"""

from __future__ import annotations

from icdgen.backends.html.relations import Relations
from icdgen.describe.errata import errata_of_enum
from icdgen.icd.model import Enum


def values(relations: Relations, enum: Enum) -> dict[str, object]:
    """Return the values of the page."""
    return {
        "enum": enum,
        "node": relations.icd.node(enum.node),
        "members": [
            (member, relations.links.anchor(enum, str(member.value)))
            for member in enum.members
        ],
        "users": relations.uses[enum.node, enum.name],
        "errata": errata_of_enum(enum),
    }
