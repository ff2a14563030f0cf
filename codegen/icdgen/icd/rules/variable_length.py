"""Messages of variable length: counters, positions and links; frames that may end
early.

`icdgen.icd.variable_length` has the checks of the counter (ICD120) and position
(ICD121) of one field. ICD122 reports variable lengths on links and in composite
messages, which need one length per message. ICD150 checks `may_end_early`. `structs`
has the rule of variable lengths in structs.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.diagnostics import Related
from icdgen.icd import variable_length
from icdgen.icd.fault import Fault
from icdgen.icd.layout import Array, Overlay, stride
from icdgen.icd.model import Message
from icdgen.icd.places import places_in
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import mappings, named
from icdgen.wording import count, quote


@rule("ICD120")
def counts_are_determined(ctx: Context) -> Iterator[Fault]:
    for message, _ in ctx.messages:
        for item in variable_length.variable_fields(message.source):
            yield from variable_length.faults_of_count(message.source, item)
    for line in ctx.lines:
        node, source = line.node, line.node.source
        if "up_to" in source and not variable_length.is_variable(source):
            size = f"`count: {node.size}`" if isinstance(node, Array) else "`bits`"
            text = f"{quote(node.name)} has a fixed size ({size}), so `up_to` has no effect"
            help = "remove `up_to`; the largest value of a number is `max`"
            yield Fault.at(source, "up_to", text, help)


@rule("ICD121")
def variable_parts_are_at_the_end(ctx: Context) -> Iterator[Fault]:
    sequences = {
        id(item)
        for owner, _ in ctx.owners
        for item in variable_length.sequence_of(owner.source)
    }
    for line in ctx.lines:
        source = line.node.source
        if "after" in source and id(source) not in sequences:
            text = (
                f"{quote(line.node.name)} has `after`, but {quote(line.owner.name)} "
                "has no variable-length field, so its place is `at`"
            )
            yield Fault.at(source, "after", text, "remove `after`")
    for message, node in ctx.messages:
        lengths = {
            struct.name: struct.length
            for owner in ctx.scope(node)
            for struct in owner.structs
        }
        for item in variable_length.sequence_of(message.source):
            yield from variable_length.faults_of_place(message.source, item, lengths)
        for item in variable_length.fixed_fields_after(message.source):
            first = variable_length.variable_fields(message.source)[0]
            text = f"{quote(item['name'])} follows {quote(first['name'])}, whose length varies, so it has no fixed place"
            help = (
                f"place it in front of {quote(first['name'])}; or write `after`, the name of the field in front of it, "
                f"and `at: {first['at']}`"
            )
            related = Related(first.at("name"), "the variable-length field")
            yield Fault.at(item, "at", text, help, related=related)
        layout = message.layout
        for overlay in layout.fixed if layout.sequence else ():
            # The position of the second part depends on the size of the first, so an
            # overlay can only read the fixed part.
            always = layout.length if len(layout.sequence) > 1 else layout.shortest
            end = overlay.at + stride(overlay)
            if isinstance(overlay, Overlay) and end > 8 * always:
                parts = [
                    place
                    for place in places_in(layout)
                    if place.node in layout.sequence and place.at < end
                ]
                text = f"{quote(overlay.name)} is an overlay of {quote(parts[-1].name)}, which not every frame has"
                yield Fault.at(
                    overlay.source,
                    "at",
                    text,
                    "place the overlay on fields that every frame has",
                )


@rule("ICD122")
def variable_lengths_are_supported(ctx: Context) -> Iterator[Fault]:
    """Report variable-length messages on links, and in composite messages: both need
    one length per message.
    """
    for node in filter(ctx.is_linked, ctx.icd.nodes):
        for message in ctx.messages_of(node):
            if message.layout.sequence:
                lengths = (
                    f"{message.layout.shortest} to {count(message.length, 'byte')}"
                )
                text = f"{quote(message.name)} has {lengths}, but the links in `protocol` need one length per message"
                help = "leave `protocol` out of this ICD, or give the message a fixed `count`"
                yield Fault.at(message.source, "length", text, help)
    variable = {
        message.name: message for message, _ in ctx.messages if message.layout.sequence
    }
    for message, node in ctx.messages:
        for part in mappings(message.source.get("contains")):
            inner = named(variable, part.get("message"))
            if inner is not None and inner in ctx.messages_of(node):
                text = f"{quote(inner.name)} has no fixed length, so {quote(message.name)} cannot repeat it"
                yield Fault(
                    message.source,
                    part.at("message"),
                    text,
                    "remove it from `contains`",
                )


@rule("ICD150")
def messages_can_end_early(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for message in ctx.messages_of(node):
            why = (
                _reason_against_early_end(message, ctx.is_linked(node))
                if message.may_end_early
                else ""
            )
            if why:
                text = f"{quote(message.name)} {why}"
                yield Fault.at(
                    message.source, "may_end_early", text, "remove `may_end_early`"
                )


def _reason_against_early_end(message: Message, is_linked: bool) -> str:
    """Return why no frame of a message can omit trailing zeros, as the end of a
    sentence; empty if a frame can.
    """
    if variable_length.variable_fields(message.source):
        return "has a variable-length field, and the zeros at the end of a frame belong to it"
    # MAVLink 2 truncates zeros in this way, and never truncates the first byte of the
    # payload.
    if message.length < 2:
        return f"has {count(message.length, 'byte')}, and the first byte is always sent"
    if is_linked:
        return "may end early, but the links in `protocol` need one length per message"
    return ""
