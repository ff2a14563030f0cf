"""Messages and enumeration members that the protocol section names."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Place
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.protocol import sections
from icdgen.icd.rules.rule import Fault, rule
from icdgen.icd.rules.wording import close_to, quote
from icdgen.icd.tree import Map, Seq

MESSAGES = ("message", "packet", "id_of", "stop_request", "set_by")  # keys that name messages
# keys that name an enumeration, and the keys beside them that give its values
MEMBERS = (("enum", "value"), ("failure_enum", "failure"), ("destination_enum", "destinations"))


@rule("ICD093", whole=True)
def named_things_exist(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        messages = {m.name for m in ctx.messages_of(node)}
        enums = {e.name: {m.value for m in e.members} for n in ctx.scope(node) for e in n.enums}
        for section in sections(node):
            for key in MESSAGES:
                for name, place in _values(section, key, str):
                    if name not in messages:
                        close = close_to(name, messages)
                        help = f"did you mean {quote(close)}?" if close else "names are the manual's, to the letter"
                        yield Fault(section, place, f"there is no message {quote(name)}", help)
            for name, key in MEMBERS:
                enum = section.get(name)
                known = enums.get(enum) if isinstance(enum, str) else None
                for value, place in _values(section, key, int) if known is not None else ():
                    if value not in known:
                        message = f"the enumeration {quote(enum)} has no member {value}"
                        yield Fault(section, place, message, f"correct `{key}` or `{name}`")


def _values(section: Map, key: str, kind: type) -> Iterator[tuple[object, Place]]:
    """The value of a key, or each of its values, with its place."""
    value = section.get(key)
    if isinstance(value, Seq):
        yield from ((v, p) for v, p in zip(value, value.items_at, strict=True) if isinstance(v, kind))
    elif isinstance(value, kind):
        yield value, section.at(key)
