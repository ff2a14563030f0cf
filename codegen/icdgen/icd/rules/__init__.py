"""The semantic rules. Each is one function of a theme module; its explanation and examples stand in ``<theme>.md``.

The model is built without complaint: what does not fit is None there. The rules go back to the tree and say what is
wrong, and where.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from icdgen.diagnostics import Finding, in_order
from icdgen.icd.errata import Applied
from icdgen.icd.model import Icd
from icdgen.icd.rules import (  # noqa: F401  (importing a theme registers its rules)
    checksums,
    composites,
    conditional,
    derived,
    duplicates,
    envelopes,
    errata,
    formulas,
    identifiers,
    ids,
    layout,
    limits,
    loggable,
    protocol,
    protocol_heeded,
    protocol_limits,
    protocol_meaning,
    protocol_names,
    protocol_sizes,
    references,
    structs,
    tails,
    values,
)
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import REGISTERED, Rule, elsewhere
from icdgen.suggest import close_to

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language

elsewhere("reading", "ICD001", "ICD002", "ICD003", "ICD004", "ICD010")  # before there is a model
elsewhere("errata", "ICD080", "ICD081", "ICD082", "ICD083")  # while overlays are laid over
ALL: dict[str, Rule] = dict(sorted(REGISTERED.items()))
_RUN = sorted(ALL.values(), key=lambda r: r.last)


class UnknownRule(LookupError):
    """No rule has that code; the message says which was probably meant."""


def check(
    icd: Icd,
    applied: Iterable[Applied] = (),
    complete: bool = True,
    languages: Sequence[Language] = (),
    texts: Mapping[str, str] | None = None,
) -> list[Finding]:
    """Everything that breaks a rule and that no erratum accepts, in the order of the files.

    Names must do for the ``languages``. ``complete`` is False where broken items were left out of the model: rules about what is
    absent stay silent then. ``texts`` of the files let findings quote numbers as they are written.
    """
    context = Context(icd, applied, complete, languages, texts)
    findings: list[Finding] = []
    for rule in _RUN:
        if rule.whole and not complete:
            continue
        for fault in rule.check(context) if rule.check else ():
            context.raised.append((rule.code, fault))
            if not context.accepts(rule.code, fault):
                findings.append(fault.finding(rule.code, rule.severity))
    return in_order(findings)


def explain(code: str) -> str:
    """The page of a rule in Markdown: title, reason, a wrong and a right example. Raises `UnknownRule`."""
    rule = ALL.get(code.upper())
    if rule is None:
        close = close_to(code.upper(), ALL)
        raise UnknownRule(f"there is no rule {code}" + (f"; did you mean {close}?" if close else ""))
    from icdgen.icd.rules import pages

    return pages.text(rule.code, rule.severity, rule.page)
