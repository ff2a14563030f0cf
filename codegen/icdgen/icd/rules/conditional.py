"""Optional fields: their conditions, and the messages and links that support them.

The rules look at fields with the key `when`. `icdgen.icd.conditions` has the checks of
the names (ICD160) and values (ICD161) in conditions. ICD162 reports fields that cannot
be optional, such as arrays, and ICD163 links and composite messages, which need every
field.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.icd import conditions, variable_length
from icdgen.icd.fault import Fault
from icdgen.icd.located import Map
from icdgen.icd.model import Struct
from icdgen.icd.rules.context import Context
from icdgen.icd.rules.rule import rule
from icdgen.icd.trees import mappings
from icdgen.wording import quote

# Keys of fields that cannot be optional, with words for messages.
# Only the first that applies is reported.
_NEVER = (
    ("count", "an array"),
    ("size", "of variable length"),
    ("bitfields", "a split field"),
    ("view", "an overlay field"),
)


def _owners_of_optional_fields(ctx: Context) -> dict[int, Map]:
    """Return the mappings of messages and structs with optional fields, by their id()."""
    owners = (message.source for _, (_, message, _) in ctx.fields_with["when"])
    return {id(owner): owner for owner in owners}


def _fields_by_owner(ctx: Context) -> dict[int, dict[str, Map]]:
    """Return the fields by name of messages and structs with optional fields."""
    return {
        key: conditions.fields_by_name(owner)
        for key, owner in _owners_of_optional_fields(ctx).items()
    }


@rule("ICD160")
def conditions_name_plain_fields(ctx: Context) -> Iterator[Fault]:
    fields = _fields_by_owner(ctx)
    for field, (_, message, _) in ctx.fields_with["when"]:
        own = fields[id(message.source)]
        yield from conditions.faults_of_names(message.source, own, field.source)


@rule("ICD161")
def conditions_can_be_met(ctx: Context) -> Iterator[Fault]:
    fields = _fields_by_owner(ctx)
    for field, (_, message, node) in ctx.fields_with["when"]:
        own = fields[id(message.source)]
        enums = {enum.name: enum for owner in ctx.scope(node) for enum in owner.enums}
        yield from conditions.faults_of_values(own, field.source, enums)


@rule("ICD162")
def optional_fields_can_be_absent(ctx: Context) -> Iterator[Fault]:
    with_variable_length = {
        key
        for key, owner in _owners_of_optional_fields(ctx).items()
        if variable_length.variable_fields(owner)
    }
    for field, (_, message, _) in ctx.fields_with["when"]:
        source = field.source
        reason = next(
            (words for key, words in _NEVER if source.get(key)),
            f"`{field.type}`" if field.is_bytes else "",
        )
        if isinstance(message, Struct):
            text = f"{quote(field.name)} is a field of a struct, and optional fields in structs are not supported"
            yield Fault.at(
                source,
                "when",
                text,
                "write the fields of the struct into the message, or remove `when`",
            )
        elif reason:
            text = f"{quote(field.name)} is {reason}, but only a number, a flag or an enumeration value can be optional"
            help = "write its elements as single fields, each with `when`, or remove `when`"
            yield Fault.at(
                source, "when", text, help if source.get("count") else "remove `when`"
            )
        elif id(message.source) in with_variable_length:
            text = f"{quote(message.name)} has a variable-length field, so its other fields cannot be optional"
            yield Fault.at(source, "when", text, "remove `when`")


@rule("ICD163")
def optional_fields_are_supported(ctx: Context) -> Iterator[Fault]:
    """Report optional fields on links and in composite messages, which read every field
    of a message.
    """
    # Messages with optional fields.
    optional = {id(line.owner.source) for _, line in ctx.fields_with["when"]}
    for node in filter(ctx.is_linked, ctx.icd.nodes):
        for message in ctx.messages_of(node):
            if id(message.source) in optional:
                absent = f"{quote(message.name)} has optional fields"
                help = "leave `when` or `protocol` out of this ICD, or describe the link in `link`"
                yield Fault.at(
                    message.source,
                    "name",
                    f"{absent}, which the links in `protocol` do not support",
                    help,
                )
    # ICD047 pairs the fields of a composite message and of its parts by position.
    # Optional fields can share a position, so there would be no pairs.
    for message, node in ctx.messages if optional else ():
        names = {
            other.name
            for other in ctx.messages_of(node)
            if id(other.source) in optional
        }
        for part in mappings(message.source.get("contains")):
            name = part.get("message")
            if isinstance(name, str) and (
                name in names or id(message.source) in optional
            ):
                absent = f"{quote(name if name in names else message.name)} has optional fields"
                text = f"{absent}, so {quote(message.name)} cannot repeat {quote(name)}"
                yield Fault(
                    message.source,
                    part.at("message"),
                    text,
                    "remove it from `contains`",
                )
