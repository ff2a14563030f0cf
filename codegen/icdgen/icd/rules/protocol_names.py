"""Protocol section: names of messages, fields, enumeration members and nodes.

The rules look for the keys in `MESSAGES`, `FIELDS` and `MEMBERS`, `fields` and `nodes`
at any depth of the section, and report names without a counterpart in the model
(ICD093, ICD094, ICD109). ICD113 reports fields with orders other than those of the
node. ICD109 accepts a node that has a file in the same folder. `packets`, `responses`
and `buses` check names of packets.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

from icdgen.diagnostics import Place
from icdgen.frozen import NamedTuple
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Message, Node
from icdgen.icd.places import scalars_in
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.protocol import sections
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import VERBATIM
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import named
from icdgen.wording import quote

T = TypeVar("T")

# Keys that name messages.
MESSAGES = (
    "message",
    "stop_request",
    "set_by",
    "reset_by",
    "if_not_started",
)
# Keys that name fields of the message of the key `message` in the same mapping.
FIELDS = ("field",)
# Keys that name an enumeration, with the keys of the same mapping that have its values.
MEMBERS = (
    (
        "enum",
        (
            "value",
            "values",
            "selected",
            "success",
            "failed",
        ),
    ),
    ("failure_enum", ("failure",)),
)


@rule("ICD093", needs_complete=True)
def named_messages_and_members_exist(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        messages = {message.name for message in ctx.messages_of(node)}
        enums = {enum.name: enum for owner in ctx.scope(node) for enum in owner.enums}
        for section in sections(node):
            for key in MESSAGES:
                for name, place in _values(section, key, str):
                    if name not in messages:
                        help, fix = suggestion(name, messages, VERBATIM)
                        yield Fault.of_place(
                            section,
                            place,
                            f"there is no message {quote(name)}",
                            help,
                            fix,
                        )
            for name, keys in MEMBERS:
                enum = named(enums, section.get(name))
                if enum is None:
                    continue
                for key in keys:
                    for value, place in _values(section, key, int):
                        if enum.member_of(value) is None:
                            text = f"the enumeration {quote(enum.name)} has no member {value}"
                            yield Fault(
                                section, place, text, f"correct `{key}` or `{name}`"
                            )


class _NamedField(NamedTuple):
    """Name of a field in the protocol section: ``owner[key]`` is the name of a field of
    ``message``.
    """

    owner: Map
    key: str
    message: Message


def _named_fields(ctx: Context, node: Node) -> Iterator[_NamedField]:
    """Yield the names of fields in the protocol section of a node."""
    messages = {message.name: message for message in ctx.messages_of(node)}
    for section in sections(node):
        references = [
            (section, key, section.get("message")) for key in FIELDS if key in section
        ]
        if isinstance(fields := section.get("fields"), Map):
            references += [(fields, key, section.get("message")) for key in fields]
        for owner, key, name in references:
            message = named(messages, name)
            if message is not None and isinstance(owner[key], str):
                yield _NamedField(owner, key, message)


@rule("ICD094", needs_complete=True)
def named_fields_exist(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for owner, key, message in _named_fields(ctx, node):
            fields = scalars_in(message.layout)
            names = {field.name for field in fields if not field.is_read_only}
            if any(field.name == owner[key] and field.is_read_only for field in fields):
                text = f"{quote(owner[key])} of {quote(message.name)} is an overlay field, but links read fields with bits"
                yield Fault.at(owner, key, text, "name the field that has the bits")
            elif owner[key] not in names:
                text = f"{quote(message.name)} has no field {quote(owner[key])}"
                yield Fault.at(
                    owner, key, text, *suggestion(owner[key], names, VERBATIM)
                )


@rule("ICD113", needs_complete=True)
def named_fields_have_the_orders_of_the_node(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for owner, key, message in _named_fields(ctx, node):
            home = ctx.home_of(message, node)
            for field in scalars_in(message.layout):
                own = field.orders_in_effect(home.orders)
                if (
                    field.name == owner[key]
                    and not field.is_bytes
                    and own != node.orders
                ):
                    text = f"{quote(field.name)} is {own.byte} {own.bit}, the links of `{node.name}` read fields as"
                    help = f"give it the orders of the node, or leave `{key}` out"
                    yield Fault.at(
                        owner, key, f"{text} {node.byte_order} {node.bit_order}", help
                    )


@rule("ICD109", needs_complete=True)
def named_nodes_exist(ctx: Context) -> Iterator[Fault]:
    names = {node.name for node in ctx.icd.nodes}
    for node in ctx.icd.nodes:
        for section in sections(node):
            for name, place in _values(section, "nodes", str):
                # Only the given ICDs are loaded; the node can be in another file of the
                # same folder.
                if (
                    name not in names
                    and not Path(place.file).with_name(f"{name}.yaml").exists()
                ):
                    help, fix = suggestion(
                        name, names, "correct it, or load the node's file too"
                    )
                    yield Fault.of_place(
                        section, place, f"there is no node {quote(name)}", help, fix
                    )


def _values(section: Map, key: str, kind: type[T]) -> Iterator[tuple[T, Place]]:
    """Yield the values of a type of a key, which is a single value or a list, each with
    its place.
    """
    value = section.get(key)
    if isinstance(value, Seq):
        yield from (
            (item, place) for item, place in value.placed() if isinstance(item, kind)
        )
    elif isinstance(value, kind):
        yield value, section.at(key)
