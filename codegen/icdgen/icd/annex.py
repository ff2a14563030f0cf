"""Parts of an ICD other than messages: bits of the log mask, and messages that the
manual does not describe.
"""

from __future__ import annotations

from dataclasses import field

from icdgen.frozen import dataclass
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map, unread


@dataclass(frozen=True, slots=True)
class Loggable:
    """One bit of the log mask (bit 0: least significant bit of the first byte) and the
    frame it selects.
    """

    bit: int
    id: int
    name: str = ""
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Missing:
    """A message that the manual mentions but does not describe."""

    kind: str
    id: int
    name: str
    why: str
