"""What a person says that a frame is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from icdgen.icd.model import Icd, Message, Node
from icdgen.recognize.reading import Reading
from icdgen.values.errors import Ambiguous
from icdgen.values.find import find_message, find_sharing


@dataclass(frozen=True, slots=True)
class Asked:
    """One of the messages, and of the kind; none where nothing is said of it. Several are those that share an id."""

    messages: tuple[Message, ...] = ()
    kind: str | None = None

    @property
    def names(self) -> str:
        """The messages, for people."""
        return " or ".join(f"`{message.name}`" for message in self.messages)

    def is_of(self, one: Reading) -> bool:
        """Whether it is of one of the messages."""
        return any(one.message is message for message in self.messages)

    def can_be(self, data: bytes) -> bool:
        """Whether bytes are as many as one of the messages has."""
        return any(len(data) in message.layout.lengths for message in self.messages)

    def fits(self, one: Reading) -> bool:
        """Whether it is what was said; a configuration message is of every kind that it is sent as."""
        return (not self.messages or self.is_of(one)) and self.kind in (None, one.what, one.message.kind)

    def of(self, found: Sequence[Reading]) -> list[Reading]:
        """Those that are what was said; all if none is."""
        return [one for one in found if self.fits(one)] or list(found)


def asked_for(icd: Icd, node: Node | None, key: str | None, kind: str | None) -> Asked:
    """What a message of the node, as `icdgen.values.find_message` takes it, and a kind say. Raises `NotFound` or `Ambiguous`."""
    if node is None or key is None:
        return Asked(kind=kind)
    try:
        return Asked((find_message(icd, node.name, key, kind),), kind)
    except Ambiguous:
        if sharing := find_sharing(icd, node.name, key, kind):
            return Asked(tuple(sharing), kind)
        raise
