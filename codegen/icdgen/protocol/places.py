"""Where the parts of a node's protocol stand in its ICD."""

from __future__ import annotations

from typing import Any

from icdgen.protocol.sections import (
    PROCEDURES,
    Acknowledge,
    Can,
    Checksum,
    Crc,
    Extended,
    Files,
    Framing,
    HoleMap,
    Index,
    LogFile,
    LogMask,
    LogMessage,
    Operation,
    Settings,
)

PLACES: tuple[tuple[str, type[Any]], ...] = (
    ("client", Settings),
    ("uart.framing", Framing),
    ("uart.acknowledge", Acknowledge),
    ("can", Can),
    ("can.extended", Extended),
    ("crc8", Crc),
    ("crc8", Checksum),
    ("crc16", Crc),
    ("log_mask", LogMask),
    ("telemetry_log", LogFile),
    ("unsolicited_log", LogMessage),
    ("index_file", Index),
    ("file_transfer", Files),
    ("file_transfer.hole_map", HoleMap),
    *((f"file_transfer.{name}", part) for name, part in PROCEDURES.items()),
    ("program_copy", Operation),
    ("program_information", Operation),
    ("checksums.*", Crc),
)
"""Where the facts of each part stand in the protocol section of an ICD; `*` is any name."""
