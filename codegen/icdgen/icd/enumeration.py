"""Enumerations: the names that values have."""

from __future__ import annotations

from dataclasses import field, replace

from icdgen.frozen import dataclass
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map, unread


@dataclass(frozen=True, slots=True)
class Member:
    """One value of an enumeration, or a range of values that have one name."""

    value: int  # of a range the first
    name: str
    identifier: str | None = None  # words to build identifiers from, if not the name's
    summary: str = ""
    to: int | None = None  # of a range the last value
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def last(self) -> int:
        """Its last value; of one value that."""
        return self.value if self.to is None else self.to

    @property
    def values(self) -> str:
        """How people read it: ``3``, ``16 to 31``."""
        return str(self.value) if self.to is None else f"{self.value} to {self.to}"

    @property
    def ends(self) -> tuple[Member, ...]:
        """What code has constants of: the member, or the first and the last value of a range."""
        if self.to is None:
            return (self,)
        words = self.identifier or self.name
        both = ((self.value, "first"), (self.to, "last"))
        return tuple(replace(self, value=value, to=None, identifier=f"{words} {end}") for value, end in both)


@dataclass(frozen=True, slots=True)
class Enum:
    """An enumeration; members in the order of the manual."""

    name: str
    members: tuple[Member, ...]
    identifier: str | None = None
    summary: str = ""
    table: int | None = None
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names by which people look for it
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def signed(self) -> bool:
        """Whether every field of it is in two's complement: one of its values is negative."""
        return any(member.value < 0 for member in self.members)

    def member_of(self, value: int | bytes) -> Member | None:
        """The member that has the value, if one has."""
        if isinstance(value, bytes):
            return None
        return next((one for one in self.members if one.value <= value <= one.last), None)

    def bits_for(self, value: int) -> int:
        """How many bits a field of it needs to hold the value."""
        return (~value if value < 0 else value).bit_length() + 1 if self.signed else value.bit_length()

    @property
    def widest(self) -> Member | None:
        """The member that takes the most bits: the one of the largest value, or of the smallest."""
        if not self.members:
            return None
        top, bottom = max(self.members, key=lambda one: one.last), min(self.members, key=lambda one: one.value)
        return bottom if self.bits_for(bottom.value) > self.bits_for(top.last) else top

    @property
    def bits(self) -> int:
        """How many bits a field of it needs to hold all its values."""
        ends = [end for one in self.members for end in (one.value, one.last)]
        return max(self.bits_for(min(ends)), self.bits_for(max(ends))) if ends else 1

    @property
    def unnamed(self) -> int | None:
        """The smallest number from 0 on that is no member; None if 64 bits have no such number."""
        after = sorted(end for end in (0, *(one.last + 1 for one in self.members)) if end >= 0)
        return next((value for value in after if self.member_of(value) is None and value < 1 << 64), None)
