"""What each language makes of a line of the ICD: the names that its backend says it declares for what was read there."""

from __future__ import annotations

from typing import NamedTuple

from icdgen import backends
from icdgen.icd.located import Map
from icdgen.icd.model import Icd

LANGUAGES = ("c", "python", "rust")


class Symbol(NamedTuple):
    """A name, and where it is one: "members of demo_estimated_roll_t"."""

    scope: str
    name: str

    def __str__(self) -> str:
        return f"{self.name} ({self.scope})"


class Symbols:
    """Those of our languages and of the plug-ins that are installed. Raises `UserError` for a plug-in that can't be used."""

    def __init__(self, icd: Icd) -> None:
        self.languages = (*LANGUAGES, *backends.plug_ins())
        self._known: dict[str, dict[int, list[Symbol]]] = {}
        for language in self.languages:
            known = self._known[language] = {}
            for one in backends.get(language).identifiers(icd):
                if one.source is not None:
                    known.setdefault(id(one.source), []).append(Symbol(one.scope, one.text))

    def of(self, language: str, source: Map) -> list[Symbol]:
        """Each once, in the order in which the backend tells them."""
        return list(dict.fromkeys(self._known[language].get(id(source), ())))
