"""Enumerations and their members, as parts of the model.

`icdgen.icd.model` has both names, too: other packages import them from there.
"""

from __future__ import annotations

from dataclasses import field, replace

from icdgen.frozen import dataclass
from icdgen.icd.erratum import Erratum
from icdgen.icd.located import Map, unread


@dataclass(frozen=True, slots=True)
class Member:
    """Named value of an enumeration, or named range of values."""

    value: int  # of a range: the first value
    name: str
    identifier: str | None = None  # words of identifiers, if not those of the name
    summary: str = ""
    to: int | None = None  # last value of a range; None for a single value
    aliases: tuple[str, ...] = ()  # other names that a search matches
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def last(self) -> int:
        """Last value of a range, or the single value."""
        return self.value if self.to is None else self.to

    @property
    def values(self) -> str:
        """Value or range as text: ``3``, ``16 to 31``."""
        return str(self.value) if self.to is None else f"{self.value} to {self.to}"

    @property
    def ends(self) -> tuple[Member, ...]:
        """Members that generated code has constants for: the member, or the first and
        the last value of a range.
        """
        if self.to is None:
            return (self,)
        words = self.identifier or self.name
        ends = ((self.value, "first"), (self.to, "last"))
        return tuple(
            replace(self, value=value, to=None, identifier=f"{words} {end}")
            for value, end in ends
        )


@dataclass(frozen=True, slots=True)
class Enum:
    """Enumeration, with members in the order of the manual."""

    name: str
    members: tuple[Member, ...]
    identifier: str | None = None
    summary: str = ""
    table: int | None = None
    node: str = ""  # name of the node that declares it
    aliases: tuple[str, ...] = ()  # other names that a search matches
    errata: tuple[Erratum, ...] = ()
    source: Map = field(default_factory=unread, compare=False, repr=False)

    @property
    def signed(self) -> bool:
        """Whether a value is negative, so that fields of the enumeration are two's
        complement numbers.
        """
        return any(member.value < 0 for member in self.members)

    def member_of(self, value: int | bytes) -> Member | None:
        """Return the member of a value; None if the enumeration does not name the
        value.
        """
        if isinstance(value, bytes):
            return None
        return next(
            (member for member in self.members if member.value <= value <= member.last),
            None,
        )

    def bits_for(self, value: int) -> int:
        """Return the number of bits that a field of the enumeration needs for a value."""
        if not self.signed:
            return value.bit_length()
        # One bit more for the sign. In two's complement, -1 - x has as many bits as x.
        return (~value if value < 0 else value).bit_length() + 1

    @property
    def widest(self) -> Member | None:
        """Member whose value needs the most bits; None without members."""
        if not self.members:
            return None
        largest = max(self.members, key=lambda member: member.last)
        smallest = min(self.members, key=lambda member: member.value)
        return (
            smallest
            if self.bits_for(smallest.value) > self.bits_for(largest.last)
            else largest
        )

    @property
    def bits(self) -> int:
        """Number of bits that a field of the enumeration needs for all values."""
        ends = [end for member in self.members for end in (member.value, member.last)]
        return max(self.bits_for(min(ends)), self.bits_for(max(ends))) if ends else 1

    @property
    def unnamed(self) -> int | None:
        """Smallest number from 0 on without a member; None if every 64-bit number has
        one.
        """
        # The number is 0 or directly follows a member.
        candidates = sorted(
            end
            for end in (0, *(member.last + 1 for member in self.members))
            if end >= 0
        )
        for value in candidates:
            if self.member_of(value) is None and value < 1 << 64:
                return value
        return None
