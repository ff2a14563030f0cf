"""Erratum: a decision about a fault of a manual, attached to objects of the model."""

from __future__ import annotations

from dataclasses import field

from icdgen.frozen import dataclass
from icdgen.icd.located import Map, unread


@dataclass(frozen=True, slots=True)
class Erratum:
    """A decision about a fault of the manual, or a note.

    A note changes and accepts nothing; ``why`` is its text.
    """

    id: str
    title: str
    why: str
    evidence: str
    confidence: str  # "certain" | "likely" | "open"; of a note also ""
    tables: tuple[int, ...] = ()
    printed: tuple[tuple[str, object], ...] = ()
    held: tuple[tuple[str, object], ...] = ()
    changes: bool = False
    is_note: bool = False
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def label(self) -> str:
        """Heading in comments and documents: ``Erratum`` or ``Note``."""
        return "Note" if self.is_note else "Erratum"

    @property
    def sureness(self) -> str:
        """Confidence in parentheses with a leading space, to append to a name; empty
        without a confidence.
        """
        return f" ({self.confidence})" if self.confidence else ""
