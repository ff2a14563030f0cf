"""Derived values: their formulas and operands."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd import derived
from icdgen.icd.derived_values import check_operands
from icdgen.icd.fault import Fault
from icdgen.icd.formula import FormulaError
from icdgen.icd.layout import LayoutNode
from icdgen.icd.model import Message
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.layout import is_read
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import mappings
from icdgen.wording import quote

_HELP = "a formula is made of numbers, the names of fields, + - * / and powers: `Lon + Lon HP`, `Voltage*Current/1000`, `W*10^W_SF`"


@rule("ICD180")
def values_can_be_derived(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        if "derived" in message.source and is_read(message):
            yield from _faults(message)


def _faults(message: Message) -> Iterator[Fault]:
    """Yield a fault for each derived value that is not in the layout."""
    # Possible operands: all fields, and the derived values before an item.
    nodes: list[LayoutNode] = [*message.layout.fixed, *message.layout.sequence]
    derived_nodes = {id(node.source): node for node in message.layout.derived}
    # The schema check reports items without a name or a formula.
    items = [
        item
        for item in mappings(message.source["derived"])
        if isinstance(item.get("name"), str) and isinstance(item.get("formula"), str)
    ]
    failed: set[str] = set()  # names of values with a fault
    for index, item in enumerate(items):
        if id(item) in derived_nodes:
            nodes.append(derived_nodes[id(item)])
            continue
        text, later = item["formula"], {other["name"] for other in items[index:]}
        try:
            derivation = derived.parse(
                text, {*(node.name for node in nodes), *later, *failed}
            )
            # One finding for the value that has an error, none for those that use it.
            if failed.isdisjoint(derivation.fields):
                check_operands(derivation, nodes)
        except FormulaError as error:
            message_text = (
                f"{quote(item['name'])} cannot be derived by {quote(text)}: {error}"
            )
            yield Fault.at(item, "formula", message_text, _HELP)
        failed.add(item["name"])
