"""Whether a node is what this package was generated for."""

from __future__ import annotations

from typing import NamedTuple

from .._hints import Buffer
from .errors import need
from .link import Link


class Identity(NamedTuple):
    """What a node says of itself, and whether the ICD says the same."""

    node_type: int
    interface_version: int
    matches: bool


def identify(link: Link, data: Buffer) -> Identity:
    """The identity in an identification frame.

    Raises `LengthError` and `UnsupportedError`.
    """
    step = need(link.identification, "identification")
    frame = link.TELEMETRY[need(step.telemetry, "identification")].from_bytes(data)
    type = int(getattr(frame, step.fields["node_type"]))
    version = int(getattr(frame, step.fields["interface_version"]))
    is_type = link.node_type in (None, type)
    return Identity(
        type, version, is_type and link.interface_version in (None, version)
    )
