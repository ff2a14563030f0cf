"""What a rule finds."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.diagnostics import Place
from icdgen.icd.located import Map


class Fault(NamedTuple):
    """One breach of a rule. ``owner`` is the mapping that it concerns, by which an erratum's `accept` finds it."""

    owner: Map | None
    place: Place
    message: str
    help: str = ""
