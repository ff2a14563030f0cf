"""The page of an enumeration."""

from __future__ import annotations

from icdgen.backends.html.atlas import Atlas
from icdgen.icd.model import Enum


def values(atlas: Atlas, enum: Enum) -> dict[str, object]:
    """Values of the page."""
    errata = dict.fromkeys(erratum for part in (enum, *enum.members) for erratum in part.errata)
    return {
        "enum": enum,
        "node": atlas.icd.node(enum.node),
        "members": [(member, atlas.links.anchor(enum, str(member.value))) for member in enum.members],
        "users": atlas.users(enum),
        "errata": list(errata),
    }
