"""Rules of the diff and their registration by the modules of ``changes``.

A rule is a function with the decorator `rule`: it receives a pair and the context, and
yields a `CheckResult` for each change. ``changes/<theme>.md`` documents the rules.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from icdgen.diff.layers import LAYERS
from icdgen.diff.pairs import Pair
from icdgen.diff.where import Places, Where
from icdgen.frozen import NamedTuple
from icdgen.icd.rules import pages


class CheckResult(NamedTuple):
    """Result of a check for a pair.

    ``keys``: differing keys of the ICD, the most significant first.
    """

    message: str
    keys: tuple[str, ...] = ()
    was: str = ""
    now: str = ""
    details: tuple[str, ...] = ()
    severity: str | None = None  # None: severity of the rule
    addition: bool | None = None
    where: Where | None = None  # None: location of the pair
    places: Places | None = None  # None: places of the keys
    pair: Pair | None = None  # of a check of the whole ICDs: pair of the result
    code: str = ""  # code of the rule, if a check is registered for several rules


Check = Callable[..., Iterator[CheckResult]]
PAGES = Path(__file__).parent / "changes"


@dataclass(frozen=True, slots=True)
class DiffRule:
    """Rule of the diff: a kind of change.

    The first digit of its code is the layer: 1 wire, 2 meaning, 3 source, 4 text.
    """

    code: str
    layer: str  # one of `LAYERS`
    # Kinds of pairs that it checks: "icd", "node", "message", "field", "enum", "member"
    of: tuple[str, ...]
    theme: str
    check: Check
    severity: str = "error"  # "error" | "warning" | "note"
    addition: bool = False  # new object that existing software does not depend on
    # Pairs that the rule checks: "both" sides exist, the object was "removed" (only in
    # the old ICD) or "added" (only in the new one)
    presence: str = "both"

    @property
    def page(self) -> pages.RulePage:
        """Page of the rule: title, reason, and an example ICD before and after."""
        return pages.pages_of_theme(self.theme, PAGES)[self.code]

    @property
    def title(self) -> str:
        """Title of the rule."""
        return self.page.title


REGISTERED: dict[str, DiffRule] = {}


def rule(
    code: str,
    *of: str,
    severity: str = "error",
    addition: bool = False,
    presence: str = "both",
) -> Callable[[Check], Check]:
    """Register the decorated function as check of a rule. The name of its module is the
    theme.

    A function that reports several kinds of changes is registered for each, and each
    of its results names its code.
    """

    def register(check: Check) -> Check:
        if code in REGISTERED:
            raise ValueError(f"two rules are called {code}")
        theme = check.__module__.rpartition(".")[2]
        REGISTERED[code] = DiffRule(
            code,
            LAYERS[int(code[3]) - 1],
            of,
            theme,
            check,
            severity,
            addition,
            presence,
        )
        return check

    return register


def explain(code: str) -> str:
    """Return the page of a rule in Markdown.

    Raises `KeyError`.
    """
    rule = REGISTERED[code]
    return pages.page_as_markdown(
        rule.code, f"{rule.layer}, {rule.severity}", rule.page, ("Before", "After")
    )
