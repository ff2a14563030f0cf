"""What the ICD gives a name: how it is called in code and in findings."""

from __future__ import annotations

from typing import Generic, TypeVar

from icdgen import naming
from icdgen.icd.identifiers import Identifier
from icdgen.icd.model import Enum, Member, Message, Struct
from icdgen.icd.places import NodePlace

Model = TypeVar("Model", bound=Message | Struct | NodePlace | Enum | Member)


class Named(Generic[Model]):
    """Something of the ICD (``model``). ``words`` are those of its identifier, ``name`` is them in snake case.

    ``owner`` is what a finding calls it.
    """

    def __init__(self, model: Model, vocabulary: tuple[str, ...], owner: str) -> None:
        self.model: Model = model
        self.owner = owner
        self.words = naming.words(model.identifier or model.name, vocabulary)
        self.name = naming.snake(self.words)

    def identifier(self, scope: str, name: str) -> Identifier:
        """A name that generated code declares for it."""
        return Identifier(scope, name, self.owner, self.model.source)
