"""What a frame turned out to be."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

from icdgen_runtime.wire.link import Link

from icdgen.icd import wire_ids
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.node_cache import cached_by_node
from icdgen.icd.variants import Ids, ids_of
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects.links import link_of
from icdgen.values.find import KINDS, describe
from icdgen.values.frame import Frame

TELECOMMAND, TELEMETRY, REQUEST, ACKNOWLEDGE, REFUSAL = "telecommand", "telemetry", "request", "acknowledge", "refusal"


@dataclass(frozen=True)
class Speaker:
    """A node of a set, and how it talks."""

    icd: Icd = field(repr=False, compare=False)
    node: Node
    facts: Facts

    @cached_property
    def link(self) -> Link:
        """What the wire layer has to know of it."""
        return link_of(self.icd, self.facts)

    @cached_property
    def ids(self) -> Ids:
        """The messages that it speaks, by their ids."""
        return ids_of(self.icd, self.node)

    def taken_apart(self, body: bytes) -> tuple[int, bytes] | None:
        """The id that bytes begin with, and the rest; None if there are too few."""
        size = wire_ids.size(self.node.id_bits)
        return (wire_ids.number(body[:size]), body[size:]) if len(body) >= size else None


@cached_by_node
def speaker_of(icd: Icd, node: Node) -> Speaker:
    """That node of the set."""
    return Speaker(icd, node, facts.of(icd, node))


def all_speakers(icd: Icd) -> list[Speaker]:
    """Every node of the set."""
    return [speaker_of(icd, node) for node in icd.nodes]


@dataclass(frozen=True, slots=True)
class Reading:
    """What a frame is. ``what``: telecommand, telemetry, or a message about ``message``: request, acknowledge, refusal;
    configuration, where a configuration message came without an id, which would tell its direction.

    ``id`` is the one that the frame was sent with, None where it came without. ``data`` are the bytes of ``frame``,
    without id, framing and checksum. ``error`` is the code of an acknowledge. ``checked``: a checksum was there, and right.
    """

    speaker: Speaker
    what: str
    message: Message
    id: int | None = None
    data: bytes = b""
    frame: Frame | None = None
    error: int | None = None
    checked: bool = False
    remarks: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()  # of the first reading of an input: its packets that cannot be decoded, and why
    time: str = ""  # when the frame was received, as the tool that recorded it printed that

    @property
    def key(self) -> tuple[str, str, str]:
        """Readings of the same key say the same."""
        return self.what, self.message.node, self.message.name

    @property
    def is_own(self) -> bool:
        """Whether it is of the node that declares the message."""
        return self.speaker.node.name == self.message.node

    @property
    def title(self) -> str:
        """``request for Attitude (telemetry 146)``, for people."""
        told = (
            f"`{self.message.name}` ({describe(self.message, self.speaker.facts.stream)}) of {self.speaker.node.name}"
        )
        if self.what in KINDS:
            return told
        if self.error is None:
            return f"{self.what} {'for' if self.what == REQUEST else 'of'} {told}"
        named = [key.replace("_", " ") for key, code in self.speaker.facts.errors.items() if code == self.error]
        return f"{self.what} of {told}: error {self.error}" + (f" ({named[0]})" if named else "")

    @property
    def has_wrong_constant(self) -> bool:
        """Whether a field that has a constant holds something else."""
        return self.frame is not None and bool(self.frame.wrong_constants)

    def noted(self, *remarks: str) -> Reading:
        """The same, with further remarks."""
        shown = None if self.frame is None else replace(self.frame, remarks=(*self.frame.remarks, *remarks))
        return replace(self, frame=shown, remarks=(*self.remarks, *remarks))

    def without(self, *left_out: str) -> Reading:
        """The same, with reports about other packets of the input, which cannot be decoded."""
        notes = [f"left out: {one}" for one in left_out]
        return replace(self.noted(*notes), left_out=(*self.left_out, *left_out))

    def to_json(self) -> dict[str, object]:
        """The frame as `Frame.to_json` has it, with ``direction``; what has no data of its own as a short form of it."""
        time: dict[str, object] = {"time": self.time} if self.time else {}
        if self.frame is not None:
            return {**self.frame.to_json(), "direction": self.what, **time}
        found: dict[str, object] = {
            "node": self.speaker.node.name,
            "message": self.message.name,
            "direction": self.what,
        }
        found |= {"id": self.id} | ({} if self.error is None else {"error": self.error}) | time
        return found | ({"remarks": list(self.remarks)} if self.remarks else {})
