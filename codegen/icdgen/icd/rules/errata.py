"""Errata overlays: what their `accept` keys say."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import REGISTERED, rule
from icdgen.icd.rules.wording import count, line_of
from icdgen.icd.suggestions import suggestion


@rule("ICD084", whole=True, last=True)
def accept_answers(ctx: Context) -> Iterator[Fault]:
    raised = {(code, id(fault.owner)) for code, fault in ctx.raised}
    idle: dict[tuple[str, Place], list[Place]] = {}
    for applied in ctx.applied:
        for code, place, owner in applied.accepts:
            if code in REGISTERED and (code, id(owner)) not in raised:
                idle.setdefault((code, place), []).append(owner.place)
    for (code, place), targets in idle.items():
        more = f" and {count(len(targets) - 1, 'other place')}" if len(targets) > 1 else ""
        message = f"there is no finding {code} to accept in {line_of(targets[0], place)}{more}"
        yield Fault(None, place, message, f"remove {code} here: the finding no longer exists")


@rule("ICD085")
def accept_known(ctx: Context) -> Iterator[Fault]:
    for applied in ctx.applied:
        for code, place, _ in applied.accepts:
            if code not in REGISTERED:
                help, fix = suggestion(code, REGISTERED, "`icdgen rule` lists the rules")
                yield Fault.of_place(None, place, f"there is no rule {code}", help, fix)
