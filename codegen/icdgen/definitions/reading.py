"""What all messages of a file share while it is read: enumerations, what was said already, and how much was done."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from icdgen.definitions.enumerations import Enumerations
from icdgen.definitions.model import Definitions, NotHeld


class TooMuch(NotHeld):
    """The file says more than is read of one."""


@dataclass
class Reading:
    """Of one file. ``most_steps`` is what a kind of definition may do, so that a small file cannot ask for much."""

    most_steps: ClassVar[int]

    to: Definitions
    enums: Enumerations = field(init=False, default_factory=Enumerations)
    steps: int = field(init=False, default=0)
    said: set[object] = field(init=False, default_factory=set)

    def step(self, count: int = 1) -> None:
        """Counts what is done. Raises `TooMuch`."""
        self.steps += count
        if self.steps > self.most_steps:
            raise TooMuch(f"with it the file says more than {self.most_steps:,} things")

    def is_new(self, what: object) -> bool:
        """Whether something is to be said for the first time."""
        is_new = what not in self.said
        self.said.add(what)
        return is_new

    def heard(self, what: object) -> Definitions:
        """Where to note faults of something: nowhere once they have been."""
        return self.to if self.is_new(what) else Definitions("")
