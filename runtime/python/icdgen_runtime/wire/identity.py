"""Check that a node is the one that this package was generated for."""

from __future__ import annotations

from typing import NamedTuple

from .._hints import Buffer
from .errors import need
from .link import Link


class Identity(NamedTuple):
    """Type and interface version of a node, and whether they match the ICD."""

    node_type: int
    interface_version: int
    matches: bool


def identify(link: Link, data: Buffer) -> Identity:
    """Decode an identification frame and compare it with the ICD.

    Raise `LengthError` and `UnsupportedError`.
    """
    report = need(link.identification, "identification")
    frame = link.TELEMETRY[need(report.telemetry, "identification")].from_bytes(data)
    type = int(getattr(frame, report.fields["node_type"]))
    version = int(getattr(frame, report.fields["interface_version"]))
    is_type = link.node_type in (None, type)
    return Identity(
        type, version, is_type and link.interface_version in (None, version)
    )
