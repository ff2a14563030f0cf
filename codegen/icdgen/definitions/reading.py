"""State shared by all messages of a file while it is read: enumerations, reported
subjects and number of steps.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from icdgen.definitions.enumerations import Enumerations
from icdgen.definitions.model import RAW_ONLY, Definitions, NotSupported

_SHOWN = 3  # messages that a finding lists


class TooMuch(NotSupported):
    """Definition that exceeds the steps that a reader allows."""


@dataclass
class ReadingState:
    """State shared by the messages of one file.

    ``most_steps`` limits the work for a file, because a small file can describe a large
    one. ``message`` is the name of the current message.
    """

    most_steps: ClassVar[int]

    to: Definitions
    enums: Enumerations = field(init=False, default_factory=Enumerations)
    steps: int = field(init=False, default=0)
    reported: set[object] = field(init=False, default_factory=set)
    message: str = field(init=False, default="")
    _raw_only: dict[tuple[str, str, str], dict[str, None]] = field(
        init=False, default_factory=dict
    )

    def step(self, count: int = 1) -> None:
        """Count steps of work. Raises `TooMuch` above ``most_steps``."""
        self.steps += count
        if self.steps > self.most_steps:
            raise TooMuch(f"with it the file says more than {self.most_steps:,} things")

    def is_new(self, what: object) -> bool:
        """Return whether a subject is reported for the first time."""
        is_new = what not in self.reported
        self.reported.add(what)
        return is_new

    def heard(self, what: object) -> Definitions:
        """Return the definitions for findings about a subject.

        Repeated findings go to an unused object.
        """
        return self.to if self.is_new(what) else Definitions("")

    def raw_only(self, where: str, why: str, help: str) -> None:
        """Record a field of ``message`` that is imported as raw value only."""
        self._raw_only.setdefault((where, why, help), {})[self.message] = None

    def report_raw_only(self) -> None:
        """Add a finding (IMP078) for each field that is imported as raw value only,
        with the messages that contain it.
        """
        for (where, why, help), messages in self._raw_only.items():
            shown = ", ".join(f"`{name}`" for name in list(messages)[:_SHOWN])
            more = (
                f" and {len(messages) - _SHOWN} more" if len(messages) > _SHOWN else ""
            )
            noun = "message" if len(messages) == 1 else "messages"
            self.to.warn(RAW_ONLY, f"{where} ({noun} {shown}{more}): {why}", help)
