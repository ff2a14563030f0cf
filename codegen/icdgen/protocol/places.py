"""Sections of an ICD that define the parts of a node's protocol."""

from __future__ import annotations

from typing import Any

from icdgen.protocol import sections

PLACES: tuple[tuple[str, type[Any]], ...] = (
    ("link.client", sections.Settings),
    ("link.buses.uart.framing", sections.Framing),
    ("link.buses.can", sections.Can),
    ("link.buses.can.segments", sections.Extended),
    ("link.packets", sections.Checksum),
    ("log_mask", sections.LogMask),
    ("telemetry_log", sections.LogFile),
    ("unsolicited_log", sections.LogMessage),
    ("index_file", sections.Index),
    ("link.checksums.*", sections.Crc),
    ("link.checksums.*", sections.CheckValue),
)
"""Where the facts of each part stand in the protocol section of an ICD; `*` is any
name.
"""
