"""Suggestions of similar names for misspelt names."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.diagnostics import Remedy
from icdgen.suggest import close_to


def suggestion(name: str, names: Iterable[str], otherwise: str) -> Remedy:
    """Return the help "did you mean ...?" with a similar name as fix, or the help
    ``otherwise`` if no name is similar.
    """
    close = close_to(name, names)
    return (
        Remedy(f"did you mean `{close}`?", yaml_text(close))
        if close
        else Remedy(otherwise)
    )


def yaml_text(text: str) -> str:
    """Return a text as YAML, in quotes if it needs them in flow style (between braces)."""
    # Imported late: only a file with a mistake needs it.
    from icdgen.icd.fmt.scalars import quoted_if_needed

    return quoted_if_needed(text, True)
