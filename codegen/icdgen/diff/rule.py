"""What a rule of the diff is, and how the modules of ``changes`` register theirs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from icdgen.diff.layers import LAYERS
from icdgen.diff.pairs import Pair
from icdgen.diff.where import Places, Where
from icdgen.icd.rules import pages


class Found(NamedTuple):
    """What a check has to say about a pair. ``keys`` are those of the ICD that differ, the most telling first."""

    message: str
    keys: tuple[str, ...] = ()
    was: str = ""
    now: str = ""
    details: tuple[str, ...] = ()
    severity: str | None = None  # where it differs from the rule's
    addition: bool | None = None
    where: Where | None = None  # where it is not the pair's
    places: Places | None = None  # where they are not those of the keys
    pair: Pair | None = None  # where both ICDs were looked at, and not one pair
    code: str = ""  # of the rule, where a check is registered for several


Check = Callable[..., Iterator[Found]]
PAGES = Path(__file__).parent / "changes"


@dataclass(frozen=True, slots=True)
class Rule:
    """A kind of change. The first digit of its code is the layer: 1 wire, 2 meaning, 3 source, 4 text."""

    code: str
    layer: str  # one of `LAYERS`
    of: tuple[str, ...]  # what it looks at: "icd", "node", "message", "field", "enum", "member"
    theme: str
    check: Check
    severity: str = "error"  # "error" | "warning" | "note"
    addition: bool = False  # something that nobody relied upon came
    when: str = "both"  # or "gone", "come": only in the old ICD, only in the new one

    @property
    def page(self) -> pages.Page:
        """Title, reason, and the same ICD before and after."""
        return pages.of(self.theme, PAGES)[self.code]

    @property
    def title(self) -> str:
        """The rule in one line."""
        return self.page.title


REGISTERED: dict[str, Rule] = {}


def rule(
    code: str, *of: str, severity: str = "error", addition: bool = False, when: str = "both"
) -> Callable[[Check], Check]:
    """Registers the decorated function, which looks at one pair of things; its module's name is the theme.

    A function that tells several kinds of change from one another is registered for each, and names the code in what it finds.
    """

    def register(check: Check) -> Check:
        if code in REGISTERED:
            raise ValueError(f"two rules are called {code}")
        theme = check.__module__.rpartition(".")[2]
        REGISTERED[code] = Rule(code, LAYERS[int(code[3]) - 1], of, theme, check, severity, addition, when)
        return check

    return register


def explain(code: str) -> str:
    """The page of a rule in Markdown. Raises `KeyError`."""
    one = REGISTERED[code]
    return pages.text(one.code, f"{one.layer}, {one.severity}", one.page, ("Before", "After"))
