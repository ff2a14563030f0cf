"""Protocol facts as fields of the structs of the Rust runtime."""

from __future__ import annotations

import re

from icdgen.backends.rust.facts import member_name, type_name
from icdgen.backends.rust.text import doc
from icdgen.protocol.declared import BYTE, FactKind, ProtocolFact, facts_of
from icdgen.protocol.sections import SECTIONS

_TYPES = {
    FactKind.SIZE: "usize", FactKind.TIME: "u32", FactKind.FLAG: "bool", FactKind.BUSES: "PerBus<bool>", FactKind.SPAN: "Span",
}  # fmt: skip
_FIELD = re.compile(r"(?:    ///.*\n)*    pub (\w+): .*,\n")


def written(text: str) -> str:
    """Return the module with the fields of all facts. Other fields follow them."""
    for part in SECTIONS:
        start = f"pub struct {type_name(part)} {{\n"
        before, separator, following = text.partition(start)
        if separator:
            body, end, after = following.partition("}\n")
            facts = facts_of(part)
            names = {member_name(fact) for fact in facts}
            other_fields = (
                field.group()
                for field in _FIELD.finditer(body)
                if field.group(1) not in names
            )
            text = (
                before
                + start
                + "".join([*map(_field, facts), *other_fields])
                + end
                + after
            )
    return text


def _field(fact: ProtocolFact) -> str:
    # The name of a time contains its unit.
    about = doc([f"{fact.about[0].upper()}{fact.about[1:]}."], "    ", "///")
    return f"{about}\n    pub {member_name(fact)}: {_type(fact)},\n"


def _type(fact: ProtocolFact) -> str:
    name = _TYPES.get(fact.kind) or ("u8" if fact.holds <= BYTE else "u32")
    return f"Option<{name}>" if fact.is_optional else name
