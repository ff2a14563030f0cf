"""Values for the template of the procedures of a node.

A procedure becomes a class with typed inputs and outputs. Its steps are part of the
link, which the engine of the runtime runs.
"""

from __future__ import annotations

from icdgen.backends.python import names
from icdgen.backends.python.symbols import PYTHON_NAMES, class_name
from icdgen.backends.python.text import docstring, paragraph, prose
from icdgen.describe import (
    Description,
    EnumDescription,
    MessageDescription,
    NodeDescription,
)
from icdgen.describe.procedures import input_text, procedure_text
from icdgen.protocol.facts import Facts
from icdgen.protocol.procedures import Input, Output, Procedure


class ProcedureClass:
    """Class of a procedure in generated code."""

    def __init__(
        self, description: Description, node: NodeDescription, procedure: Procedure
    ) -> None:
        self._description, self._node, self.model = description, node, procedure
        self.name = class_name(procedure.name)

    @property
    def enums(self) -> list[EnumDescription]:
        """Enumerations of its inputs and outputs."""
        parts: list[Input | Output] = [*self.model.inputs, *self.model.outputs]
        enums = [part.enum for part in parts if part.enum]
        return [self._description.enum(enum) for enum in enums]

    @property
    def entry(self) -> MessageDescription | None:
        """Class of its entries."""
        entry = self.model.entry
        return self._description.message(entry) if entry else None

    @property
    def imports(self) -> list[str]:
        """Imports of the types of its inputs and outputs."""
        parts: list[EnumDescription | MessageDescription] = [*self.enums]
        parts += [self.entry] if self.entry else []
        return [
            f"from {names.import_path(part, self._node.name, '..')} import "
            f"{PYTHON_NAMES.symbol(part, 'class')}"
            for part in parts
        ]

    @property
    def parameters(self) -> list[str]:
        """Parameters of the constructor, required ones first."""
        # Python refuses a parameter without a default after one with a default.
        # `sorted` is stable, so both groups keep the order of the ICD.
        inputs = sorted(self.model.inputs, key=lambda each: each.is_optional)
        parameters = [f"{each.name}: {self._type(each)}" for each in inputs]
        if self.model.blocks:
            parameters += ["*", f"{names.BLOCK}: Optional[int] = None"]
        return parameters

    def _type(self, each: Input) -> str:
        if each.is_bytes:
            return "bytes"
        kind = self._kind(each)
        return f"Optional[{kind}] = None" if each.is_optional else kind

    def _kind(self, each: Input | Output) -> str:
        if each.enum:
            return PYTHON_NAMES.symbol(self._description.enum(each.enum), "class")
        return "bool" if each.is_flag else "int"

    @property
    def uses_optional(self) -> bool:
        """Whether its annotations use ``Optional``."""
        model = self.model
        inputs = any(each.is_optional for each in model.inputs)
        return bool(inputs or model.blocks or model.outputs)

    @property
    def arguments(self) -> list[str]:
        """Arguments of the constructor of the base class."""
        content = self.model.content
        numbers = [f'"{each.name}": {each.name}' for each in self.model.numbers]
        sent = [f"data={content.name}"] if content else []
        values = [f"{{{', '.join(numbers)}}}"] if numbers else []
        block = [f"block={names.BLOCK}"] if self.model.blocks else []
        return ["_link.LINK", f'"{self.model.name}"', *values, *sent, *block]

    @property
    def docstring(self) -> str:
        """Docstring of the class."""
        model = self.model
        texts = [procedure_text(model) or f"Procedure {model.name}."]
        texts += (f"``{each.name}``: {input_text(each)}" for each in model.inputs)
        blocks = model.blocks
        if blocks:
            size = f"bytes of a block, 1 to {blocks.size}"
            texts.append(f"``{names.BLOCK}``: {size}; by default the largest number.")
        if blocks and not blocks.sends:
            texts.append(f"``data`` has the received bytes, at most {blocks.most}.")
        if self.entry:
            name = PYTHON_NAMES.symbol(self.entry, "class")
            texts.append(f"``entries`` has at most {model.most_entries} `{name}`.")
        raised = ["RangeError"] if blocks or len(model.inputs) else []
        raised += ["TooLongError"] if blocks and blocks.sends else []
        if raised:
            errors = " and ".join(f"`{each}`" for each in raised)
            texts.append(f"Raise {errors} for inputs out of range.")
        return docstring(4, map(paragraph, texts))

    @property
    def outputs(self) -> list[tuple[str, str, str]]:
        """Names of the outputs, their types, and the conversion to it; empty for
        integers.
        """
        kinds = [(each.name, self._kind(each)) for each in self.model.outputs]
        return [(name, kind, "" if kind == "int" else kind) for name, kind in kinds]


def procedure_classes(
    description: Description, node: NodeDescription, facts: Facts
) -> list[ProcedureClass]:
    """Return the classes of the procedures of a node."""
    return [ProcedureClass(description, node, each) for each in facts.procedures]


def procedure_imports(classes: list[ProcedureClass]) -> list[str]:
    """Return the imports of types, each once."""
    return sorted({line for each in classes for line in each.imports})


def procedures_docstring(node: NodeDescription) -> str:
    """Return the docstring of the module."""
    title = f"Procedures of {prose(node.model.title)}."
    return docstring(0, [title, "`Session.run` and `AsyncSession.run` run them."])
