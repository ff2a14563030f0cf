"""Names that the generated code of a language declares for an ICD, for the rules that
compare them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from icdgen.icd.located import Map
from icdgen.icd.model import Icd


# Not frozen: large ICDs have very many identifiers, and a frozen class or a tuple takes
# twice as long to construct.
@dataclass(slots=True, eq=False, repr=False)
class Identifier:
    """A name that generated code declares. Two equal names in one scope clash."""

    scope: str  # "members of struct demo_foo_t"
    text: str
    owner: str  # the line of the ICD in words: "field `Foo` of `Bar`"
    source: Map | None  # the mapping of that line
    # distinguishes names of the same line: see `icdgen.describe.symbols`
    role: str = ""
    # Object of the model that it names; None for a name of the generated code itself.
    part: object = None


class Language(Protocol):
    """A language of generated code."""

    name: str  # for `--lang`
    title: str  # in messages
    reserved: frozenset[str]  # words that cannot be identifiers

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Yield every name that the generated code declares."""
