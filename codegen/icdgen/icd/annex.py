"""What an ICD holds beside its messages: decisions about faults of the manual, the log mask, what is not described."""

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


@dataclass(frozen=True, slots=True)
class Loggable:
    """One bit of the log mask (bit 0: least significant bit of the first byte) and the frame it selects."""

    bit: int
    id: int
    name: str = ""
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Missing:
    """A message that the manual mentions and does not describe."""

    kind: str
    id: int
    name: str
    why: str
