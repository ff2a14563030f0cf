"""Errata overlays: the codes in their `accept` keys."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import REGISTERED, rule
from icdgen.icd.rules.wording import line_of
from icdgen.icd.suggestions import suggestion
from icdgen.wording import count


@rule("ICD084", needs_complete=True, runs_last=True)
def accepted_findings_exist(ctx: Context) -> Iterator[Fault]:
    raised = {(code, id(fault.owner)) for code, fault in ctx.raised}
    unmatched: dict[tuple[str, Place], list[Place]] = {}
    for applied in ctx.applied:
        for code, place, owner in applied.accepts:
            # ICD085 reports codes that are not registered.
            if code in REGISTERED and (code, id(owner)) not in raised:
                unmatched.setdefault((code, place), []).append(owner.place)
    # One entry of an erratum can have several targets; one finding for all of them.
    for (code, place), targets in unmatched.items():
        more = (
            f" and {count(len(targets) - 1, 'other place')}" if len(targets) > 1 else ""
        )
        message = f"there is no finding {code} to accept in {line_of(targets[0], place)}{more}"
        yield Fault(
            None, place, message, f"remove {code} here: the finding no longer exists"
        )


@rule("ICD085")
def accepted_rules_exist(ctx: Context) -> Iterator[Fault]:
    for applied in ctx.applied:
        for code, place, _ in applied.accepts:
            if code not in REGISTERED:
                help, fix = suggestion(
                    code, REGISTERED, "`icdgen rule` lists the rules"
                )
                yield Fault.of_place(None, place, f"there is no rule {code}", help, fix)
