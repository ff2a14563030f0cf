"""How a simulated device behaves."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Settings:
    """Times in milliseconds. ``boot_ms``: how long the boot program waits, None: as the ICD says."""

    boot_ms: int | None = None
    busy_ms: int = 20  # loading, erasing, committing
    processing_ms: int = 0  # of a telecommand; another one meanwhile overruns the buffer
    strict: bool = False  # refuse also what is no member of an enumeration, or beyond a limit
    every_ms: int = 1000  # between what it sends by itself, in envelopes; 0: nothing
    values: dict[str, dict[str, int | bytes]] = field(default_factory=dict)  # in force from every start
