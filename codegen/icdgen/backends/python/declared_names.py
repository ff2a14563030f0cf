"""Every name that the generated package declares, by scope, for the name rules."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from icdgen.backends import Identifier
from icdgen.backends.python import names
from icdgen.describe import Description
from icdgen.describe.description import Composite
from icdgen.describe.wholes import whole
from icdgen.naming import DEVICES


def declared_names(description: Description, package: str) -> Iterator[Identifier]:
    """All names that come from the ICDs, and what they clash with of the names that are always there."""
    for node in description.nodes:
        scope, within = f"package {package}", f"{package}.{node.name}"
        yield node.identifier(scope, node.name)
        if node.name in names.IN_PACKAGE:
            yield Identifier(scope, node.name, names.IN_PACKAGE[node.name].format(node.name), None)
        for name in DEVICES:
            yield Identifier(f"files of {within}", name, "a device of Windows", None)
        for owner in map(description.node, (*description.icd.included(node.model), node.model)):
            for one in owner.declared:
                yield one.identifier(f"module {within}", names.class_name(one))
        for struct in node.structs:
            yield struct.identifier(f"files of {within}", names.module_name(struct))
            yield from _fields(struct, f"members of {within}.{names.class_name(struct)}")
        for enum in node.enums:  # messages have files in every language
            yield enum.identifier(f"files of {within}", names.module_name(enum))
            for member in enum.members:
                yield member.identifier(f"members of {within}.{names.class_name(enum)}", member.name.upper())
        for message in node.messages:
            yield from _fields(message, f"members of {within}.{names.class_name(message)}")


def _fields(one: Composite[Any], scope: str) -> Iterator[Identifier]:
    for field in one.all_members:
        if field.model.implied:
            continue
        exact = None if field.steps is None else whole(field.steps)
        physical = [field.physical_name] if field.has_physical else []
        physical += [field.whole_name(exact.per)] if exact is not None else []
        for name in (field.name, *physical, *(constant.name.upper() for constant in field.constants)):
            yield field.identifier(scope, name)
            if name in names.IN_MESSAGE:
                yield Identifier(scope, name, names.IN_MESSAGE[name].format(name), None)
