"""Changes grouped by the message, enumeration or node that they concern, in the order
of the report.
"""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.diff.change import Change
from icdgen.diff.layers import LAYERS
from icdgen.diff.pairs import EnumPair, FieldPair, MemberPair, MessagePair, Pair
from icdgen.diff.wording import ids
from icdgen.frozen import NamedTuple


class ChangeGroup(NamedTuple):
    """Changes of one message, enumeration or node."""

    title: str  # "ADCS State"
    about: str  # "telemetry 190"
    node: str
    owner: Pair
    changes: list[Change]

    @property
    def layers(self) -> list[str]:
        """Layers of the changes, most severe first."""
        return sorted({change.layer for change in self.changes}, key=LAYERS.index)


def groups(changes: Iterable[Change]) -> list[ChangeGroup]:
    """Return the groups in the order of their first changes."""
    groups_by_owner: dict[int, ChangeGroup] = {}
    for change in changes:
        pair = change.pair
        # Fields are listed with their message, members with their enumeration.
        owner = pair.owner if isinstance(pair, FieldPair | MemberPair) else pair
        group = groups_by_owner.get(id(owner))
        if group is None:
            about = "enumeration" if isinstance(owner, EnumPair) else "node"
            if isinstance(owner, MessagePair):
                about = f"{owner.any.kind} {ids(owner.any.ids)}"
            group = groups_by_owner[id(owner)] = ChangeGroup(
                owner.any.name, about, owner.where().node, owner, []
            )
        group.changes.append(change)
    return list(groups_by_owner.values())
