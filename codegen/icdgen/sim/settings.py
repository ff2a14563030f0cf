"""Settings of a simulated device."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class SimulationSettings:
    """Settings of a simulated device. Times are in milliseconds.

    ``boot_ms`` is the time in the boot program; None for the time in the ICD.
    """

    boot_ms: int | None = None
    busy_ms: int = 20  # duration of loading, erasing, committing
    processing_ms: int = 0  # duration of a telecommand; the next one is lost meanwhile
    # also reject unknown enumeration values and values out of limits
    strict: bool = False
    # period of unsolicited messages with header and trailer; 0: none; None: that of the
    # ICD, otherwise 1 s
    every_ms: int | None = None
    # Set at each start.
    values: dict[str, dict[str, int | bytes]] = field(default_factory=dict)
