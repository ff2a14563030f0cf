"""Semantic rules for ICDs.

Each rule is a function of a theme module, with explanation and examples in
``<theme>.md``.

`icdgen.icd.build` leaves invalid parts out of the model, or sets them to None, and
reports nothing. The rules look at the tree of the file, which the objects of the model
have as `source`, and report what is wrong, and where.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from icdgen.diagnostics import Finding, in_order
from icdgen.icd.errata import AppliedErrata
from icdgen.icd.model import Icd
from icdgen.icd.rules import (  # noqa: F401
    buses,
    checksums,
    composites,
    conditional,
    derived,
    duplicates,
    errata,
    escapes,
    formulas,
    frame_checksums,
    framed_links,
    identifiers,
    ids,
    layout,
    limits,
    loggable,
    packets,
    procedure_effects,
    procedure_requests,
    procedures,
    protocol,
    protocol_effects,
    protocol_limits,
    protocol_meaning,
    protocol_names,
    protocol_sizes,
    references,
    responses,
    structs,
    values,
    variable_length,
)
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import REGISTERED, Rule, elsewhere
from icdgen.suggest import close_to

if TYPE_CHECKING:
    from icdgen.icd.identifiers import Language

# Reported by `icdgen.icd.source`, `schema` and `load`, before there is a model.
elsewhere("reading", "ICD001", "ICD002", "ICD003", "ICD004", "ICD010")
# Reported by `icdgen.icd.errata`, while an overlay is applied.
elsewhere("errata", "ICD080", "ICD081", "ICD082", "ICD083")
ALL: dict[str, Rule] = dict(sorted(REGISTERED.items()))
# The sort is stable: rules that depend on the findings of others run after all others,
# and the rest in the order of their codes.
_RUN = sorted(ALL.values(), key=lambda rule: rule.runs_last)


class UnknownRule(LookupError):
    """No rule has this code. The message suggests a similar code."""


def check(
    icd: Icd,
    applied: Iterable[AppliedErrata] = (),
    complete: bool = True,
    languages: Sequence[Language] = (),
    texts: Mapping[str, str] | None = None,
) -> list[Finding]:
    """Return the violations of all rules that no erratum accepts, in the order of the
    files.

    The rules about names check the names of the ``languages``. ``complete`` is False if
    broken items were left out of the model; rules that need a complete model are then
    skipped. With the ``texts`` of the files, findings quote numbers in the spelling of
    the file.
    """
    context = Context(icd, applied, complete, languages, texts)
    findings: list[Finding] = []
    for rule in _RUN:
        if rule.needs_complete and not complete:
            continue
        for fault in rule.check(context) if rule.check else ():
            # Accepted faults count as raised, too: ICD084 reports acceptances of faults
            # that are not raised.
            context.raised.append((rule.code, fault))
            if not context.accepts(rule.code, fault):
                findings.append(fault.finding(rule.code, rule.severity))
    return in_order(findings)


def explain(code: str) -> str:
    """Return the page of a rule as Markdown: title, reason, a wrong and a right
    example.

    Raises `UnknownRule`.
    """
    rule = ALL.get(code.upper())
    if rule is None:
        close = close_to(code.upper(), ALL)
        raise UnknownRule(
            f"there is no rule {code}" + (f"; did you mean {close}?" if close else "")
        )
    # Pages are Markdown files, and no other command needs them.
    from icdgen.icd.rules import pages

    return pages.page_as_markdown(rule.code, rule.severity, rule.page)
