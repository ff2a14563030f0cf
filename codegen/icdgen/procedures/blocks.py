"""Procedures with blocks in the device: it sends the blocks of an object, or receives
them.

A block is a part of an object that is transferred in packets; a map of packets tells
which of them were received. `BlockReading` sends an object, `BlockWriting` stores it.
"""

from __future__ import annotations

from collections.abc import Iterator

from icdgen.frozen import NamedTuple
from icdgen.icd.model import Message
from icdgen.procedures.flow import leads_to_packets, sends_packets
from icdgen.procedures.numbers import (
    empty_map,
    is_received,
    mark_received,
    put_number,
)
from icdgen.procedures.run import Change, ProcedureRun, is_of, steps_of
from icdgen.protocol.procedures import (
    BLOCK_IS_EMPTY,
    BLOCK_LENGTH,
    BLOCK_OFFSET,
    PACKET_NUMBER,
    PACKET_OFFSET,
    Blocks,
    Jump,
    Receive,
    Send,
    SetLength,
    VerifyChecksum,
)

LARGEST = 1 << 24  # bytes of an object: a large offset must not exhaust the memory


class BlockPacket(NamedTuple):
    """Telemetry with a packet of a block."""

    message: Message
    data: bytes


class BlockRun(ProcedureRun):
    """State of a procedure with blocks."""

    def prepare(self) -> None:
        procedure = self.procedure
        assert procedure.blocks
        self.blocks: Blocks = procedure.blocks
        self.map = empty_map(self.blocks.map) if self.blocks.map else bytearray()
        # The jump back to `NextBlock` ends the steps of a block.
        end = procedure.steps.index(Jump(self.blocks.begin - 1))
        self.inside = [i for i in self.sends if self.blocks.begin <= i < end]
        # Telecommands after which the packets come.
        self.starts = {
            i
            for i in self.inside
            if not sends_packets(procedure, i) and leads_to_packets(procedure, i)
        }

    def map_message(self, message: Message, data: bytes) -> None:
        for at, part in self._parts(message):
            self.map[at] = data[part]

    def _parts(self, message: Message) -> Iterator[tuple[slice, slice]]:
        """Yield the range of the map that a message has, and its range in it."""
        form = self.blocks.map
        if form is None:
            return
        for number, each in enumerate(form.messages):
            if each.name == message.name:
                at = number * form.bytes
                yield slice(at, at + form.bytes), slice(form.at, form.at + form.bytes)

    @property
    def filler(self) -> bytes:
        """Byte after the end of a block in its last packet."""
        filler = self.device.filler
        return bytes((self.blocks.fill if filler is None else filler,))

    def covered(self) -> bytes:
        """Return the block that a checksum covers, with its fill."""
        raise NotImplementedError

    def length_of(self, data: bytes) -> int:
        """Return the length of the block without its fill."""
        raise NotImplementedError

    def number(self, register: int, is_busy: bool) -> int | None:
        for verify in steps_of(self.procedure, VerifyChecksum):
            if is_of(verify.value, register):
                return 0 if is_busy else self._checksum(verify)
        return None

    def _checksum(self, step: VerifyChecksum) -> int:
        if step.of_block:
            data = self.covered()
            if not step.covers_fill:
                data = data[: self.length_of(data)]
        else:
            data = self.device.objects.content_of(self.effect.kind, self.key) or b""
        return self.device.checksum(step.algorithm, data)


class BlockReading(BlockRun):
    """The client reads an object in blocks."""

    def prepare(self) -> None:
        super().prepare()
        self.receive = steps_of(self.procedure, Receive)[0]
        self.block = b""
        self.waiting: list[int] = []  # positions of packets that are to be sent
        self._last: int | None = None  # position of the last requested packet
        # The telecommand with offset or length loads the block; without one, the first
        # of the loop.
        about_block = {BLOCK_OFFSET, BLOCK_LENGTH}
        loads = [i for i in self.inside if self.given(i) & about_block]
        self._load_step = next(iter(loads or self.inside), None)

    def execute(self, index: int, data: bytes) -> None:
        if index == self._load_step:
            self._load()
        if index in self.starts:
            self.waiting, self._last = list(self._missing()), None

    def requested(self) -> BlockPacket:
        """Return the next packet; after the last packet, it is repeated."""
        if self.waiting:
            self._last = self.waiting.pop(0)
        return self.packet(self._last)

    def packet(self, position: int | None) -> BlockPacket:
        """Return the packet at a position; None: only fill."""
        size, message = self.blocks.packet_bytes, self.receive.message
        frame, at = bytearray(message.length), self.receive.data_at
        part = b""
        if position is not None:
            part = self.block[position * size : (position + 1) * size]
            number = self.blocks.first_packet + position
            put_number(self.receive.number, frame, number)
        frame[at : at + size] = part.ljust(size, self.filler)
        return BlockPacket(message, bytes(frame))

    def covered(self) -> bytes:
        return self.block.ljust(self._count * self.blocks.packet_bytes, self.filler)

    def length_of(self, data: bytes) -> int:
        return len(self.block)

    def number(self, register: int, is_busy: bool) -> int | None:
        if any(is_of(s.value, register) for s in steps_of(self.procedure, SetLength)):
            return 0 if is_busy else len(self.block)
        return super().number(register, is_busy)

    def _load(self) -> None:
        content = self.device.objects.content_of(self.effect.kind, self.key)
        offset = self.registers.get(BLOCK_OFFSET, 0)
        length = self.registers.get(BLOCK_LENGTH, self.blocks.size)
        self.block, self.waiting, self._last = b"", [], None
        if self.blocks.map:
            self.map = empty_map(self.blocks.map)
        # The device cannot read behind the end of the object, or more than its buffer.
        self.failed = True
        if (
            content is not None
            and offset <= len(content)
            and length <= self.blocks.size
        ):
            self.failed = False
            self.block = content[offset : offset + length]

    @property
    def _count(self) -> int:
        """Number of packets of the block."""
        return -(-len(self.block) // self.blocks.packet_bytes)

    def _missing(self) -> Iterator[int]:
        """Yield the positions of the packets that the client lacks."""
        form, is_empty = self.blocks.map, self.registers.get(BLOCK_IS_EMPTY) == 1
        for position in range(self._count):
            if is_empty or not form or not is_received(form, self.map, position):
                yield position


class BlockWriting(BlockRun):
    """The client writes an object in blocks."""

    def prepare(self) -> None:
        super().prepare()
        self.received: dict[int, bytes] = {}  # packets of the block by their offset
        self._is_complete = False  # the next packet begins another block
        self._map_from = 0  # number of the last telecommand that changed the map
        packets = [i for i in self.inside if sends_packets(self.procedure, i)]
        later = [i for i in self.inside if i > max(packets)]
        # Without a telecommand that commits the block, each packet is stored at once.
        self._commit_step = later[-1] if later else None
        # Registers that telecommands without a packet give to the device.
        self._block_numbers: set[int] = set()
        for index in self.sends:
            if index not in packets:
                self._block_numbers |= self.given(index)

    def execute(self, index: int, data: bytes) -> None:
        step = self.step(index)
        if index < self.blocks.begin:
            self.device.objects.put(self.effect.kind, self.key, b"")
            self._begin()
        elif index in self.starts and index != self._commit_step:
            self._begin()
        elif step.packet_at is not None:
            if self._is_complete:
                self._begin()
            self._take(step, data[step.packet_at :][: self.blocks.packet_bytes])
        elif index == self._commit_step:
            self._commit()
        elif self._commit_step is None and index not in self.inside:
            self.device.objects.report(self.effect.kind, self.key)

    def changes(self, now: int, message: Message) -> Iterator[tuple[int, Change]]:
        yield from super().changes(now, message)
        for at, part in self._parts(message):
            if self._map_from:
                octets = bytes(self.map[at])
                yield self._map_from, _replacing(part, octets)

    def map_message(self, message: Message, data: bytes) -> None:
        for at, part in self._parts(message):
            self.map[at], self._map_from = data[part], 0

    def covered(self) -> bytes:
        size = self.blocks.packet_bytes
        begin = self._begin_of_block
        if begin is None:
            begin = min(self.received, default=0)
        offsets = range(begin, max(self.received, default=begin - size) + 1, size)
        empty = self.filler * size
        return b"".join(self.received.get(offset, empty) for offset in offsets)

    @property
    def _begin_of_block(self) -> int | None:
        """Offset of the first packet of the block; None if no telecommand has it."""
        if PACKET_OFFSET not in self.registers:
            return 0
        if BLOCK_OFFSET in self._block_numbers:
            return self.registers.get(BLOCK_OFFSET)
        return None

    def length_of(self, data: bytes) -> int:
        if BLOCK_LENGTH not in self._block_numbers:
            return len(data)
        return self.registers.get(BLOCK_LENGTH, len(data))

    def number(self, register: int, is_busy: bool) -> int | None:
        number = super().number(register, is_busy)
        # If no telecommand begins a block, the next packet does.
        self._is_complete |= number is not None and not self.starts
        return number

    def _begin(self) -> None:
        self.received, self.failed, self._is_complete = {}, False, False
        if self.blocks.map:
            self.map = empty_map(self.blocks.map)
            self._map_from = self.device.telecommands

    def _take(self, step: Send, data: bytes) -> None:
        """Take a packet of a block."""
        size = self.blocks.packet_bytes
        if PACKET_OFFSET in self.registers:
            offset = self.registers[PACKET_OFFSET]
            position = (offset - (self._begin_of_block or 0)) // size
        else:
            number = self.registers.get(PACKET_NUMBER, 0)
            position = number - self.blocks.first_packet
            offset = position * size
        # A damaged number must not exhaust the memory.
        if not 0 <= offset < LARGEST:
            return
        self.received[offset] = data
        if self.blocks.map and position >= 0:
            mark_received(self.blocks.map, self.map, position)
            self._map_from = self.device.telecommands
        if self._commit_step is None:
            data = self._cut(offset - (self._begin_of_block or 0), data)
            if PACKET_OFFSET not in self.registers:
                offset += self.registers.get(BLOCK_OFFSET, 0)
            self.failed = not self._store(offset, data)

    def _cut(self, offset: int, data: bytes) -> bytes:
        """Return a packet without the fill behind the end of the block.

        Return the whole packet if telecommands do not have the offset and length of the
        block: the device then cannot detect the fill. ``offset``: offset of the packet
        in the block.
        """
        if {BLOCK_OFFSET, BLOCK_LENGTH} <= self._block_numbers:
            return data[: max(0, self.registers.get(BLOCK_LENGTH, 0) - offset)]
        return data

    def _commit(self) -> None:
        data = self.covered()
        length, offset = self.length_of(data), self.registers.get(BLOCK_OFFSET, 0)
        self.failed = length > len(data) or not self._store(offset, data[:length])
        # Without a telecommand that begins a block, the next packet begins one.
        self._is_complete = not self.starts - {self._commit_step}
        if not self.failed:
            self.device.objects.report(self.effect.kind, self.key)

    def _store(self, offset: int, data: bytes) -> bool:
        """Store bytes of the object. Return whether there is room for them."""
        if offset + len(data) > min(self.blocks.most, LARGEST):
            return False
        self.device.objects.patch(self.effect.kind, self.key, offset, data)
        return True


def _replacing(part: slice, octets: bytes) -> Change:
    """Return the change of a frame that replaces a part of it."""
    return lambda data: data[: part.start] + octets + data[part.stop :]
