"""What the rules about names ask of a language: the names that it would declare for an ICD."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from icdgen.icd.located import Map
from icdgen.icd.model import Icd


@dataclass(
    slots=True, eq=False, repr=False
)  # frozen, or a tuple, it would take twice as long to make: there are very many
class Identifier:
    """A name that generated code declares. Two equal names in one scope clash."""

    scope: str  # "members of struct demo_foo_t"
    text: str
    owner: str  # what it was made from, in a user's words: "field `Foo` of `Bar`"
    source: Map | None  # where that stands in the ICD


class Language(Protocol):
    """A language that code is generated for."""

    name: str
    reserved: frozenset[str]  # words that can't be identifiers

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Every name that the generated code declares."""
