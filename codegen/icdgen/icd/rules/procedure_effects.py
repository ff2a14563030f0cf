"""Effects of procedures on objects of the device, such as files.

Rule ICD194 looks at the key `effect` of each procedure in the protocol section. It
checks that an effect has one verb of `EFFECTS` and the keys for it, and that the steps
can have it. It also checks that inputs and fields that the effect names exist and are
numbers. `procedures` has the rules of the steps.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Message, Node
from icdgen.icd.procedures import BYTES, EFFECTS, nested_steps
from icdgen.icd.responses import field_of, number_run
from icdgen.icd.roles import INTEGERS
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.procedures import procedures_in
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import VERBATIM
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import mappings, named
from icdgen.wording import quote

NUMBERS = ("size", "time", "checksum")  # of any object
# Key of an effect -> effects that can have it.
_VERBS_OF = {
    "all_if": ("erase",),
    "to": ("copy",),
    "fields": ("list", "describe"),
}


@rule("ICD194", needs_complete=True)
def effects_name_what_exists(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        messages = {message.name: message for message in ctx.messages_of(node)}
        nodes = {owner.name: owner for owner in ctx.scope(node)}
        keys = _keys_of_kinds(ctx.protocol_of(node).get("procedures", {}))
        for procedure in procedures_in(node):
            effect = procedure.get("effect")
            if isinstance(effect, Map):
                yield from _verbs(effect)
                yield from _steps_for(procedure, effect)
                yield from _key(procedure, effect)
                yield from _fields(nodes, procedure, effect, messages, keys)


def _verbs(effect: Map) -> Iterator[Fault]:
    """Yield the faults of an effect that does nothing or several things, or lacks a key,
    or has one of another effect.
    """
    verbs = [verb for verb in EFFECTS if verb in effect]
    first = next(iter(effect))
    if len(verbs) != 1:
        text = f"an effect does one thing, and this one does {len(verbs)}"
        names = ", ".join(f"`{verb}`" for verb in EFFECTS)
        yield Fault.at_key(effect, first, text, f"write one of {names}")
        return
    for key, possible in _VERBS_OF.items():
        if key in effect and verbs[0] not in possible:
            text = f"an effect with `{verbs[0]}` has no `{key}`"
            yield Fault.at_key(effect, key, text, "remove it")
    for key, verb in (("to", "copy"), ("fields", "list"), ("fields", "describe")):
        if verb in effect and key not in effect:
            text = f"an effect with `{verb}` lacks `{key}`"
            yield Fault.at_key(effect, verb, text, f"add `{key}`")


def _steps_for(procedure: Map, effect: Map) -> Iterator[Fault]:
    """Yield the fault of an effect that the steps of its procedure cannot have."""
    steps = mappings(procedure.get("steps"))
    blocks = [row["blocks"] for row in steps if isinstance(row.get("blocks"), Map)]
    sends = [row for row in blocks if "of" in row]
    cases = (
        ("read", len(blocks) > len(sends), "`blocks` without `of`"),
        ("write", bool(sends), "`blocks` with `of`"),
        ("list", any("repeat" in row for row in steps), "`repeat`"),
    )
    for verb, is_there, needed in cases:
        if verb in effect and not is_there:
            text = f"a procedure with the effect `{verb}` has a step {needed}"
            yield Fault.at_key(effect, verb, text, "correct the effect, or the steps")


def _key(procedure: Map, effect: Map) -> Iterator[Fault]:
    """Yield the faults of inputs that identify an object."""
    inputs = procedure.get("inputs", {})
    numbers = {
        name
        for name, row in inputs.items()
        if isinstance(row, Map) and row.get("type") != BYTES
    }
    key = effect.get("key")
    for name, place in key.placed() if isinstance(key, Seq) else ():
        if name not in numbers:
            text = f"there is no input {quote(str(name))} that is a number"
            remedy = suggestion(str(name), sorted(numbers), VERBATIM)
            yield Fault.of_place(effect, place, text, *remedy)
    all_if = effect.get("all_if")
    if isinstance(all_if, Map):
        for name in all_if.keys() - numbers:
            text = f"there is no input {quote(name)} that is a number"
            remedy = suggestion(name, sorted(numbers), VERBATIM)
            yield Fault.of_place(all_if, all_if.key_at(name), text, *remedy)
    to = effect.get("to")
    if isinstance(to, Seq) and isinstance(key, Seq) and len(to) != len(key):
        text = "`to` and `key` are keys of objects of the same kind"
        yield Fault.at(effect, "to", text, "give as many numbers as `key` has")


def _keys_of_kinds(procedures: Mapping[str, Any]) -> dict[str, set[str]]:
    """Return the inputs that identify the objects of each kind."""
    keys: dict[str, set[str]] = {}
    for procedure in procedures.values():
        effect = procedure.get("effect") if isinstance(procedure, Mapping) else None
        for verb in ("read", "write"):
            if isinstance(effect, Mapping) and verb in effect:
                keys.setdefault(effect[verb], set()).update(effect.get("key", ()))
    return keys


def _fields(
    nodes: Mapping[str, Node],
    procedure: Map,
    effect: Map,
    messages: Mapping[str, Message],
    keys: Mapping[str, set[str]],
) -> Iterator[Fault]:
    """Yield the faults of fields that describe an object."""
    fields = effect.get("fields")
    # An object is described by the telemetry that the procedure requests last.
    requested: object = None
    for step in nested_steps(procedure.get("steps")):
        for request in ("get", "poll"):
            requested = step.get(request, requested)
    message = named(messages, requested)
    kind = next((effect[verb] for verb in EFFECTS if verb in effect), None)
    # Also the inputs of procedures that read or write objects of this kind: `list` and
    # `describe` return the values to give to them.
    numbers = {*NUMBERS, *keys.get(str(kind), ()), *effect.get("key", ())}
    if not isinstance(fields, Map):
        return
    if message is None:
        text = "no step requests telemetry that describes an object"
        yield Fault.at_key(effect, "fields", text, "add a step with `get` or `poll`")
        return
    for name, field_name in fields.items():
        if name not in numbers:
            text = f"{quote(name)} is no number of an object"
            remedy = suggestion(name, sorted(numbers), VERBATIM)
            yield Fault.of_place(fields, fields.key_at(name), text, *remedy)
        field = field_of(message, field_name)
        if field is None:
            text = f"{quote(message.name)} has no field {quote(field_name)}"
            existing = [each.name for each in message.fields]
            yield Fault.at(
                fields, name, text, *suggestion(field_name, existing, VERBATIM)
            )
        elif (
            field.scalar.type not in INTEGERS
            or number_run(field, nodes[message.node]) is None
        ):
            text = f"{quote(field_name)} is no whole number in at most 4 bytes"
            yield Fault.at(fields, name, text, "name another field")
