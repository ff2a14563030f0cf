"""Procedures: steps, the names and numbers that they use, and their limits.

`steps_in` yields each step with the loops around it, also for the themes
`procedure_effects` and `procedure_requests`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from icdgen.frozen import NamedTuple
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq, unread
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace
from icdgen.icd.procedures import (
    BLOCK,
    BYTES,
    FIXED_NAMES,
    FLAG,
    PACKET_DATA,
    SEND,
    name_of,
)
from icdgen.icd.responses import field_of, number_run
from icdgen.icd.roles import INTEGERS
from icdgen.icd.rules.context import Context, section_of
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import VERBATIM
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import at_path, mappings, named
from icdgen.wording import count, listing, quote

# Numbers that a procedure keeps. The engines of C and Rust allocate no memory;
# that of Rust has an array of this size (`procedure/tables.rs`).
MOST_REGISTERS = 24

# What a step does -> keys that it needs, and keys that it can have.
STEPS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "send": ((), ("with", "once", "ignore")),
    "get": ((), ("as",)),
    "poll": (("until", "every_ms", "for_ms"), ("as", "fail")),
    "blocks": ((), ()),
    "block_length": ((), ()),
    "missing": ((), ()),
    "map": (("messages", "field"), ("bit_order", "received", "beyond_end")),
    "receive": (("number", "data", "silence_ms"), ("requested_on",)),
    "verify": ((), ("else",)),
    "repeat": ((), ()),
    "collect": ((), ()),
    "end_if_zeros": ((), ()),
}
_ANYWHERE = ("if", "unless", "assumptions")

# Lists of steps in a step, by the names that `PlacedStep.inside` has for them.
_BLOCKS, _EACH, _ROUND, _REPEAT = "blocks", "each", "missing", "repeat"


class PlacedStep(NamedTuple):
    """Step of a procedure, with what surrounds it."""

    step: Map
    kind: str  # key of `STEPS`
    inside: tuple[str, ...]  # loops around it, from the outside
    blocks: Map  # `blocks` around it; empty without
    missing: Map  # `missing` around it; empty without


def _map(owner: Mapping[str, Any], key: str) -> Map:
    """Return the mapping of a key; an empty mapping for any other value."""
    value = owner.get(key)
    return value if isinstance(value, Map) else unread()


class ProcedureNames(NamedTuple):
    """Declarations to which the steps of a procedure can refer by name."""

    nodes: Mapping[str, Node]  # the node and those that it includes
    procedure: Map
    messages: Mapping[str, Message]
    checksums: frozenset[str]
    frames: Mapping[str, Message]  # telemetry by the name of `as`, or by its own

    @property
    def inputs(self) -> Map:
        """Return the declarations of the inputs, by name."""
        return _map(self.procedure, "inputs")

    def type_of(self, name: object) -> object:
        """Return the type of an input; None if there is no such input."""
        row = self.inputs.get(name) if isinstance(name, str) else None
        if not isinstance(row, Map):
            return None
        return "enum" if "enum" in row else row.get("type", "uint")

    def field(self, frame: str, name: str) -> NodePlace | None:
        """Return a field of requested telemetry; None if there is no such field."""
        message = self.frames.get(frame)
        return field_of(message, name) if message else None


def steps_in(rows: object, outer: PlacedStep | None = None) -> Iterator[PlacedStep]:
    """Yield the steps of a list, and the steps in them."""
    inside = outer.inside if outer else ()
    blocks, missing = (outer.blocks, outer.missing) if outer else (unread(), unread())
    for step in mappings(rows):
        kind = next((key for key in step if key in STEPS), "")
        placed = PlacedStep(step, kind, inside, blocks, missing)
        yield placed
        content = step.get(kind)
        if kind == "repeat":
            yield from steps_in(content, placed._replace(inside=(*inside, _REPEAT)))
        # The schema check reports a value of another type.
        if not isinstance(content, Map):
            continue
        if kind == "blocks":
            within = placed._replace(inside=(*inside, _BLOCKS), blocks=content)
            yield from steps_in(content.get("steps"), within)
        if kind == "missing":
            # `each` runs for one missing packet, `steps` for one round of all of them.
            for key, loop in (("each", _EACH), ("steps", _ROUND)):
                within = placed._replace(inside=(*inside, loop), missing=content)
                yield from steps_in(content.get(key), within)


def procedures_in(node: Node) -> Iterator[Map]:
    """Yield the sections of the procedures that the file of a node declares."""
    for procedure in (section_of(node, "procedures") or unread()).values():
        if isinstance(procedure, Map):  # otherwise the schema check reports it
            yield procedure


def _procedures(ctx: Context) -> Iterator[ProcedureNames]:
    """Yield the procedures of all nodes, each once."""
    for node in ctx.icd.nodes:
        messages = {message.name: message for message in ctx.messages_of(node)}
        nodes = {owner.name: owner for owner in ctx.scope(node)}
        protocol = ctx.protocol_of(node)
        # Without places: it is a copy if several nodes have checksums.
        declared = at_path(protocol, ("link", "checksums"))
        checksums = frozenset(declared if isinstance(declared, Mapping) else ())
        for procedure in procedures_in(node):
            frames = {
                str(step.get("as", step.get(kind))): messages[step[kind]]
                for step, kind, *_ in steps_in(procedure.get("steps"))
                if kind in ("get", "poll") and named(messages, step[kind]) is not None
            }
            yield ProcedureNames(nodes, procedure, messages, checksums, frames)


@rule("ICD190")
def steps_have_their_keys(ctx: Context) -> Iterator[Fault]:
    for names in _procedures(ctx):
        for placed in steps_in(names.procedure.get("steps")):
            yield from _keys(placed.step, placed.kind)
            yield from _where(placed)
            if placed.kind == "verify" and isinstance(placed.step["verify"], Map):
                yield from _comparison(placed.step["verify"])


def _keys(step: Map, kind: str) -> Iterator[Fault]:
    """Yield the faults of a step that does nothing or several things, lacks a key, or
    has one of another step.
    """
    if not kind:
        first = next(iter(step), None)
        if first is None:
            return  # the schema check reports it
        text = "a step says what it does, and this one does not"
        kinds = listing(f"`{kind}`" for kind in STEPS)
        yield Fault.at_key(step, first, text, f"write one of {kinds}")
        return
    needed, possible = STEPS[kind]
    for key in needed:
        if key not in step:
            text = f"a step with `{kind}` lacks `{key}`"
            yield Fault.at_key(step, kind, text, f"add `{key}`")
    for key in step:
        if key in STEPS and key != kind:
            text = f"the step has `{kind}` and `{key}`, and a step does one thing"
            yield Fault.at_key(step, key, text, "write two steps")
        elif key != kind and key not in (*needed, *possible, *_ANYWHERE):
            text = f"a step with `{kind}` has no `{key}`"
            yield Fault.at_key(step, key, text, "remove it, or correct the step")
    if "if" in step and "unless" in step:
        text = "a step has `if` or `unless`, not both"
        yield Fault.at_key(step, "unless", text, "remove one of them")


def _where(placed: PlacedStep) -> Iterator[Fault]:
    """Yield the faults of a step that is not where it has a meaning."""
    step, kind, inside = placed.step, placed.kind, placed.inside
    wanted = {
        "blocks": ((), "stands in no other step"),
        "repeat": ((), "stands in no other step"),
        "missing": ((_BLOCKS,), "stands in the steps of `blocks`"),
        "block_length": ((_BLOCKS,), "stands in the steps of `blocks`"),
        "map": ((_BLOCKS, _ROUND), "stands in the steps of `missing`"),
        "receive": ((_BLOCKS, _ROUND), "stands in the steps of `missing`"),
        "collect": ((_REPEAT,), "stands in the steps of `repeat`"),
        "end_if_zeros": ((_REPEAT,), "stands in the steps of `repeat`"),
    }.get(kind)
    if wanted and inside != wanted[0]:
        yield Fault.at_key(step, kind, f"`{kind}` {wanted[1]}", "move it there")
    if step.get("else") == "again" and _BLOCKS not in inside:
        text = "`again` transfers a block again, and this step is not in `blocks`"
        yield Fault.at(step, "else", text, "remove `else`: then the procedure fails")


def _comparison(verify: Map) -> Iterator[Fault]:
    """Yield a fault unless a `verify` compares a checksum of something, or a field."""
    is_checksum = {"checksum", "of"} <= verify.keys() and "field" not in verify
    is_field = (
        "field" in verify and not {"checksum", "of", "covers_fill"} & verify.keys()
    )
    if verify and not is_checksum and not is_field:
        text = "`verify` compares a checksum (`checksum`, `of`), or a field (`field`)"
        yield Fault.at_key(verify, next(iter(verify)), text, "write one of the two")


@rule("ICD191", needs_complete=True)
def what_steps_name_exists(ctx: Context) -> Iterator[Fault]:
    for names in _procedures(ctx):
        steps = [*steps_in(names.procedure.get("steps"))]
        for placed in steps:
            yield from _messages(names, placed)
            yield from _fields(names, placed)
            yield from _values(names, placed)
        outputs = _map(names.procedure, "outputs")
        for name in outputs:
            yield from _reference(names, outputs, name, False)
        yield from _inputs(names, steps)


_DIRECTIONS = {
    "send": ("telecommand_id", "a telecommand"),
    "get": ("telemetry_id", "telemetry"),
    "poll": ("telemetry_id", "telemetry"),
    "receive": ("telemetry_id", "telemetry"),
}


def _messages(names: ProcedureNames, placed: PlacedStep) -> Iterator[Fault]:
    """Yield the faults of the messages that a step names."""
    step, kind = placed.step, placed.kind
    if kind in _DIRECTIONS and isinstance(step[kind], str):
        message = names.messages.get(step[kind])
        attribute, what = _DIRECTIONS[kind]
        if message is None:
            yield _unknown(step, kind, "message", names.messages)
        elif getattr(message, attribute) is None:
            text = f"{quote(message.name)} is not {what}"
            yield Fault.at(step, kind, text, f"name {what}")
    listed = step.get("messages") if kind == "map" else None
    for name, place in listed.placed() if isinstance(listed, Seq) else ():
        message = named(names.messages, name)
        if message is None:
            remedy = suggestion(str(name), names.messages, VERBATIM)
            text = f"there is no message {quote(str(name))}"
            yield Fault.of_place(step, place, text, *remedy)
        elif (
            message.telecommand_id if step["map"] == SEND else message.telemetry_id
        ) is None:
            what = "sent" if step["map"] == SEND else "requested"
            text = f"{quote(message.name)} cannot be {what}"
            yield Fault(step, place, text, "name messages that can")


def _unknown(owner: Map, key: str, what: str, existing: Iterable[str]) -> Fault:
    """Return the fault of a name that nothing has."""
    remedy = suggestion(owner[key], existing, VERBATIM)
    return Fault.at(owner, key, f"there is no {what} {quote(owner[key])}", *remedy)


def _own_message(names: ProcedureNames, placed: PlacedStep) -> Message | None:
    """Return the message whose fields the keys of a step name."""
    name = placed.step.get(placed.kind)
    if placed.kind == "map":
        listed = placed.step.get("messages")
        name = listed[0] if isinstance(listed, Seq) and listed else None
    return named(names.messages, name)


def _fields(names: ProcedureNames, placed: PlacedStep) -> Iterator[Fault]:
    """Yield the faults of fields that a step names: they do not exist, or are no number
    that it can use.
    """
    message = _own_message(names, placed)
    if message is None:
        return
    step = placed.step
    keyed = [(step, key) for key in ("number", "data", "field") if key in step]
    in_mappings: list[tuple[Map, str]] = []
    for key in ("with", "until", "fail"):
        in_mappings += [(_map(step, key), name) for name in _map(step, key)]
    for owner, key in (*keyed, *in_mappings):
        name = owner[key] if owner is step else key
        if not isinstance(name, str):
            continue
        field = field_of(message, name)
        if field is None:
            existing = [each.name for each in message.fields]
            text = f"{quote(message.name)} has no field {quote(name)}"
            remedy = suggestion(name, existing, VERBATIM)
            place = owner.at(key) if owner is step else owner.key_at(key)
            yield Fault.of_place(owner, place, text, *remedy)
            continue
        is_bytes = key in ("data", "field") or owner.get(key) == PACKET_DATA
        reason = _reason_against(names, message, field, is_bytes)
        if reason:
            place = owner.at(key) if owner is step else owner.key_at(key)
            text = f"{quote(name)} {reason}"
            yield Fault(owner, place, text, "name another field")
        elif owner is not step and isinstance(owner[key], int):
            if int(owner[key]) >= 1 << field.bits:
                text = f"{quote(name)} has {count(field.bits, 'bit')}: 0 to {(1 << field.bits) - 1}"
                yield Fault.at(owner, key, text, "correct the value")


def _reason_against(
    names: ProcedureNames, message: Message, field: NodePlace, is_bytes: bool
) -> str:
    """Return why a step cannot use a field; "" if it can."""
    if field.is_read_only:
        return "has no bits of its own"
    if field.conditions:
        return "is not in each frame"
    # Bytes of variable length begin at a fixed place if they are the first such part.
    parts, end = message.layout.parts, field.at if is_bytes else field.at + field.bits
    if parts and end > 8 * parts[0].begin:
        return "is not at the same place in each frame"
    if is_bytes:
        is_whole = field.at % 8 == 0 and field.bits % 8 == 0
        return (
            "" if field.scalar.type == BYTES and is_whole else "is not a field of bytes"
        )
    if field.scalar.type not in INTEGERS:
        return "is not a whole number"
    is_run = number_run(field, names.nodes[message.node])
    return "" if is_run else "is not one run of bits in 4 bytes"


def _values(names: ProcedureNames, placed: PlacedStep) -> Iterator[Fault]:
    """Yield the faults of the values that a step uses."""
    step = placed.step
    for key in ("with", "until", "fail"):
        owner = _map(step, key)
        for name in owner:
            yield from _value(names, placed, owner, name)
    if placed.kind == "block_length":
        yield from _reference(names, step, "block_length", False)
    for key in ("if", "unless"):
        if isinstance(step.get(key), str):
            yield from _flag(names, placed, key)
    if placed.kind in ("collect", "end_if_zeros"):
        name = step[placed.kind]
        if isinstance(name, str) and name not in names.frames:
            yield _unknown(step, placed.kind, "telemetry", names.frames)
    verify = step.get("verify")
    if not isinstance(verify, Map):
        return
    yield from _value(names, placed, verify, "equals")
    if "field" in verify:
        yield from _reference(names, verify, "field", False)
    checksum = verify.get("checksum")
    if isinstance(checksum, str) and checksum not in names.checksums:
        yield _unknown(verify, "checksum", "checksum", names.checksums)
    covered = verify.get("of")
    if covered == BLOCK and _BLOCKS not in placed.inside:
        text = "there is no block outside of `blocks`"
        yield Fault.at(verify, "of", text, "name an input, or move the step")
    elif covered not in (None, BLOCK) and names.type_of(covered) != BYTES:
        text = f"no input {quote(str(covered))} has bytes"
        yield Fault.at(verify, "of", text, f"write `{BLOCK}`, or an input of bytes")


def _value(
    names: ProcedureNames, placed: PlacedStep, owner: Map, key: str
) -> Iterator[Fault]:
    """Yield the faults of a value: a number, or the name of one."""
    value = owner[key]
    if not isinstance(value, str):
        return
    if value == PACKET_DATA:
        yield from _packet_data(names, placed, owner, key)
        return
    # Numbers of the block and of the packet, which the engine counts.
    own_names = [".".join(name) for name in FIXED_NAMES]
    if value in own_names:
        loop = _BLOCKS if value.startswith(BLOCK) else _EACH
        if loop not in placed.inside:
            text = f"`{value}` has a value in the steps of `{loop}` only"
            yield Fault.at(owner, key, text, "name another value")
        return
    yield from _reference(names, owner, key, True)


def _packet_data(
    names: ProcedureNames, placed: PlacedStep, owner: Map, key: str
) -> Iterator[Fault]:
    """Yield the faults of a field that gets the bytes of a packet."""
    if _EACH not in placed.inside:
        text = f"`{PACKET_DATA}` has a value in the steps of `each` only"
        yield Fault.at(owner, key, text, "move the step")
        return
    message = _own_message(names, placed)
    field = field_of(message, key) if message else None
    size = placed.missing.get("packet")
    if field and isinstance(size, int) and field.bits != 8 * size:
        capacity = count(field.bits // 8, "byte")
        text = f"{quote(key)} holds {capacity}, and a packet has {size}"
        yield Fault.at(owner, key, text, "correct `packet`, or name another field")


def _reference(
    names: ProcedureNames, owner: Map, key: str, may_be_input: bool
) -> Iterator[Fault]:
    """Yield the fault of a name that is neither a field of requested telemetry nor, if
    this is possible, an input that is a number.
    """
    value = owner[key]
    if not isinstance(value, str):
        return
    frame, field_name = name_of(value)
    if may_be_input and not frame:
        if names.type_of(field_name) in (None, BYTES):
            yield _unknown(owner, key, "number", names.inputs)
        return
    field = names.field(frame, field_name)
    if field is None:
        existing = [
            f"{name}.{each.name}"
            for name, message in names.frames.items()
            for each in message.fields
        ]
        yield _unknown(owner, key, "field", existing)
    elif reason := _reason_against(names, names.frames[frame], field, False):
        yield Fault.at(owner, key, f"{quote(value)} {reason}", "name another field")


def _flag(names: ProcedureNames, placed: PlacedStep, key: str) -> Iterator[Fault]:
    """Yield the faults of a condition, which is a flag."""
    value = placed.step[key]
    if value == "block.is_empty" and _BLOCKS in placed.inside:
        return
    frame, name = name_of(value)
    field = names.field(frame, name) if frame else None
    is_flag = field is not None and field.scalar.type == FLAG
    if not is_flag and names.type_of(value) != FLAG:
        text = f"{quote(value)} is no flag"
        help = "name an input `type: bool`, a field `type: bool`, or `block.is_empty`"
        yield Fault.at(placed.step, key, text, help)


def _texts_in_step(step: Map) -> Iterator[str]:
    """Yield the texts among the values of a step, and of mappings in it such as `with`,
    `verify` and `blocks`.
    """
    for owner in (step, *step.values()):
        for value in owner.values() if isinstance(owner, Map) else ():
            if isinstance(value, str):
                yield value


def _inputs(names: ProcedureNames, steps: list[PlacedStep]) -> Iterator[Fault]:
    """Yield the faults of inputs that no step uses, or that lack their size."""
    used: set[str] = set()
    for placed in steps:
        used.update(_texts_in_step(placed.step))
    enums = {enum.name: enum for node in names.nodes.values() for enum in node.enums}
    for name, row in names.inputs.items():
        if not isinstance(row, Map):
            continue
        if name not in used:
            text = f"no step uses the input {quote(name)}"
            yield Fault.at_key(names.inputs, name, text, "remove it, or use it")
        if "enum" in row and "type" in row:
            text = "an input has a `type` or an enumeration, not both"
            yield Fault.at_key(row, "type", text, "remove `type`")
        if "enum" not in row and "type" not in row:
            text = f"the input {quote(name)} has no type"
            yield Fault.at_key(names.inputs, name, text, "add `type` or `enum`")
        enum = named(enums, row.get("enum"))
        if enum is not None and enum.signed:
            text = f"{quote(enum.name)} has negative values, and inputs have none"
            yield Fault.at(row, "enum", text, "name an enumeration without them")


@rule("ICD192")
def procedures_have_limits(ctx: Context) -> Iterator[Fault]:
    for names in _procedures(ctx):
        steps = [*steps_in(names.procedure.get("steps"))]
        limits = names.procedure.get("limits")
        if isinstance(limits, Map):
            yield from _limits(limits, steps)
        transfers = [placed.step for placed in steps if placed.kind == "blocks"]
        for step in transfers[1:]:
            text = "a procedure transfers bytes once, and this is the second `blocks`"
            yield Fault.at_key(step, "blocks", text, "write two procedures")
        for placed in steps:
            content = placed.step.get(placed.kind)
            if placed.kind == "blocks" and isinstance(content, Map):
                yield from _transfer(names, content)
            elif placed.kind == "missing" and isinstance(content, Map):
                yield from _rounds(placed.step, content)
            elif placed.kind == "repeat":
                yield from _repetition(placed.step)
        yield from _optional_inputs(names, transfers)


def _limits(limits: Map, steps: list[PlacedStep]) -> Iterator[Fault]:
    """Yield the faults of limits that are absent, or limit nothing."""
    receives = any(
        placed.kind == "blocks" and "of" not in _map(placed.step, "blocks")
        for placed in steps
    )
    collects = any(placed.kind == "collect" for placed in steps)
    # Both bound the memory of a client, whatever the device sends.
    for key, is_needed, what in (
        ("bytes", receives, "receives bytes"),
        ("entries", collects, "collects entries"),
    ):
        if is_needed and limits and key not in limits:
            text = f"the procedure {what}, and a device could send them for ever"
            yield Fault.at_key(limits, next(iter(limits)), text, f"add `{key}`")
        elif key in limits and not is_needed:
            text = f"`{key}` limits nothing: no step {what}"
            yield Fault.at_key(limits, key, text, "remove it")


def _transfer(names: ProcedureNames, blocks: Map) -> Iterator[Fault]:
    """Yield the faults of what `blocks` transfers."""
    if "of" in blocks:
        if names.type_of(blocks["of"]) != BYTES:
            text = f"no input {quote(str(blocks['of']))} has bytes"
            yield Fault.at(blocks, "of", text, "name an input `type: bytes`")
        elif "most" not in names.inputs[blocks["of"]]:
            text = "nothing says how many bytes the input can have"
            yield Fault.at_key(names.inputs[blocks["of"]], "type", text, "add `most`")
        if "total" in blocks:
            text = "the number of bytes to send is that of the input"
            yield Fault.at_key(blocks, "total", text, "remove it")
    elif "total" in blocks and names.type_of(blocks["total"]) != "uint":
        text = f"no input {quote(str(blocks['total']))} is a number"
        yield Fault.at(blocks, "total", text, "name an input `type: uint`")


def _rounds(step: Map, missing: Map) -> Iterator[Fault]:
    """Yield a fault if no step transfers packets, or if `map` is absent or wrong."""
    kinds = {placed.kind for placed in steps_in(missing.get("steps"))}
    if "each" not in missing and "receive" not in kinds:
        text = "nothing in `missing` transfers packets"
        help = "add `each`, to send them, or a step with `receive`"
        yield Fault.at_key(step, "missing", text, help)
    maps = {
        placed.step["map"]: placed.step
        for placed in steps_in(missing.get("steps"))
        if placed.kind == "map"
    }
    # Without `steps` each packet is sent once, and nothing is repeated.
    if "each" in missing and "steps" in missing and "get" not in maps:
        text = "no step tells which packets are still missing after a round"
        yield Fault.at_key(missing, "steps", text, "add a step with `map: get`")
    if "each" in missing and SEND in maps:
        text = "the packets are sent, and the device knows which have arrived"
        yield Fault.at(maps[SEND], "map", text, "write `get`")
    if "each" not in missing and "get" in maps:
        text = (
            "the packets are received, and the device does not know which have arrived"
        )
        yield Fault.at(maps["get"], "map", text, "write `send`")


def _repetition(step: Map) -> Iterator[Fault]:
    """Yield a fault if nothing ends a repetition."""
    kinds = {placed.kind for placed in steps_in(step["repeat"])}
    if "end_if_zeros" not in kinds:
        text = "no step ends the repetition"
        yield Fault.at_key(step, "repeat", text, "add a step with `end_if_zeros`")
    elif not {"get", "poll"} & kinds:
        text = "the repetition asks the device nothing"
        yield Fault.at_key(step, "repeat", text, "add a step with `get` or `poll`")


def _optional_inputs(names: ProcedureNames, transfers: list[Map]) -> Iterator[Fault]:
    """Yield the faults of optional inputs: only the number of bytes to receive can be
    left out.
    """
    totals = [
        step["blocks"].get("total")
        for step in transfers
        if isinstance(step["blocks"], Map)
    ]
    for name, row in names.inputs.items():
        if isinstance(row, Map) and row.get("optional") and name not in totals:
            text = f"{quote(name)} has no value if it is left out"
            help = "remove `optional`; only the `total` of `blocks` can be unknown"
            yield Fault.at_key(row, "optional", text, help)


@rule("ICD193", needs_complete=True)
def sizes_of_procedures_fit(ctx: Context) -> Iterator[Fault]:
    for names in _procedures(ctx):
        steps = [*steps_in(names.procedure.get("steps"))]
        for placed in steps:
            if placed.kind in ("map", "receive", "send"):
                yield from _sizes(names, placed)
        stored: set[str] = set()  # fields of requested telemetry
        tested = 0  # numbers of `until` and `fail`
        for placed in steps:
            texts = _texts_in_step(placed.step)
            stored.update(text for text in texts if name_of(text)[0] in names.frames)
            tested += len(_map(placed.step, "until")) + len(_map(placed.step, "fail"))
        numbers = len(FIXED_NAMES) + len(names.inputs) + len(stored) + tested
        if numbers > MOST_REGISTERS:
            text = f"the procedure keeps {numbers} numbers, at most {MOST_REGISTERS} are possible"
            yield Fault.at_key(names.procedure, "steps", text, "write two procedures")


def _sizes(names: ProcedureNames, placed: PlacedStep) -> Iterator[Fault]:
    """Yield the faults of fields that are too small for a block and its packets."""
    step, kind = placed.step, placed.kind
    size, packet = placed.blocks.get("size"), placed.missing.get("packet")
    message = _own_message(names, placed)
    if message is None or not isinstance(size, int):
        return
    if kind == "send":
        yield from _numbers_of_block(names, message, placed, size)
    if not isinstance(packet, int):
        return
    # Rounded up: the last packet of a block need not be full.
    packets = -(-size // packet)
    if kind == "map" and isinstance(step.get("messages"), Seq):
        field = field_of(message, step.get("field"))
        bits = len(step["messages"]) * (field.bits if field else 0)
        if field and bits < packets:
            text = f"the map has {count(bits, 'bit')}, and a block {packets} packets"
            yield Fault.at_key(
                step, "messages", text, "add messages, or correct `size`"
            )
    elif kind == "receive":
        field = field_of(message, step.get("number"))
        last = int(placed.missing.get("first", 0)) + packets - 1
        if field and last >= 1 << field.bits:
            highest = (1 << field.bits) - 1
            text = f"{quote(field.name)} holds 0 to {highest}, and the last packet of a block is {last}"
            yield Fault.at(step, "number", text, "correct `size`, `packet` or `first`")
        data = field_of(message, step.get("data"))
        if data and data.bits != 8 * packet:
            text = f"{quote(data.name)} holds {count(data.bits // 8, 'byte')}, and a packet has {packet}"
            yield Fault.at(
                step, "data", text, "correct `packet`, or name another field"
            )


def _total(names: ProcedureNames, blocks: Map) -> int | None:
    """Return the largest number of bytes that `blocks` transfers; None if the ICD does
    not say it.
    """
    if "of" in blocks:
        most = _map(names.inputs, str(blocks["of"])).get("most")
    else:
        most = _map(names.procedure, "limits").get("bytes")
    return most if isinstance(most, int) else None


def _numbers_of_block(
    names: ProcedureNames, message: Message, placed: PlacedStep, size: int
) -> Iterator[Fault]:
    """Yield the faults of fields that cannot hold a number of a block or a packet."""
    packet = placed.missing.get("packet", size)
    total = _total(names, placed.blocks)
    if not isinstance(packet, int) or total is None:
        return
    packets = -(-size // packet)
    largest = {
        "block.length": size,
        # The last block and the last packet begin at most at the last byte.
        "block.offset": total - 1,
        "packet.offset": total - 1,
        "packet.number": int(placed.missing.get("first", 0)) + packets - 1,
    }
    values = _map(placed.step, "with")
    for name, value in values.items():
        field = field_of(message, name)
        most = largest.get(value) if isinstance(value, str) else None
        if field and most is not None and most >= 1 << field.bits:
            highest = (1 << field.bits) - 1
            text = f"{quote(name)} holds 0 to {highest}, and `{value}` can be {most}"
            yield Fault.at(values, name, text, "correct `size`, or name another field")
