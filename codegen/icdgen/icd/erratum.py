"""A decision about a fault of a manual, as objects of the model carry it."""

from __future__ import annotations

from dataclasses import field

from icdgen.frozen import dataclass
from icdgen.icd.located import Map, unread


@dataclass(frozen=True, slots=True)
class Erratum:
    """A decision about a fault of the manual; or a note, which holds and accepts nothing: ``why`` is what it says."""

    id: str
    title: str
    why: str
    evidence: str
    confidence: str  # "certain" | "likely" | "open"; a note may do without: ""
    tables: tuple[int, ...] = ()
    printed: tuple[tuple[str, object], ...] = ()
    held: tuple[tuple[str, object], ...] = ()
    changes: bool = False
    is_note: bool = False
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def label(self) -> str:
        """What it is called in comments and on pages."""
        return "Note" if self.is_note else "Erratum"

    @property
    def sureness(self) -> str:
        """Its confidence in brackets behind a name, if it has one."""
        return f" ({self.confidence})" if self.confidence else ""
