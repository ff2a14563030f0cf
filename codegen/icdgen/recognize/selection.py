"""Message and kind that the user has named for a frame: a filter for candidates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from icdgen.icd.model import Icd, Message, Node
from icdgen.recognize.reading import FrameReading
from icdgen.values.errors import Ambiguous
from icdgen.values.find import find_message, find_sharing


@dataclass(frozen=True, slots=True)
class Selection:
    """Messages, one of which the frame must be, and their kind.

    There are several messages if they share an id. Without messages, `fits` accepts each
    message; `is_of` and `can_have_length` accept none. Without a kind, `fits` accepts
    each kind.
    """

    messages: tuple[Message, ...] = ()
    kind: str | None = None

    @property
    def names(self) -> str:
        """Names of the messages, for a report."""
        return " or ".join(f"`{message.name}`" for message in self.messages)

    def is_of(self, reading: FrameReading) -> bool:
        """Return whether a reading has one of the messages."""
        return any(reading.message is message for message in self.messages)

    def can_have_length(self, data: bytes) -> bool:
        """Return whether one of the messages can have the length of ``data``."""
        return any(len(data) in message.layout.lengths for message in self.messages)

    def fits(self, reading: FrameReading) -> bool:
        """Return whether a reading matches messages and kind.

        The kind is that of the reading, or that of its message (of a request, an
        acknowledge, or a configuration message).
        """
        if self.messages and not self.is_of(reading):
            return False
        return self.kind in (None, reading.what, reading.message.kind)

    def matching_or_all(self, candidates: Sequence[FrameReading]) -> list[FrameReading]:
        """Return the matching readings, or all readings if none matches."""
        matches = [reading for reading in candidates if self.fits(reading)]
        # If none matches, the caller can report what the frame is instead.
        return matches or list(candidates)


def selection_of(
    icd: Icd, node: Node | None, key: str | None, kind: str | None
) -> Selection:
    """Return the kind, and the messages of ``node`` that ``key`` names, as for
    `icdgen.values.find_message`. Without a node, the key is ignored.

    Raise `NotFound`. Raise `Ambiguous` if the key fits several messages, except if it is
    an id that they share in one direction.
    """
    if node is None or key is None:
        return Selection(kind=kind)
    try:
        return Selection((find_message(icd, node.name, key, kind),), kind)
    except Ambiguous:
        if sharing := find_sharing(icd, node.name, key, kind):
            return Selection(tuple(sharing), kind)
        raise
