"""Values that are derived from fields."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd import derived
from icdgen.icd.fault import Fault
from icdgen.icd.formula import FormulaError
from icdgen.icd.located import Map
from icdgen.icd.model import Message
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.layout import is_read
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import quote
from icdgen.icd.trees import mappings

_HELP = "a formula is made of numbers, the names of fields, + - * / and powers: `Lon + Lon HP`, `Voltage*Current/1000`, `W*10^W_SF`"


@rule("ICD180")
def derived_computes(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        if "derived" in message.source and is_read(message):
            yield from _faults(message)


def _faults(message: Message) -> Iterator[Fault]:
    known = [one for one in message.members if one.derived is None and not one.implied]
    made = {id(one.source): one for one in message.views}
    items = [one for one in mappings(message.source["derived"]) if _is_whole(one)]
    failed: set[str] = set()  # the names of what has a finding already
    for place, item in enumerate(items):
        if id(item) in made:
            known.append(made[id(item)])
            continue
        text, later = item["formula"], {one["name"] for one in items[place:]}
        try:
            found = derived.parse(text, {*(one.name for one in known), *later, *failed})
            if failed.isdisjoint(found.fields):
                derived.check(found, known)
        except FormulaError as error:
            what = f"{quote(item['name'])} cannot be derived by {quote(text)}: {error}"
            yield Fault.at(item, "formula", what, _HELP)
        failed.add(item["name"])


def _is_whole(item: Map) -> bool:
    return isinstance(item.get("name"), str) and isinstance(item.get("formula"), str)
