"""Every name that the generated package declares, by scope, for the name rules."""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.backends import Identifier
from icdgen.backends.python import names
from icdgen.icd.model import Icd, Message, Node
from icdgen.naming import DEVICES


def identifiers(icd: Icd, package: str) -> Iterator[Identifier]:
    """All names that come from the ICDs, and what they clash with of the names that are always there."""
    for node in icd.nodes:
        yield Identifier(f"package {package}", node.name, f"node `{node.name}`", node.source)
        if node.name in names.IN_PACKAGE:
            said = names.IN_PACKAGE[node.name].format(node.name)
            yield Identifier(f"package {package}", node.name, said, None)
        yield from _node(icd, node, f"{package}.{node.name}")
        for enum in node.enums:
            scope = f"members of {package}.{node.name}.{names.class_name(enum, node)}"
            for member in enum.members:
                yield Identifier(
                    scope, names.member(member, node), f"member `{member.name}` of `{enum.name}`", member.source
                )
        for message in node.messages:
            scope = f"members of {package}.{node.name}.{names.class_name(message, node)}"
            yield from _message(message, node, scope)


def _node(icd: Icd, node: Node, scope: str) -> Iterator[Identifier]:
    for name in DEVICES:
        yield Identifier(f"files of {scope}", name, "a device of Windows", None)
    for enum in node.enums:  # messages have files in every language
        yield Identifier(f"files of {scope}", names.module_name(enum, node), f"enumeration `{enum.name}`", enum.source)
    for owner in (*icd.included(node), node):
        for one, kind in (*((m, "message") for m in owner.messages), *((e, "enumeration") for e in owner.enums)):
            said = f"{kind} `{one.name}`"
            yield Identifier(f"module {scope}", names.class_name(one, owner), said, one.source)


def _message(message: Message, node: Node, scope: str) -> Iterator[Identifier]:
    for field in message.fields:
        attribute = names.attribute(field, node)
        physical = (names.physical(field, attribute),) if field.scale is not None else ()
        for name in (attribute, *physical):
            yield Identifier(scope, name, f"field `{field.name}` of `{message.name}`", field.source)
            if name in names.IN_MESSAGE:
                yield Identifier(scope, name, names.IN_MESSAGE[name].format(name), None)
