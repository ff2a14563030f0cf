"""Messages, fields, enumeration members, message types and nodes that the protocol section names."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import NamedTuple, TypeVar

from icdgen.diagnostics import Place
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Message, Node
from icdgen.icd.places import scalars_in
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.protocol import sections
from icdgen.icd.rules.rule import rule
from icdgen.icd.rules.wording import VERBATIM, quote
from icdgen.icd.suggestions import suggestion
from icdgen.icd.trees import at_path, mappings, named

T = TypeVar("T")

# keys that name messages
MESSAGES = ("message", "packet", "id_of", "stop_request", "set_by", "names", "reset_by", "if_not_started")
FIELDS = ("id", "until", "error", "parameter", "field")  # keys that, beside `message`, name fields of it
# keys that name an enumeration, and the keys beside them that give its values
MEMBERS = (
    ("enum", ("value", "none", "unknown_id", "length", "parameter", "checksum", "selected", "success", "failed")),
    ("failure_enum", ("failure",)),
    ("destination_enum", ("destinations",)),
    ("program_enum", ("programs", "destination")),
)
# keys of `can.telecommand` and `can.telemetry` that name message types
TYPES = ("request", "extended_request", "acknowledge", "response", "extended_response", "failure")


@rule("ICD093", whole=True)
def named_things_exist(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        messages = {m.name for m in ctx.messages_of(node)}
        enums = {e.name: e for n in ctx.scope(node) for e in n.enums}
        for section in sections(node):
            for key in MESSAGES:
                for name, place in _values(section, key, str):
                    if name not in messages:
                        help, fix = suggestion(name, messages, VERBATIM)
                        yield Fault.of_place(section, place, f"there is no message {quote(name)}", help, fix)
            for name, keys in MEMBERS:
                known = named(enums, section.get(name))
                if known is None:
                    continue
                for key in keys:
                    for value, place in _values(section, key, int):
                        if known.member_of(value) is None:
                            message = f"the enumeration {quote(known.name)} has no member {value}"
                            yield Fault(section, place, message, f"correct `{key}` or `{name}`")


class _Named(NamedTuple):
    """A field that the protocol section names: ``owner[key]``, of ``message``."""

    owner: Map
    key: str
    message: Message


def _named_fields(ctx: Context, node: Node) -> Iterator[_Named]:
    messages = {m.name: m for m in ctx.messages_of(node)}
    for section in sections(node):
        found = [(section, key, section.get("message")) for key in FIELDS if key in section]
        if isinstance(fields := section.get("fields"), Map):
            found += [(fields, key, section.get("message")) for key in fields]
        if isinstance(names := section.get("names"), Seq) and "field" in section:
            found += [(section, "field", name) for name in names]
        for owner, key, name in found:
            message = named(messages, name)
            if message is not None and isinstance(owner[key], str):
                yield _Named(owner, key, message)


@rule("ICD094", whole=True)
def named_fields_exist(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for owner, key, message in _named_fields(ctx, node):
            fields = scalars_in(message.layout)
            known = {field.name for field in fields if not field.view}
            if any(field.name == owner[key] and field.view for field in fields):
                text = f"{quote(owner[key])} of {quote(message.name)} is a view, and links read what has bits"
                yield Fault.at(owner, key, text, "name the field that has the bits")
            elif owner[key] not in known:
                text = f"{quote(message.name)} has no field {quote(owner[key])}"
                yield Fault.at(owner, key, text, *suggestion(owner[key], known, VERBATIM))


@rule("ICD113", whole=True)
def named_fields_in_the_order_of_the_node(ctx: Context) -> Iterator[Fault]:
    for node in ctx.icd.nodes:
        for owner, key, message in _named_fields(ctx, node):
            home = ctx.home_of(message, node)
            for field in scalars_in(message.layout):
                own = field.orders_in_effect(home.orders)
                if field.name == owner[key] and not field.is_bytes and own != node.orders:
                    text = f"{quote(field.name)} is {own.byte} {own.bit}, the links of `{node.name}` read fields as"
                    help = f"give it the orders of the node, or leave `{key}` out"
                    yield Fault.at(owner, key, f"{text} {node.byte_order} {node.bit_order}", help)


@rule("ICD095")
def message_types_exist(ctx: Context) -> Iterator[Fault]:
    for can in ctx.sections("can"):
        values = at_path(can, ("message_types", "values"))
        if not isinstance(values, Seq):
            continue
        known = {row["name"] for row in mappings(values) if isinstance(row.get("name"), str)}
        for direction, key in product(("telecommand", "telemetry"), TYPES):
            name = at_path(can, (direction, key))
            if isinstance(name, str) and name not in known:
                message = f"there is no message type {quote(name)}"
                yield Fault.at(can[direction], key, message, *suggestion(name, known, VERBATIM))


@rule("ICD109", whole=True)
def named_nodes_exist(ctx: Context) -> Iterator[Fault]:
    known = {node.name for node in ctx.icd.nodes}
    for node in ctx.icd.nodes:
        for section in sections(node):
            for name, place in _values(section, "nodes", str):
                # A node that was not asked for is not loaded, but its file lies beside this one.
                if name not in known and not Path(place.file).with_name(f"{name}.yaml").exists():
                    help, fix = suggestion(name, known, "correct it, or load the node's file too")
                    yield Fault.of_place(section, place, f"there is no node {quote(name)}", help, fix)


def _values(section: Map, key: str, kind: type[T]) -> Iterator[tuple[T, Place]]:
    """The value of a key, or each of its values, with its place."""
    value = section.get(key)
    if isinstance(value, Seq):
        yield from ((v, p) for v, p in value.placed() if isinstance(v, kind))
    elif isinstance(value, kind):
        yield value, section.at(key)
