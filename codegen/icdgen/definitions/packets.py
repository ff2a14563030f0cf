"""Messages of space packets (CCSDS 133.0-B) and of frames without a header: ids, and
the common header.

Readers of XTCE and of electronic data sheets pass containers with their layout
(`Sent`). `fill` adds them to a network as messages.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from typing import Protocol

from icdgen.definitions.model import Definitions, Item, Network, NotSupported
from icdgen.frozen import NamedTuple

UNTOLD = "IMP079"
TELECOMMAND, TELEMETRY = "telecommand", "telemetry"
HEADER_BITS = 48
MOST_PARTS = 7  # of the primary header
APID_BITS = 11
_HEADERS = (  # position and bits; type and secondary header flag may be one field
    ((0, 3), (3, 1), (4, 1), (5, 11), (16, 2), (18, 14), (32, 16)),
    ((0, 3), (3, 2), (5, 11), (16, 2), (18, 14), (32, 16)),
)
_APID, _FLAGS = (5, 11), (3, 2)
_MOST_ID_BITS = 32


class PrimaryHeader(NamedTuple):
    """Primary header of a space packet.

    Each field has its constant, or None if it varies.
    """

    version: int | None
    type: int | None
    secondary: int | None
    apid: int | None

    @property
    def kind(self) -> str | None:
        """Direction of the packet, or None if the header does not fix it."""
        if self.type is None:
            return None
        return TELECOMMAND if self.type else TELEMETRY


class Sent(Protocol):
    """Container that becomes a message."""

    name: str
    kind: str
    header: PrimaryHeader | None  # None for a container without a primary header
    # Key in `constants` and bits of the first part, if a header can use it as id:
    front: tuple[Hashable, int] | None
    constants: dict[
        Hashable, int
    ]  # constants by part: candidates for the discriminator

    def message(self, id: int, start: int, to: Definitions) -> Item:
        """Return the ICD message from the bit ``start`` on.

        Raises `NotSupported` if it is not supported.
        """


def header(parts: Iterable[tuple[int, int, int | None]]) -> PrimaryHeader | None:
    """Return the primary header that the first parts form, or None.

    A part has position, bits and constant.

    Many databases name only the parts that they use. The application process id is
    required.
    """
    values: dict[tuple[int, int], int | None] = {}
    for at, bits, value in parts:
        values.setdefault((at, bits), value)
    ahead = [place for place in values if place[0] < HEADER_BITS]
    is_whole = any(set(places) <= set(ahead) for places in _HEADERS)
    # All named parts must belong to the header: other frames can have 11 bits at bit 5,
    # too.
    is_part = (
        _APID in ahead
        and len(ahead) > 1
        and any(set(ahead) <= set(places) for places in _HEADERS)
    )
    if not is_whole and not is_part:
        return None
    # Type and secondary header flag may be one part of two bits.
    flags = values.get(_FLAGS)
    kind, secondary = (
        (values.get((3, 1)), values.get((4, 1)))
        if flags is None
        else (flags >> 1, flags & 1)
    )
    return PrimaryHeader(values.get((0, 3)), kind, secondary, values[_APID])


def is_of_header(at: int, bits: int) -> bool:
    """Return whether a part belongs to the primary header."""
    return any((at, bits) in places for places in _HEADERS)


def fill(network: Network, containers: Sequence[Sent], to: Definitions) -> None:
    """Add messages with ids and framing to a network.

    Messages that are not supported are reported.
    """
    if any(container.header is not None for container in containers):
        network.head["id_bits"] = APID_BITS
        _add_packets(containers, network, to)
    else:
        _add_without_header(containers, network, to)


def _add_packets(containers: Sequence[Sent], network: Network, to: Definitions) -> None:
    """Add space packets: the primary header is the framing, and the application process
    id is the message id.
    """
    headers: list[tuple[str, PrimaryHeader]] = []
    versions = [
        container.header.version
        for container in containers
        if container.header is not None
    ]
    version = next((number for number in versions if number is not None), 0)
    for container in containers:
        try:
            if container.header is None:
                raise NotSupported(
                    "it does not begin with the header of a space packet, although others do"
                )
            if container.header.apid is None:
                raise NotSupported("its application process is not stated")
            if container.header.version not in (
                None,
                version,
            ) or container.header.kind not in (None, container.kind):
                raise NotSupported(
                    f"its header is not that of a space packet with {container.kind}"
                )
            message = container.message(container.header.apid, HEADER_BITS, to)
            if not message["length"] and not message.get("fields"):
                raise NotSupported(
                    "it has no data, and a space packet has at least one byte behind its header"
                )
            network.messages.append(message)
            headers.append((container.kind, container.header))
        except NotSupported as why:
            to.left_out(container.name, why)
    network.protocol = {
        "link": {
            "framing": {"by": "length"},
            "header": [
                {"bits": 3, "role": "constant", "value": version},
                {
                    "bits": 1,
                    "role": "constant",
                    "value": {TELECOMMAND: 1, TELEMETRY: 0},
                },
                {"bits": 1, "role": "flags", **_secondary_flag(headers)},
                {"bits": APID_BITS, "role": "id"},
                # Sequence flags 3: unsegmented, unless the sender sets another value.
                {"bits": 2, "role": "type", "value": 3},
                # CCSDS 133.0-B-2, 4.1.3.4: each application process counts its packets.
                {"bits": 14, "role": "sequence", "per": "id"},
                # 4.1.3.5: the bytes behind the header, minus 1.
                {"bits": 16, "role": "length", "plus": -1},
            ],
        }
    }


def _secondary_flag(headers: list[tuple[str, PrimaryHeader]]) -> Item:
    """Return the secondary header flag as a key, if it is constant in a direction."""
    values = {
        kind: {head.secondary for direction, head in headers if direction == kind}
        for kind in (TELECOMMAND, TELEMETRY)
    }
    constants = {
        kind: flags.copy().pop() if len(flags) == 1 else None
        for kind, flags in values.items()
    }
    if all(value is None for value in constants.values()):
        return {}
    return {"value": {kind: value or 0 for kind, value in constants.items()}}


def _add_without_header(
    containers: Sequence[Sent], network: Network, to: Definitions
) -> None:
    """Add messages without a header.

    A discriminator in each direction gives the ids; without one they are counted from
    1.
    """
    # `id_bits` is at least 8, also for small numbers.
    widest, start = 8, _id_in_front(containers)
    if start:
        network.protocol = {
            "link": {
                "framing": {"by": "datagram"},
                "header": [{"bits": start, "role": "id"}],
            }
        }
    for kind in (TELEMETRY, TELECOMMAND):
        same_kind = [container for container in containers if container.kind == kind]
        discriminator = _discriminator(same_kind)
        numbered = []
        for number, container in enumerate(same_kind, 1):
            id = (
                container.constants[discriminator]
                if discriminator is not None
                else number
            )
            widest = max(widest, id.bit_length())
            if discriminator is None:
                numbered.append(container.name)
            try:
                network.messages.append(container.message(id, start, to))
            except NotSupported as why:
                to.left_out(container.name, why)
        if len(numbered) > 1:
            shown = ", ".join(f"`{name}`" for name in numbered[:3]) + (
                " ..." if len(numbered) > 3 else ""
            )
            text = f"no parameter tells all {len(numbered)} messages of {kind}: {shown}"
            to.warn(UNTOLD, text, "their ids are counted from 1")
    network.head["id_bits"] = widest


def _id_in_front(containers: Sequence[Sent]) -> int:
    """Return the bits of the discriminator if all messages begin with it as an id of
    equal size, else 0.
    """
    sizes = set()
    for kind in (TELEMETRY, TELECOMMAND):
        same_kind = [container for container in containers if container.kind == kind]
        discriminator = _discriminator(same_kind)
        for container in same_kind:
            is_id = (
                container.front is not None
                and discriminator is not None
                and container.front[0] == discriminator
            )
            sizes.add(
                container.front[1] if is_id and container.front is not None else 0
            )
    size, *further_sizes = sizes or {0}
    return 0 if further_sizes else size


def _discriminator(containers: list[Sent]) -> Hashable | None:
    """Return the key of the discriminator: a constant in each message, with the most
    different values.

    None without one.
    """
    common = [
        key
        for key in (containers[0].constants if containers else ())
        if all(key in container.constants for container in containers)
    ]
    end = 1 << _MOST_ID_BITS
    fits = [
        key
        for key in common
        if all(0 <= container.constants[key] < end for container in containers)
    ]
    return max(
        fits,
        key=lambda key: len({container.constants[key] for container in containers}),
        default=None,
    )
