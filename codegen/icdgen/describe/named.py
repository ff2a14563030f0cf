"""Names of parts of an ICD in code and in findings.

`NamedPart` is the base class of all descriptions of fields, messages, structs,
enumerations and members. It splits an identifier into words once; languages join them
as they need.
"""

from __future__ import annotations

from typing import Generic, TypeVar

from icdgen import naming
from icdgen.icd.identifiers import Identifier
from icdgen.icd.layout import LayoutNode
from icdgen.icd.model import Enum, Member, Message, Struct
from icdgen.icd.places import NodePlace
from icdgen.once import cached_property

ModelPart = Message | Struct | LayoutNode | Enum | Member
Model = TypeVar("Model", bound=Message | Struct | NodePlace | Enum | Member)


class NamedPart(Generic[Model]):
    """Part of the ICD (``model``) with a name: ``words`` of its identifier, and
    ``name``, the words in snake case.

    Findings call it ``owner``, for instance "enumeration `Mode`". ``part`` is the
    object of the model that declares it.
    """

    def __init__(
        self, model: Model, part: ModelPart, vocabulary: tuple[str, ...], owner: str
    ) -> None:
        self.model: Model = model
        self.part, self.owner = part, owner
        self.words = naming.words(model.identifier or model.name, vocabulary)
        self.name = naming.snake(self.words)

    @cached_property
    def camel_name(self) -> str:
        """Words in camel case: ``EstimatedRollAngle``."""
        return naming.camel(self.words)

    def identifier(self, scope: str, name: str, role: str = "") -> Identifier:
        """Return a name that generated code declares for the part."""
        return Identifier(scope, name, self.owner, self.part.source, role, self.part)
