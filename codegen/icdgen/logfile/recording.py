"""Recordings: files with the received bytes of a link whose messages have header and
trailer.

`Recording` decodes the file with the stream decoder of the runtime and yields the
messages; `Tally` counts them and everything that is not a message.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path

from icdgen_runtime.wire.packet_formats import Direction, Stream
from icdgen_runtime.wire.stream import StreamDecoder, StreamEvent

from icdgen import codec
from icdgen.errors import UserError, unreadable
from icdgen.frozen import NamedTuple
from icdgen.icd.model import Icd, Message, Node
from icdgen.icd.variants import ids_of
from icdgen.link.line_statistics import FAULTS
from icdgen.logfile.rows import Done
from icdgen.protocol.packet_formats import DATAGRAM
from icdgen.runtime_objects.links import link_of_node

_PIECE = 1 << 18  # bytes of a read
_MOST_IDS = 64  # unknown ids with a counter of their own
_MOST_LISTED = 8  # unknown ids in a note

Unpacked = tuple[bytes, frozenset[str] | None, Mapping[str, int]]
Key = tuple[str, str]  # node that declares a message, and its name


class ReceivedMessage(NamedTuple):
    """A received message, with the frame fields that its sender chose.

    ``data`` has each byte at its position in the longest frame of the message; absent
    bytes are 0. ``present`` are the names of the fields present, or None for all.
    ``ends`` has the offset in ``data`` of the first byte after each variable-length
    field.
    """

    message: Message
    data: bytes
    values: Mapping[str, int]
    present: frozenset[str] | None
    ends: Mapping[str, int]


@dataclass(slots=True)
class Tally:
    """Numbers of messages, their bytes by `key`, numbers of other valid packets, and
    numbers of errors.
    """

    messages: Counter[Key] = field(default_factory=Counter)
    sizes: Counter[Key] = field(default_factory=Counter)
    # Events of ids that the ICD does not have; `has_more_unknown` if not all such ids
    # have a counter.
    unknown: Counter[int] = field(default_factory=Counter)
    has_more_unknown: bool = False
    faults: Counter[str] = field(default_factory=Counter)  # by description
    requests: int = 0  # valid packets that request telemetry
    packets: int = 0  # valid packets of formats without a message
    missing: int = 0  # messages, by the gaps in their sequence numbers
    repeated: int = 0  # events with the sequence number of the previous message
    lost: int = 0  # bytes that belong to no message
    cut: int = 0  # bytes at the end of the file that may begin a message

    def fault(self, event: StreamEvent) -> None:
        """Count an event that is not a message."""
        if event.event == "gap":
            self.missing += event.missing
            self.repeated += event.missing == 0
            return
        if event.event == "request":
            self.requests += 1
            return
        if event.event == "packet":
            self.packets += 1
            return
        if event.event == "unknown_id" and event.id is not None:
            # Noise can have any id, so the number of counters is limited.
            if event.id in self.unknown or len(self.unknown) < _MOST_IDS:
                self.unknown[event.id] += 1
            else:
                self.has_more_unknown = True
            return
        self.faults[FAULTS.get(event.event, event.event)] += 1

    def notes(self) -> list[str]:
        """Return the errors as notes for a report."""
        listed = [f"{what} ({times:,})" for what, times in sorted(self.faults.items())]
        notes = [f"not taken: {', '.join(listed)}"] if listed else []
        if self.unknown:
            listed = [
                f"{id} ({times:,})"
                for id, times in self.unknown.most_common(_MOST_LISTED)
            ]
            note = f"ids that the ICD does not have: {', '.join(listed)}"
            remaining = len(self.unknown) - len(listed)
            if self.has_more_unknown:
                note += f" and at least {remaining + 1} others"
            elif remaining:
                note += f" and {remaining} others"
            notes.append(note)
        counts = {
            "requests of telemetry": self.requests,
            "packets without a message": self.packets,
            "messages missing, by their sequence numbers": self.missing,
            "messages that came again, by their sequence numbers": self.repeated,
            "bytes that belong to no message": self.lost,
            "bytes at the end that belong to no whole message": self.cut,
        }
        return notes + [f"{what}: {count:,}" for what, count in counts.items() if count]


class Recording:
    """A recording of one direction. ``chosen`` selects messages; empty for all.

    Raise `icdgen.errors.UserError`.
    """

    def __init__(
        self,
        icd: Icd,
        node: Node,
        path: Path,
        direction: Direction = "telemetry",
        chosen: Sequence[Message] = (),
    ) -> None:
        self.icd, self.node, self.path, self.direction = icd, node, path, direction
        self.link = link_of_node(icd, node)
        self._messages_by_id: dict[int, list[Message]] = {}
        self.messages: dict[Key, Message] = {}
        for id, variants in getattr(ids_of(icd, node), direction).items():
            messages = [variant.message for variant in variants]
            self._messages_by_id[id] = messages
            self.messages |= {key(message): message for message in messages}
        # Most messages, which then need no pass of the slow reference codec.
        self._with_fixed_fields = {
            name
            for name, message in self.messages.items()
            if _has_fixed_fields(message)
        }
        self.chosen = {key(message) for message in chosen} or set(self.messages)
        if unknown := self.chosen - set(self.messages):
            names = ", ".join(sorted(name for _, name in unknown))
            help = "`--direction` says who sent what was recorded"
            raise UserError(f"{names} is no {direction} of {node.name}", help)
        if self.form.delimited_by == DATAGRAM:
            what = f"a message of {node.name} ends with the packet that carries it, which a file does not tell"
            raise UserError(what, "`icdgen decode` takes packets, one by one")
        try:
            self.size = path.stat().st_size
            if path.is_dir():
                raise UserError(f"{path} is a folder", "name a file")
        except OSError as error:
            raise unreadable(path, error) from None

    @property
    def form(self) -> Stream:
        """Frame format of the link."""
        assert self.link.stream is not None
        return self.link.stream

    def received_messages(
        self, tally: Tally, head: int | None, done: Done
    ) -> Iterator[ReceivedMessage]:
        """Iterate over the chosen messages: the first ``head`` of them, or all if it is
        None.

        Count all events in ``tally``, also those of messages that are not chosen.

        Raise `icdgen.errors.UserError`.
        """
        decoder, count = StreamDecoder(self.link, self.direction), 0
        for piece in self._pieces() if head != 0 else ():
            # Only `head` can end the iteration within a piece.
            before = decoder if head is None else deepcopy(decoder)
            events = decoder.feed(piece)
            for number, event in enumerate(events, 1):
                received = self._received(event, tally)
                if received is None:
                    continue
                count += 1
                if count == head:
                    # The decoder has already discarded bytes after this message.
                    tally.lost = before.discarded
                    if decoder.discarded > before.discarded:
                        tally.lost = _discarded_before_event(before, piece, number)
                yield received
                if count == head:
                    return
            # The decoder counts over all pieces.
            tally.lost = decoder.discarded
            done(len(piece))
        tally.cut = decoder.pending

    def survey(self, head: int | None, done: Done) -> Tally:
        """Count the events up to the chosen message number ``head``, or of the complete
        file if ``head`` is None.

        ``done`` receives the number of bytes of each processed piece of the file.

        Raise `icdgen.errors.UserError`, also if there is no message.
        """
        tally = Tally()
        for _ in self.received_messages(tally, head, done):
            pass
        if self.size and head != 0 and not tally.messages:
            why = "; ".join(tally.notes())
            raise UserError(
                f"{self.path} holds no {self.direction} of {self.node.name}: {why}",
                "name a file with the bytes as they came over the line, or the node, or the `--direction`",
            )
        return tally

    def _received(self, event: StreamEvent, tally: Tally) -> ReceivedMessage | None:
        if event.event != "message" or event.id is None:
            tally.fault(event)
            return None
        # The decoder reports other ids as `unknown_id`.
        messages = self._messages_by_id[event.id]
        message: Message | None = messages[0]
        if len(messages) > 1:
            message = codec.message_of_frame_if_any(self.icd, messages, event.data)
        unpacked: Unpacked = (event.data, None, {})
        try:
            if message is not None and key(message) not in self._with_fixed_fields:
                unpacked = _unpacked(self.icd.node(message.node), message, event.data)
        except codec.LengthError:
            message = None
        if message is None:
            tally.fault(StreamEvent("length", event.id))
            return None
        tally.messages[key(message)] += 1
        tally.sizes[key(message)] += len(event.data)
        if key(message) not in self.chosen:
            return None
        data, present, ends = unpacked
        return ReceivedMessage(
            message, data.ljust(message.length, b"\0"), event.values, present, ends
        )

    def _pieces(self) -> Iterator[bytes]:
        try:
            with self.path.open("rb") as file:
                while piece := file.read(_PIECE):
                    yield piece
        except OSError as error:
            raise unreadable(self.path, error) from None


def key(message: Message) -> Key:
    """Return the node that declares a message, and its name.

    They are unique for a node.
    """
    return message.node, message.name


def _discarded_before_event(decoder: StreamDecoder, piece: bytes, number: int) -> int:
    """Return how many bytes a decoder discards until an event.

    The event is the one with this number, from 1, of those that the decoder returns for
    ``piece``. The decoder does not report positions of events, so that the shortest
    piece that gives the event is searched by halving.
    """
    while len(piece) > 1:
        half = len(piece) // 2
        trial = deepcopy(decoder)
        events = len(trial.feed(piece[:half]))
        if events >= number:
            piece = piece[:half]
        else:
            decoder, piece, number = trial, piece[half:], number - events
    decoder = deepcopy(decoder)
    decoder.feed(piece)
    return decoder.discarded


def _has_fixed_fields(message: Message) -> bool:
    """Return whether all frames of a message have the same fields at the same
    positions.
    """
    return not message.layout.parts and not any(
        node.present_if for node in message.layout.nodes
    )


def _unpacked(node: Node, message: Message, data: bytes) -> Unpacked:
    """Return ``data``, ``present`` and ``ends`` of a message.

    Raise `icdgen.codec.LengthError` if the length of the data is invalid.
    """
    raw = codec.decode_frame(node, message, data)
    layout, sizes = message.layout, codec.sizes_from_counters(message, raw)
    ends = {
        part.name: part.begin + sizes[part.name] * part.step for part in layout.parts
    }
    return layout.in_longest(data, sizes), frozenset(raw), ends
