"""Rules about the protocol section and the log mask: framing, checksums, addresses,
logs.

`icdgen.diff.facts` compares the protocol sections. The rules here choose the code of
each difference, and rule DIF216 in ``sense`` reports responses.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diff.context import ComparisonContext
from icdgen.diff.facts import AROUND, PART, RESPONSES, facts, shown
from icdgen.diff.pairs import NodePair, differing, place_of
from icdgen.diff.rule import CheckResult, rule
from icdgen.icd.annex import Loggable
from icdgen.wording import quote

LONGEST = 80


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


@rule("DIF120", "node")
@rule("DIF121", "node", severity="warning")
@rule("DIF134", "node")
@rule("DIF413", "node", severity="note")
def fact_differs(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    changed_packet_formats = ctx.changed_packet_formats(pair)
    have_packet_formats = ctx.have_packet_formats(pair)
    for fact in facts(pair.old, pair.new):
        if RESPONSES.fullmatch(fact.path) and not fact.is_word:
            continue  # DIF216
        was, now = shown(fact.old), shown(fact.new)
        keys: tuple[str, ...] = (fact.path.rsplit(".", 1)[-1],)
        is_around = have_packet_formats and AROUND.fullmatch(fact.path)
        # Another notation, such as an explicit default byte order, changes no frame.
        is_spelling = (
            is_around and not changed_packet_formats and "checksums" not in fact.path
        )
        # Texts and notation are a note; other facts change what is transmitted.
        if fact.is_word or is_spelling:
            code, what, keys = "DIF413", "says otherwise", ()
        else:
            was, now = _short(was), _short(now)
            gone = "DIF120" if is_around else "DIF121"
            if PART.fullmatch(fact.path):
                gone = "DIF134"
            if fact.new is None:
                code, what = gone, f"is no longer stated; it was {was}"
            elif fact.old is None:
                code, what = gone, f"is stated now: {now}"
            else:
                code, what = "DIF120", f"is {now}, was {was}"
        where = pair.where()._replace(section=fact.path)
        yield CheckResult(
            f"`{fact.path}` {what}",
            keys,
            was,
            now,
            where=where,
            places=fact.places,
            code=code,
        )


@rule("DIF122", "node")
@rule("DIF123", "node")
@rule("DIF124", "node", severity="note", addition=True)
def mask_bit_differs(pair: NodePair, ctx: ComparisonContext) -> Iterator[CheckResult]:
    for bit, old, new in differing(
        pair.old.loggable, pair.new.loggable, lambda row: row.bit
    ):
        if new is None:
            code, what = "DIF123", f"no longer selects {_frame(old)}"
        elif old is None:
            code, what = "DIF124", f"selects {_frame(new)}"
        elif old.id != new.id:
            code, what = "DIF122", f"selects {_frame(new)}, selected {_frame(old)}"
        else:
            continue  # only the name differs (DIF415)
        where = pair.where()._replace(section=f"loggable {bit}")
        places = (place_of(old, ("id",)), place_of(new, ("id",)))
        was, now = (f"telemetry {row.id}" if row else "" for row in (old, new))
        yield CheckResult(
            f"log mask bit {bit} {what}",
            ("id",),
            was,
            now,
            where=where,
            places=places,
            code=code,
        )


def _frame(row: Loggable | None) -> str:
    if row is None:
        return ""
    return f"telemetry {row.id}" + (f" {quote(row.name)}" if row.name else "")
