"""Runs inputs on the stream decoders of a generated package.

It does not need atheris. See README.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from types import ModuleType

STEPS = 400  # of a procedure


class Streams:
    """Feeds inputs to all classes of a generated package that accept a stream.

    Raises every exception that they should not have raised.
    """

    def __init__(self, package: ModuleType) -> None:
        self.package = package
        nodes = [getattr(package, name) for name in package.NODES]
        self.links = [node.LINK for node in nodes if hasattr(node, "LINK")]
        self.wire = package.wire
        clients = (self.client_uart, self.client_can, self.client_i2c)
        self.parts = (
            self.uart,
            self.can,
            self.log,
            *clients,
            self.procedure,
            self.framed_links,
        )

    def run(self, data: bytes) -> None:
        """Run one input: part, node, and the size of pieces, one byte each; then the
        stream.
        """
        if len(data) < 3:
            return
        part = self.parts[data[0] % len(self.parts)]
        try:
            part(self.links[data[1] % len(self.links)], data[2], data[3:])
        except self.wire.UnsupportedError:
            return

    def uart(self, link, size: int, data: bytes) -> None:
        limit = link.longest if size & 1 else 1 + size % link.longest
        uncut, cut = (self.wire.UartDecoder(link, limit) for _ in range(2))
        events, events_of_pieces = uncut.feed(data), []
        for piece in pieces(data, size):
            events_of_pieces += cut.feed(piece)
            assert len(cut._buffer) <= limit
        assert events == events_of_pieces
        assert (uncut.discarded, uncut.pending) == (cut.discarded, cut.pending)
        messages = [event.message for event in events if event.event == "message"]
        on_line = sum(len(self.wire.uart_encode(link, message)) for message in messages)
        # An escape byte that the ICD has skipped stands in no message.
        assert (
            uncut.discarded + uncut.pending + on_line == len(data)
            or link.framing.ignores_other
        )
        for message in messages:
            self.wire.uart_kind(link, message)

    def framed_links(self, link, size: int, data: bytes) -> None:
        """The lowest bit of ``size`` is the direction."""
        direction = "telemetry" if size & 1 else "telecommand"
        uncut, cut = (self.wire.StreamDecoder(link, direction) for _ in range(2))
        events = uncut.feed(data)
        assert uncut.discarded + uncut.pending <= len(data)
        if link.stream.delimited_by != "none":
            assert events == [
                event for piece in pieces(data, size) for event in cut.feed(piece)
            ]
            assert (uncut.discarded, uncut.pending) == (cut.discarded, cut.pending)
        for event in (event for event in events if event.event == "message"):
            sent = self.wire.stream_encode(
                link, event.id, event.data, direction, **event.values
            )
            (repeated,) = self.wire.StreamDecoder(link, direction).feed(sent)
            assert (repeated.event, repeated.id, repeated.values) == (
                "message",
                event.id,
                event.values,
            )
            assert repeated.data.rstrip(b"\0") == event.data.rstrip(b"\0")

    def packets(self, data: bytes) -> Iterator[tuple[int, object]]:
        """Yield packets that mostly belong together, with their times.

        Few of the 29 bits of the identifiers differ. Packets have up to 8 bytes.
        """
        now = 0
        while len(data) >= 3:
            head, id, size = data[0], data[1], data[2] % 9
            now += 0 if head & 0xC0 else 300
            number = (
                (head & 15) << 24 | id << 16 | (head >> 4 & 1) << 8 | (head >> 5 & 1)
            )
            yield now, self.wire.CanPacket(number, data[3 : 3 + size])
            data = data[3 + size :]

    def can(self, link, size: int, data: bytes) -> None:
        joiner = self.wire.CanJoiner(link, None, 1 + size % 4)
        for now, packet in self.packets(data):
            for event in joiner.feed(now, packet):
                if event.message:
                    assert len(event.message.data) <= max(8, link.longest_data + 8)
            assert len(joiner._open) <= 1 + size % 4
        joiner.expire(1 << 40)
        assert not joiner._open

    def log(self, link, size: int, data: bytes) -> None:
        uncut, cut = self.wire.LogReader(link), self.wire.LogReader(link)
        entries = uncut.feed(data)
        assert entries == [
            entry for piece in pieces(data, size) for entry in cut.feed(piece)
        ]
        assert (uncut.mask, uncut.truncated) == (cut.mask, cut.truncated)
        if uncut.mask is not None:
            writer = self.wire.LogWriter(link, uncut.mask)
            written = writer.header()
            for entry in entries:
                frames = [frame.data for frame in entry.frames]
                written += writer.entry(entry.seconds, entry.milliseconds, frames)
            assert len(written) == len(data) - uncut.truncated

    def client_uart(self, link, size: int, data: bytes) -> None:
        client, now, ends = self.client_with_request(link, "uart", size), 0, 0
        for piece in pieces(data, size):
            now += 40
            ends += self.ends(client.received(now, piece))
            client.output()
        self.idle(client, now, ends)

    def client_can(self, link, size: int, data: bytes) -> None:
        client, last, ends = self.client_with_request(link, "can", size), 0, 0
        for now, packet in self.packets(data):
            ends += self.ends(client.packet(now, packet))
            client.packets()
            last = now
        self.idle(client, last, ends)

    def client_i2c(self, link, size: int, data: bytes) -> None:
        client, now, ends = self.client_with_request(link, "i2c", size), 0, 0
        for piece in pieces(data, size):
            now += 7
            if client.transfers():
                ends += self.ends(client.transferred(now, piece))
            else:
                ends += self.ends(client.tick(now))
        self.idle(client, now, ends)

    def client_with_request(self, link, bus: str, pick: int):
        """Return a client with a request that has not ended."""
        client = self.wire.Client(link, bus, crc=bool(pick & 2))
        kind, ids = (
            ("telecommand", link.commands) if pick & 4 else ("telemetry", link.frames)
        )
        id = [id for id in ids if kind == "telemetry" or ids[id].acknowledged][pick % 7]
        data = bytes(link.commands[id].length) if kind == "telecommand" else b""
        client.start(0, self.wire.Request(kind, id, data, bool(pick & 8)))
        client.output()
        client.packets()
        return client

    def ends(self, events) -> int:
        ends = (self.wire.Done, self.wire.Sent, self.wire.Refused, self.wire.Timeout)
        for event in events:
            if isinstance(event, self.wire.Done):
                _ = event.message
        return sum(isinstance(event, ends) for event in events)

    def idle(self, client, now: float, ends: int) -> None:
        """Check that the request ends exactly once."""
        for _ in range(1000):
            client.output()
            client.packets()
            is_transferring = bool(client.transfers())
            if not client.busy:
                break
            now = max(now, client.deadline)
            ends += self.ends(
                client.transferred(now, None) if is_transferring else client.tick(now)
            )
        assert not client.busy and ends == 1

    def procedure(self, link, size: int, data: bytes) -> None:
        """Run a procedure with outcomes and packets of any kind.

        It must end, or deliver the data that it received.
        """
        if not link.procedures:
            return
        events = iter(data)
        name = sorted(link.procedures)[size % len(link.procedures)]
        form = link.procedures[name]
        inputs = {
            each.name: min(next(events, 0), each.most)
            for each in form.inputs
            if not each.is_bytes and not each.values and not each.is_optional
        }
        inputs |= {each.name: each.values[0] for each in form.inputs if each.values}
        procedure = self.wire.Procedure(link, name, inputs, data[:64])
        procedure.bus = ("uart", "i2c", "can")[size % 3]
        now = 0
        for _ in range(STEPS):
            request = procedure.next(now)
            if procedure.result:
                break
            code = next(events, 0)
            now += code * 8
            if request is None:
                now = max(now, procedure.deadline or 0)
                for id in procedure._receives:
                    piece = bytes(next(events, 0) for _ in range(link.frames[id]))
                    procedure.event(now, self.wire.Arrived(id, piece, {}))
            elif code & 15 < 3:
                outcomes = (self.wire.Refused, self.wire.Timeout, self.wire.Busy)
                procedure.event(now, outcomes[code & 15](request.id, 1))
            else:
                is_telemetry = request.kind == "telemetry"
                length = link.frames.get(request.id, 0) if is_telemetry else 0
                frame = bytes(next(events, 0) for _ in range(length))
                procedure.event(now, self.wire.Done(request.id, 1, frame))
        if form.blocks and not form.blocks.sends:
            assert len(procedure.data) == procedure.progress[0]


def pieces(data: bytes, size: int) -> list[bytes]:
    """Return the stream in pieces of 1 to 256 bytes."""
    return [data[at : at + size + 1] for at in range(0, len(data), size + 1)]
