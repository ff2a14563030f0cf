"""What a rule is, and how the modules of this package register theirs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

from icdgen.icd.fault import Fault

if TYPE_CHECKING:
    from icdgen.icd.rules.context import Context
    from icdgen.icd.rules.pages import Page


Check = Callable[["Context"], Iterator[Fault]]


class Rule(NamedTuple):
    """A rule. ``check`` is None where the finding is raised while reading. Its words stand in ``<theme>.md``."""

    code: str
    theme: str
    check: Check | None = None
    severity: str = "error"  # "error" | "warning"
    whole: bool = False  # speaks of what is absent, so it needs a model from which nothing was left out
    last: bool = False  # speaks of what the other rules found

    @property
    def page(self) -> Page:
        """Title, reason, wrong and right example."""
        from icdgen.icd.rules import pages

        return pages.of(self.theme)[self.code]

    @property
    def title(self) -> str:
        """The rule in one line."""
        return self.page.title


REGISTERED: dict[str, Rule] = {}


def rule(code: str, *, severity: str = "error", whole: bool = False, last: bool = False) -> Callable[[Check], Check]:
    """Registers the decorated function under ``code``; its module's name is the theme."""

    def register(check: Check) -> Check:
        add(Rule(code, check.__module__.rpartition(".")[2], check, severity, whole, last))
        return check

    return register


def elsewhere(theme: str, *codes: str) -> None:
    """Registers codes whose findings are raised while reading files or applying overlays."""
    for code in codes:
        add(Rule(code, theme))


def add(new: Rule) -> None:
    """Raises `ValueError` for a code that is taken."""
    if new.code in REGISTERED:
        raise ValueError(f"two rules are called {new.code}")
    REGISTERED[new.code] = new
