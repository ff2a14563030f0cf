"""What all messages of a file share while it is read: enumerations, what was said already, and how much was done."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from icdgen.definitions.enumerations import Enumerations
from icdgen.definitions.model import RAW_ONLY, Definitions, NotHeld

_SHOWN = 3  # messages of a finding


class TooMuch(NotHeld):
    """The file says more than is read of one."""


@dataclass
class Reading:
    """What the messages of one file share.

    ``most_steps`` is what a kind of definition may do, so that a small file cannot ask for much; ``message`` is the name
    of the message that is being read.
    """

    most_steps: ClassVar[int]

    to: Definitions
    enums: Enumerations = field(init=False, default_factory=Enumerations)
    steps: int = field(init=False, default=0)
    said: set[object] = field(init=False, default_factory=set)
    message: str = field(init=False, default="")
    _raw_only: dict[tuple[str, str, str], dict[str, None]] = field(init=False, default_factory=dict)

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

    def raw_only(self, where: str, why: str, help: str) -> None:
        """Note that of a field of ``message`` only the raw value is imported."""
        self._raw_only.setdefault((where, why, help), {})[self.message] = None

    def report_raw_only(self) -> None:
        """Add a finding (IMP078) for each field of which only the raw value is imported, with the messages that contain it."""
        for (where, why, help), messages in self._raw_only.items():
            shown = ", ".join(f"`{name}`" for name in list(messages)[:_SHOWN])
            more = f" and {len(messages) - _SHOWN} more" if len(messages) > _SHOWN else ""
            whole = "message" if len(messages) == 1 else "messages"
            self.to.warn(RAW_ONLY, f"{where} ({whole} {shown}{more}): {why}", help)
