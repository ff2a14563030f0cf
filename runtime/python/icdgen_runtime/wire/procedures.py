"""Engine of procedures: it runs the steps of the ICD, above any client.

A `Procedure` takes the events of a client and returns the next request, as `next` and
`event` say. It has no clock and no port. The steps, such as `Send` and `Poll`, are data
of the link; `procedure_forms` defines them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Optional

from .._base import Message
from .._errors import RangeError
from .awaited import Request
from .checks import checksum
from .errors import TooLongError, UnsupportedError, need
from .events import Arrived, Busy, Done, Event, Outcome, Refused, Reply, Sent, Timeout
from .link import Bus, Link
from .procedure_forms import (
    BLOCK_IS_EMPTY,
    BLOCK_LENGTH,
    BLOCK_OFFSET,
    FIRST_INPUT,
    PACKET_NUMBER,
    PACKET_OFFSET,
    UNKNOWN,
    Blocks,
    Collect,
    EndIfZeros,
    Get,
    GetMap,
    Input,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    PacketDone,
    PacketMap,
    Poll,
    Receive,
    Send,
    SendMap,
    SetLength,
    SkipUnless,
    Take,
    Verify,
    VerifyChecksum,
)

Result = Literal[
    "done",
    "refused",
    "busy",
    "timeout",
    "failed",
    "length",
    "checksum",
    "rounds",
    "limit",
]
"""How a procedure ends.

``failed``: the device reports an error. ``length``: a block does not have the requested
length. ``checksum`` and ``rounds``: the checksum of a block is wrong, or packets are
missing, after the largest number of rounds. ``limit``: the device exceeds a limit of the
ICD.
"""


class Procedure:
    """A procedure of a node, independent of clock and bus.

    `next` returns the request to start, `event` processes the events of the client. The
    first call of `next` starts the procedure. Call `next` after each event, and at
    `deadline`. Times are in milliseconds.

    ``inputs``: the numbers by their names in the ICD. An optional input can be None.
    ``data``: the bytes to send. ``block``: bytes of a block, at most the number in the
    ICD. Raise `RangeError`, `TooLongError` for too many bytes, and `UnsupportedError`
    for a procedure that the ICD does not describe.
    """

    def __init__(
        self,
        link: Link[Any],
        name: str,
        inputs: Optional[Mapping[str, Optional[int]]] = None,
        data: bytes = b"",
        block: Optional[int] = None,
    ) -> None:
        if name not in link.procedures:
            raise UnsupportedError(f"the ICD has no procedure `{name}`")
        form = link.procedures[name]
        self.link, self.form = link, form
        self.bus: Bus = "uart"
        """Bus of the client. Sessions set it."""
        self.result: Optional[Result] = None
        """None while it runs, then ``done`` or the reason of the failure."""
        self.blocks: list[tuple[int, bytes]] = []
        """Offset and data of each received block."""
        self.frames: list[bytes] = []
        """The telemetry of each entry."""
        self._input = b""
        self._registers = [0] * form.registers
        self._set_inputs(inputs or {}, bytes(data))
        if block is not None and block < 1:
            raise RangeError("block", f"1 to {need(form.blocks, 'blocks').size}", block)
        self.block_bytes = 0
        """Largest number of bytes of a block."""
        if form.blocks:
            self.block_bytes = min(block or form.blocks.size, form.blocks.size)
        self._receives = {
            step.telemetry: step for step in form.steps if isinstance(step, Receive)
        }
        self._now: float = 0
        self._begun: Optional[float] = None  # time of the first `next`
        self._requests = 0  # number of requests so far
        self._at = 0  # index of the step
        self._is_entered = False  # whether the step has begun
        self._request: Optional[Request] = None
        self._is_requested = False  # whether `next` returned it
        self._repetitions = 0  # of the request, after damaged acknowledges
        self._reply: Optional[bytes] = None  # telemetry that arrived before its `Done`
        self._wait: Optional[float] = None  # time until which the step waits
        self._end: float = 0  # of a poll
        self._count_left = 0  # messages of a map or packets that the step requests
        self._frame = b""  # data of the last telemetry
        self._repeated = 0  # number of times that the last entry was repeated
        self._is_block = False  # whether a block has begun
        self._requested_length = 0
        self._contents = bytearray()  # received packets
        self._received: list[bool] = []  # by position in the block
        self._missing = 0  # number of packets that are not received
        self._rounds = 0  # of the block
        self._pass_rounds = 0  # of this transfer of the block
        self._cursor = 0  # position after the selected packet
        self._last_packet: float = 0  # time of the last new packet

    @property
    def data(self) -> bytes:
        """The bytes received so far, in complete blocks."""
        return b"".join(data for _, data in self.blocks)

    @property
    def entries(self) -> Sequence[Message]:
        """The entries that were collected so far."""
        kind = self.link.TELEMETRY[need(self.form.entry, "entries")]
        return [kind.from_bytes(frame) for frame in self.frames]

    @property
    def progress(self) -> tuple[int, Optional[int]]:
        """Number of transferred bytes, and their total if known."""
        return self._registers[BLOCK_OFFSET], self._total if self.form.blocks else None

    @property
    def deadline(self) -> Optional[float]:
        """Time of the next call of `next`, in milliseconds; None while waiting for an
        outcome.
        """
        return None if self.result else self._wait

    def output(self, name: str) -> Optional[int]:
        """Return a number that the procedure reports; None until it is done."""
        for each in self.form.outputs:
            if each.name == name:
                is_known = self.result == "done"
                return self._registers[each.register] if is_known else None
        raise UnsupportedError(f"the procedure has no output `{name}`")

    def next(self, now: float) -> Optional[Request]:
        """Return the next request, once; None if there is nothing to send."""
        self._now = now
        if self._begun is None:
            self._begun = now
        if not self.result and now - self._begun > self.form.time:
            self._finish("limit")
        if self._wait is not None and now >= self._wait:
            self._wait = None
        while not (self.result or self._request or self._wait is not None):
            if self._at == len(self.form.steps):
                self._finish("done")
                break
            step = self.form.steps[self._at]
            _RUN[type(step)](self, step)
        if self.result or self._request is None or self._is_requested:
            return None
        if self._requests == self.form.requests:
            self._finish("limit")
            return None
        self._requests += 1
        self._is_requested = True
        return self._request

    def event(self, now: float, event: Event) -> None:
        """Process an event of the client. Unrelated events are ignored."""
        self._now = now
        if self.result:
            return
        if isinstance(event, Arrived):
            if event.id in self._receives:
                self._take_packet(self._receives[event.id], event.data)
        elif self._request is None or not self._is_requested:
            return
        elif isinstance(event, Reply):
            self._reply = event.data
        elif isinstance(event, (Done, Sent, Busy, Timeout)):
            self._process_outcome(event)
        elif isinstance(event, Refused):
            if not event.may_be_damaged:
                self._process_outcome(event)
            # If only the response is damaged, the node has perhaps executed the
            # telecommand. Some telecommands must not be executed twice.
            elif (
                self._request.repeat and self._repetitions < self.link.settings.retries
            ):
                self._repetitions += 1
                self._is_requested = False
            else:
                self._process_outcome(Timeout(event.id, event.attempts))

    # Inputs, and the end.

    def _set_inputs(self, inputs: Mapping[str, Optional[int]], data: bytes) -> None:
        register = FIRST_INPUT
        for form in self.form.inputs:
            if form.is_bytes:
                if len(data) > form.most:
                    raise TooLongError(form.most, len(data))
                self._input = data
            else:
                self._registers[register] = _checked(form, inputs.get(form.name))
                register += 1

    def _finish(self, result: Result) -> None:
        self.result = result
        self._request = self._wait = None

    # Steps: requests.

    def _go_to(self, index: int) -> None:
        self._at, self._is_entered = index, False

    def _proceed(self) -> None:
        self._go_to(self._at + 1)

    def _ask(self, request: Request) -> None:
        self._request, self._is_requested = request, False
        self._repetitions, self._reply = 0, None

    def _ask_telemetry(self, id: int) -> None:
        self._ask(Request("telemetry", id, b"", True))

    def _process_outcome(self, outcome: Outcome) -> None:
        """Process the end of the request of the current step."""
        self._request = None
        step = self.form.steps[self._at]
        if isinstance(step, Receive):
            if isinstance(outcome, Done):
                self._take_packet(step, self._data_of(outcome))
            self._count_one()
            return
        if isinstance(outcome, Timeout):
            if not (isinstance(step, Send) and step.ignores_timeout):
                self._finish("timeout")
                return
        elif not isinstance(outcome, (Done, Sent)):
            self._finish("refused" if isinstance(outcome, Refused) else "busy")
            return
        data = self._data_of(outcome)
        if isinstance(step, Send):
            self._proceed()
        elif isinstance(step, Get):
            self._keep(data, step.takes)
            self._proceed()
        elif isinstance(step, Poll):
            self._keep(data, step.takes)
            self._judge(step)
        elif isinstance(step, GetMap):
            self._apply_map(data)
            self._count_one()
        else:
            self._count_one()

    def _data_of(self, outcome: Outcome) -> bytes:
        """Return the requested telemetry."""
        if self._reply is not None:
            return self._reply
        return outcome.data if isinstance(outcome, Done) else b""

    def _count_one(self) -> None:
        """Proceed after the last request of a step with several requests."""
        self._count_left -= 1
        if not self._count_left:
            self._proceed()

    def _keep(self, data: bytes, takes: tuple[Take, ...]) -> None:
        """Keep telemetry, and fields of it."""
        self._frame = data
        for take in takes:
            self._registers[take.register] = take.place.of(data)

    def _send(self, step: Send) -> None:
        data = bytearray(step.data)
        for put in step.puts:
            put.place.put(put.value.of(self._registers), data)
        if step.packet_at is not None:
            packet = self._packet()
            data[step.packet_at : step.packet_at + len(packet)] = packet
        self._ask(Request("telecommand", step.telecommand, bytes(data), step.repeats))

    def _get(self, step: Get) -> None:
        self._ask_telemetry(step.telemetry)

    def _poll(self, step: Poll) -> None:
        if not self._is_entered:
            self._is_entered = True
            self._end = self._now + step.timeout
        self._ask_telemetry(step.telemetry)

    def _judge(self, step: Poll) -> None:
        """Decide about the telemetry of a poll."""
        if any(test.holds(self._registers) for test in step.fails):
            self._finish("failed")
        elif all(test.holds(self._registers) for test in step.until):
            self._proceed()
        elif self._now >= self._end:
            self._finish("timeout")
        else:
            self._wait = self._now + step.interval

    # Steps: blocks and packets.

    @property
    def _blocks(self) -> Blocks:
        return need(self.form.blocks, "blocks")

    @property
    def _map(self) -> PacketMap:
        return need(self._blocks.map, "map")

    @property
    def _total(self) -> Optional[int]:
        """Number of bytes of all blocks; None if unknown."""
        if self._blocks.sends:
            return len(self._input)
        register = self._blocks.total
        total = UNKNOWN if register is None else self._registers[register]
        return None if total == UNKNOWN else total

    def _next_block(self, step: NextBlock) -> None:
        registers, total, is_last = self._registers, self._total, False
        if self._is_block:
            is_last = registers[BLOCK_LENGTH] < self._requested_length
            self._end_block()
        offset = registers[BLOCK_OFFSET]
        if is_last if total is None else offset >= total:
            self._go_to(step.to)
            return
        length = self.block_bytes
        if total is not None:
            length = min(length, total - offset)
        self._is_block, self._requested_length, self._rounds = True, length, 0
        self._begin_pass()
        self._proceed()

    def _end_block(self) -> None:
        """Deliver the block."""
        offset, length = self._registers[BLOCK_OFFSET], self._registers[BLOCK_LENGTH]
        if not self._blocks.sends and length:
            self.blocks.append((offset, bytes(self._contents[:length])))
        self._registers[BLOCK_OFFSET] = offset + length
        self._registers[BLOCK_LENGTH] = 0
        self._received, self._missing = [], 0
        self._is_block, self._pass_rounds = False, 0

    def _begin_pass(self) -> None:
        """Begin to transfer a block."""
        self._pass_rounds = 0
        self._set_block_length(self._requested_length)

    def _set_block_length(self, length: int) -> None:
        blocks = self._blocks
        count = -(-length // blocks.packet_bytes)
        self._registers[BLOCK_LENGTH] = length
        self._registers[BLOCK_IS_EMPTY] = 1
        self._received, self._missing = [False] * count, count
        if not blocks.sends:
            self._contents = bytearray((blocks.fill,)) * (count * blocks.packet_bytes)

    def _set_length(self, step: SetLength) -> None:
        length = step.value.of(self._registers)
        requested = self._requested_length
        if length > requested or (self._total is not None and length != requested):
            self._finish("length")
        elif self._registers[BLOCK_OFFSET] + length > self._blocks.most:
            self._finish("limit")
        else:
            self._set_block_length(length)
            self._proceed()

    def _transfer_again(self, again: bool, result: Result) -> None:
        """Transfer the block again, or end the procedure.

        ``again``: whether the ICD specifies another transfer; otherwise end with
        ``result``. After the largest number of rounds, end with ``checksum``.
        """
        if not again:
            self._finish(result)
        elif self._rounds == self._blocks.rounds:
            self._finish("checksum")
        else:
            if not self._pass_rounds:
                self._rounds += 1
            self._begin_pass()
            self._go_to(self._blocks.begin)

    def _next_round(self, step: NextRound) -> None:
        if not self._missing:
            self._go_to(step.to)
        elif self._rounds == self._blocks.rounds:
            self._finish("rounds")
        else:
            self._rounds += 1
            self._pass_rounds += 1
            self._cursor = 0
            self._proceed()

    def _next_packet(self, step: NextPacket) -> None:
        for position in range(self._cursor, len(self._received)):
            if not self._received[position]:
                self._cursor = position + 1
                offset = position * self._blocks.packet_bytes
                registers = self._registers
                registers[PACKET_NUMBER] = self._blocks.first_packet + position
                registers[PACKET_OFFSET] = registers[BLOCK_OFFSET] + offset
                self._proceed()
                return
        self._go_to(step.to)

    def _packet_done(self, step: PacketDone) -> None:
        self._mark(self._cursor - 1, True)
        self._proceed()

    def _mark(self, position: int, is_received: bool) -> None:
        if self._received[position] != is_received:
            self._received[position] = is_received
            self._missing += -1 if is_received else 1
        is_empty = self._missing == len(self._received)
        self._registers[BLOCK_IS_EMPTY] = int(is_empty)

    def _packet(self) -> bytes:
        """Return the bytes of the selected packet, with the fill."""
        blocks, registers = self._blocks, self._registers
        start = registers[PACKET_OFFSET]
        end = registers[BLOCK_OFFSET] + registers[BLOCK_LENGTH]
        packet = self._input[start : min(start + blocks.packet_bytes, end)]
        return packet.ljust(blocks.packet_bytes, bytes((blocks.fill,)))

    def _block_data(self) -> bytes:
        """Return the bytes of the block, without the fill."""
        length = self._registers[BLOCK_LENGTH]
        if self._blocks.sends:
            offset = self._registers[BLOCK_OFFSET]
            return self._input[offset : offset + length]
        return bytes(self._contents[:length])

    def _take_packet(self, step: Receive, data: bytes) -> None:
        """Keep a packet if it is new."""
        blocks = self._blocks
        position = step.number.of(data) - blocks.first_packet
        packet = data[step.data_at : step.data_at + blocks.packet_bytes]
        if (
            not self._pass_rounds  # it may belong to the previous block
            or len(packet) != blocks.packet_bytes
            or not 0 <= position < len(self._received)
            or self._received[position]
        ):
            return
        at = position * blocks.packet_bytes
        self._contents[at : at + blocks.packet_bytes] = packet
        self._mark(position, True)
        self._last_packet = self._now
        is_receiving = isinstance(self.form.steps[self._at], Receive)
        if self._wait is not None and is_receiving:
            self._wait = self._now + (step.silence if self._missing else 0)

    def _receive(self, step: Receive) -> None:
        if not self._is_entered:
            self._is_entered = True
            self._last_packet = self._now
            self._count_left = self._missing
        if self.bus in step.requested_on and not self.link.stream:
            if self._count_left:
                self._ask_telemetry(step.telemetry)
            else:
                self._proceed()
        elif not self._missing or self._now >= self._last_packet + step.silence:
            self._proceed()
        else:
            self._wait = self._last_packet + step.silence

    # Steps: map of received packets.

    def _begin_map(self) -> int:
        """Return the index of the next message of the map."""
        bits = 8 * self._map.bytes
        count = -(-len(self._received) // bits)
        if not self._is_entered:
            self._is_entered, self._count_left = True, count
        return count - self._count_left

    def _send_map(self, step: SendMap) -> None:
        form, index = self._map, self._begin_map()
        if not self._count_left:
            self._proceed()
            return
        data, first = bytearray(form.length), index * 8 * form.bytes
        for bit in range(8 * form.bytes):
            state = form.beyond_end
            if first + bit < len(self._received):
                state = self._received[first + bit] == form.received
            at, mask = form.place(bit)
            data[at] |= mask if state else 0
        id = form.telecommands[index]
        self._ask(Request("telecommand", id, bytes(data), True))

    def _get_map(self, step: GetMap) -> None:
        index = self._begin_map()
        if self._count_left:
            self._ask_telemetry(self._map.telemetry[index])
        else:
            self._proceed()

    def _apply_map(self, data: bytes) -> None:
        """Note which packets the device has received."""
        form = self._map
        data = data.ljust(form.length, b"\0")
        first = self._begin_map() * 8 * form.bytes
        last = min(first + 8 * form.bytes, len(self._received))
        for position in range(first, last):
            at, mask = form.place(position - first)
            self._mark(position, bool(data[at] & mask) == form.received)

    # Steps: tests.

    def _verify_checksum(self, step: VerifyChecksum) -> None:
        data = self._block_data() if step.of_block else self._input
        if step.of_block and step.covers_fill:
            blocks = self._blocks
            if blocks.sends:
                size = len(self._received) * blocks.packet_bytes
                data = data.ljust(size, bytes((blocks.fill,)))
            else:
                data = bytes(self._contents)
        if checksum(self.link, step.checksum, data) == step.value.of(self._registers):
            self._proceed()
        else:
            self._transfer_again(step.again, "checksum")

    def _verify(self, step: Verify) -> None:
        if step.test.holds(self._registers):
            self._proceed()
        else:
            self._transfer_again(step.again, "failed")

    def _collect(self, step: Collect) -> None:
        if self.frames and self.frames[-1] == self._frame:
            self._repeated += 1
            if self._repeated > self.link.settings.retries:
                self._finish("timeout")
                return
        elif len(self.frames) == self.form.most_entries:
            self._finish("limit")
            return
        else:
            self.frames.append(self._frame)
            self._repeated = 0
        self._proceed()

    def _end_if_zeros(self, step: EndIfZeros) -> None:
        if any(self._frame):
            self._proceed()
        else:
            self._finish("done")

    def _skip_unless(self, step: SkipUnless) -> None:
        if step.test.holds(self._registers):
            self._proceed()
        else:
            self._go_to(step.to)

    def _jump(self, step: Jump) -> None:
        self._go_to(step.to)


def _checked(form: Input, value: Optional[int]) -> int:
    """Return the number of an input. Raise `RangeError`."""
    if value is None and form.is_optional:
        return UNKNOWN
    if value is not None and form.values and value in form.values:
        return int(value)
    if value is not None and not form.values and 0 <= value <= form.most:
        return int(value)
    allowed = f"0 to {form.most}"
    if form.values:
        allowed = "one of " + ", ".join(map(str, form.values))
    raise RangeError(form.name, allowed, value)


_RUN: dict[type, Callable[[Procedure, Any], None]] = {
    Send: Procedure._send,
    Get: Procedure._get,
    Poll: Procedure._poll,
    NextBlock: Procedure._next_block,
    SetLength: Procedure._set_length,
    NextRound: Procedure._next_round,
    NextPacket: Procedure._next_packet,
    PacketDone: Procedure._packet_done,
    SendMap: Procedure._send_map,
    GetMap: Procedure._get_map,
    Receive: Procedure._receive,
    VerifyChecksum: Procedure._verify_checksum,
    Verify: Procedure._verify,
    Collect: Procedure._collect,
    EndIfZeros: Procedure._end_if_zeros,
    SkipUnless: Procedure._skip_unless,
    Jump: Procedure._jump,
}
