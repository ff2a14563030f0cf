"""Class of the rules, and the decorator that registers them.

A rule is a function that takes the `Context` and yields a `Fault` for each violation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from icdgen.frozen import NamedTuple
from icdgen.icd.fault import Fault

if TYPE_CHECKING:
    from icdgen.icd.rules.context import Context
    from icdgen.icd.rules.pages import RulePage


Check = Callable[["Context"], Iterator[Fault]]


class Rule(NamedTuple):
    """A rule. Its title, reason and examples are in ``<theme>.md``."""

    code: str
    theme: str  # name of its module
    check: Check | None = None  # None if its findings are raised while files are read
    severity: str = "error"  # "error" | "warning"
    # Reports what is absent, so it needs a model from which nothing was left out.
    needs_complete: bool = False
    runs_last: bool = False  # depends on the findings of other rules

    @property
    def page(self) -> RulePage:
        """Title, reason, wrong and right example of the rule."""
        from icdgen.icd.rules import pages

        return pages.pages_of_theme(self.theme)[self.code]

    @property
    def title(self) -> str:
        """Title of the rule."""
        return self.page.title


# Filled while the theme modules are imported, so it is complete once `icdgen.icd.rules`
# is.
REGISTERED: dict[str, Rule] = {}


def rule(
    code: str,
    *,
    severity: str = "error",
    needs_complete: bool = False,
    runs_last: bool = False,
) -> Callable[[Check], Check]:
    """Register the decorated function as the rule ``code``; the name of its module is
    the theme.
    """

    def register(check: Check) -> Check:
        add(
            Rule(
                code,
                check.__module__.rpartition(".")[2],
                check,
                severity,
                needs_complete,
                runs_last,
            )
        )
        return check

    return register


def elsewhere(theme: str, *codes: str) -> None:
    """Register codes whose findings are raised while files are read or overlays are
    applied.
    """
    for code in codes:
        add(Rule(code, theme))


def add(new: Rule) -> None:
    """Register a rule. Raises `ValueError` if its code is already registered."""
    if new.code in REGISTERED:
        raise ValueError(f"two rules are called {new.code}")
    REGISTERED[new.code] = new
