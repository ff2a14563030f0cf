"""Results of the recognition: a message, its direction and its node.

`FrameReading` is the result that all modules of the package return; `Endpoint` is a
node with its protocol, to which they apply.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

from icdgen_runtime.wire.link import Link

from icdgen.icd import wire_ids
from icdgen.icd.buses import UART
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.node_cache import cached_by_node
from icdgen.icd.variants import Ids, ids_of
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.links import link_of, responses_on
from icdgen.values.find import KINDS, kind_and_ids
from icdgen.values.frame import DecodedFrame

TELECOMMAND, TELEMETRY, REQUEST, ACKNOWLEDGE, REFUSAL = (
    "telecommand",
    "telemetry",
    "request",
    "acknowledge",
    "refusal",
)


@dataclass(frozen=True)
class Endpoint:
    """A node of an ICD set, and its protocol."""

    icd: Icd = field(repr=False, compare=False)
    node: Node
    facts: Facts

    @cached_property
    def link(self) -> Link:
        """Protocol of the node, for the wire layer."""
        return link_of(self.icd, self.facts)

    @cached_property
    def ids(self) -> Ids:
        """Messages of the node by their ids."""
        return ids_of(self.icd, self.node)

    def split_id(self, body: bytes) -> tuple[int, bytes] | None:
        """Split bytes into the id and the bytes after it.

        Return None if there are too few.
        """
        size = wire_ids.size(self.node.id_bits)
        if len(body) < size:
            return None
        return wire_ids.number(body[:size]), body[size:]


@cached_by_node
def endpoint_of(icd: Icd, node: Node) -> Endpoint:
    """Return the node with its protocol."""
    return Endpoint(icd, node, facts.of(icd, node))


def all_endpoints(icd: Icd) -> list[Endpoint]:
    """Return all nodes of the set with their protocols."""
    return [endpoint_of(icd, node) for node in icd.nodes]


@dataclass(frozen=True, slots=True)
class FrameReading:
    """An interpretation of a frame.

    ``what`` is ``telecommand`` or ``telemetry``, or ``request``, ``acknowledge`` or
    ``refusal`` of ``message``. It is ``configuration`` for a configuration message
    without an id, whose direction is unknown.

    ``id`` is the transmitted id, or None. ``data`` are the bytes of ``frame``, without
    id, framing and checksum. ``error`` is the code of an acknowledge. ``checked``:
    there was a checksum, and it was right.
    """

    endpoint: Endpoint
    what: str
    message: Message
    id: int | None = None
    data: bytes = b""
    frame: DecodedFrame | None = None
    error: int | None = None
    checked: bool = False
    remarks: tuple[str, ...] = ()
    # Packets of the input that cannot be decoded, with reason. Only the first reading
    # has them.
    left_out: tuple[str, ...] = ()
    time: str = ""  # time of reception, as printed by the recording tool

    @property
    def key(self) -> tuple[str, str, str]:
        """Direction, node and message, which are equal for equivalent readings."""
        return self.what, self.message.node, self.message.name

    @property
    def is_own(self) -> bool:
        """Whether the node declares the message, instead of including it."""
        return self.endpoint.node.name == self.message.node

    @property
    def title(self) -> str:
        """Description for a report, such as ``request for Attitude (telemetry 146)``."""
        endpoint = self.endpoint
        description = kind_and_ids(self.message, endpoint.facts.stream)
        described = f"`{self.message.name}` ({description}) of {endpoint.node.name}"
        if self.what in KINDS:
            return described
        text = f"{self.what} {'for' if self.what == REQUEST else 'of'} {described}"
        if self.error is None:
            return text
        responses = responses_on(endpoint.link, UART)
        names = {code: name for each in responses for code, name in each.reasons}
        name = f" ({names[self.error]})" if self.error in names else ""
        return f"{text}: error {self.error}{name}"

    @property
    def has_wrong_constant(self) -> bool:
        """Whether a field with a constant has another value."""
        return self.frame is not None and bool(self.frame.wrong_constants)

    def with_remarks(self, *remarks: str) -> FrameReading:
        """Return a copy with further remarks."""
        frame = self.frame
        if frame is not None:
            frame = replace(frame, remarks=(*frame.remarks, *remarks))
        return replace(self, frame=frame, remarks=(*self.remarks, *remarks))

    def with_left_out(self, *left_out: str) -> FrameReading:
        """Return a copy with reports about packets of the input that cannot be decoded."""
        notes = [f"left out: {report}" for report in left_out]
        return replace(self.with_remarks(*notes), left_out=(*self.left_out, *left_out))

    def to_json(self) -> dict[str, object]:
        """Return the frame as `Frame.to_json` does, with ``direction``.

        A message without data has a short form.
        """
        time: dict[str, object] = {"time": self.time} if self.time else {}
        if self.frame is not None:
            return {**self.frame.to_json(), "direction": self.what, **time}
        values: dict[str, object] = {
            "node": self.endpoint.node.name,
            "message": self.message.name,
            "direction": self.what,
        }
        values["id"] = self.id
        if self.error is not None:
            values["error"] = self.error
        values |= time
        if self.remarks:
            values["remarks"] = list(self.remarks)
        return values
