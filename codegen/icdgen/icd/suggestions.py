"""Similar names: what a misspelt name probably means, and how it is written in YAML."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.icd.fmt.scalars import quoted_if_needed
from icdgen.icd.remedies import Remedy
from icdgen.suggest import close_to


def suggestion(name: str, known: Iterable[str], otherwise: str) -> Remedy:
    """Ask whether a similar known name is meant; return the help ``otherwise`` if none is similar."""
    close = close_to(name, known)
    return Remedy(f"did you mean `{close}`?", yaml_text(close)) if close else Remedy(otherwise)


def yaml_text(text: str) -> str:
    """Write a text in YAML, in quotes if it needs them between braces."""
    return quoted_if_needed(text, True)
