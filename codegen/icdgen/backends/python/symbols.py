"""Names that the Python package declares, for the symbol table.

The rules on names report two equal names of a scope before any code is generated; see
`icdgen.describe.symbols`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from icdgen.backends import Identifier
from icdgen.backends.packages import Packages
from icdgen.backends.python import names
from icdgen.describe import EnumDescription, FieldDescription, NodeDescription
from icdgen.describe.description import Composite
from icdgen.describe.enums import MemberDescription
from icdgen.describe.symbols import DescribedPart, NamingPolicy, Symbols
from icdgen.icd.model import Message
from icdgen.naming import DEVICES, camel, words


class PythonNames(NamingPolicy):
    """Names in a package.

    Names that the code uses itself are declared only where a name of the ICD is equal.
    """

    reserved = names.RESERVED

    def __init__(self, package: str) -> None:
        super().__init__()
        self._package = package

    def node(self, node: NodeDescription) -> Symbols:
        scope = f"package {self._package}"
        yield node.identifier(scope, node.name)
        if node.name in names.IN_PACKAGE:
            yield Identifier(
                scope, node.name, names.IN_PACKAGE[node.name].format(node.name), None
            )
        for name in DEVICES:
            # A module is a file, and Windows opens a device for `con.py`.
            yield Identifier(self._files(node.name), name, "a device of Windows", None)

    def link(self, node: NodeDescription) -> Symbols:
        """Names of the procedures, their parameters and their results."""
        scope = f"module {self._package}.{node.name}.{names.PROCEDURES}"
        for name, row in node.procedures.items():
            owner, source = f"procedure `{name}`", node.model.source
            class_ = class_name(name)
            yield Identifier(scope, class_, owner, source)
            if class_ in names.IN_PROCEDURES:
                use = names.IN_PROCEDURES[class_].format(class_)
                yield Identifier(scope, class_, use, None)
            parameters = [(each, names.IN_PARAMETERS) for each in row.get("inputs", {})]
            if any("blocks" in step for step in row["steps"]):
                parameters.append((names.BLOCK, {}))
            outputs = [(each, names.IN_PROCEDURE) for each in row.get("outputs", {})]
            for members, kind in ((parameters, "parameters"), (outputs, "members")):
                own = (
                    f"{kind} of {self._package}.{node.name}.{names.PROCEDURES}.{class_}"
                )
                for text, uses in members:
                    yield Identifier(own, text, f"`{text}` of {owner}", source)
                    if text in uses:
                        yield Identifier(own, text, uses[text].format(text), None)

    def in_node(self, node: NodeDescription, part: DescribedPart) -> Symbols:
        # The module of a node also has the classes of included nodes.
        if part.node.name != node.name:
            yield self._class(part, node.name)

    def enumeration(self, enum: EnumDescription) -> Symbols:
        yield self._class(enum, enum.node.name)
        yield enum.identifier(self._files(enum.node.name), names.module_name(enum))

    def member(self, enum: EnumDescription, member: MemberDescription) -> Symbols:
        yield member.identifier(self._members(enum), names.constant_name(member.name))

    def composite(self, composite: Composite[Any]) -> Symbols:
        yield self._class(composite, composite.node.name)
        # Messages have files in every language.
        if not isinstance(composite.model, Message):
            yield composite.identifier(
                self._files(composite.node.name), names.module_name(composite)
            )

    def fields(
        self, composite: Composite[Any], fields: Iterable[FieldDescription]
    ) -> Symbols:
        scope = self._members(composite)
        for field in fields:
            values = (
                ()
                # A count is the length of the tuple, so the class has no attribute for
                # it.
                if field.model.is_count
                else (
                    field.name,
                    *(each.name for each in names.accessors_in_python(field)),
                )
            )
            for text in (
                *values,
                *(names.constant_name(constant.name) for constant in field.constants),
            ):
                yield field.identifier(scope, text)
                if text in names.IN_MESSAGE:
                    yield Identifier(
                        scope, text, names.IN_MESSAGE[text].format(text), None
                    )

    def _class(self, part: DescribedPart, node: str) -> Identifier:
        return part.identifier(
            f"module {self._package}.{node}", part.camel_name, "class"
        )

    def _files(self, node: str) -> str:
        return f"files of {self._package}.{node}"

    def _members(self, part: DescribedPart) -> str:
        return f"members of {self._package}.{part.node.name}.{part.camel_name}"


def class_name(procedure: str) -> str:
    """Return the name of the class of a procedure: ``ProgramCopy``."""
    return camel(words(procedure))


PYTHON_NAMES = PythonNames(Packages.python)
"""For names that do not depend on the package."""
