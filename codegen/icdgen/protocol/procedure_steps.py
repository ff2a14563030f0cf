"""Reader of the procedures of a checked ICD, into the classes of
`icdgen.protocol.procedures`. Rules ICD190 to ICD194 check what it relies on.

In the ICD, `blocks`, `missing` and `repeat` contain steps. Here each of these loops
becomes a step that decides whether it goes on, the steps of the loop, and a jump back.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

from icdgen import codec
from icdgen.icd.enumeration import Enum
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace
from icdgen.icd.procedures import (
    AGAIN,
    BLOCK,
    BYTES,
    EFFECTS,
    FIXED_NAMES,
    FIXED_OWNERS,
    FLAG,
    PACKET_DATA,
    SEND,
    name_of,
)
from icdgen.icd.responses import field_of
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.procedures import (
    Blocks,
    Collect,
    Effect,
    EndIfZeros,
    Get,
    GetMap,
    Input,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    Output,
    PacketDone,
    PacketMap,
    Poll,
    Procedure,
    Put,
    Receive,
    Send,
    SendMap,
    SetLength,
    SkipUnless,
    Step,
    Take,
    Test,
    Value,
    Verify,
    VerifyChecksum,
)
from icdgen.protocol.responding import place_of
from icdgen.protocol.sections import ChecksumAlgorithm

_LATER = -1  # `to` of a step until the step is known at which it continues

Section = Mapping[str, Any]
Name = tuple[str, str]  # of a register: its owner ("" for inputs) and its own name


class ProcedureReader:
    """Reader of one procedure of a node.

    ``section``: the procedure in the ICD. ``nodes``: the node and the nodes that it
    includes. ``messages``, ``enums`` and ``checksums``: definitions to which the
    procedure can refer, by name.
    """

    def __init__(
        self,
        section: Section,
        nodes: Mapping[str, Node],
        messages: Mapping[str, Message],
        enums: Mapping[str, Enum],
        checksums: Mapping[str, ChecksumAlgorithm],
    ) -> None:
        self._section, self._nodes, self._messages = section, nodes, messages
        self._inputs: Section = section.get("inputs", {})
        self._limits: Section = section["limits"]
        self._enums, self._checksums = enums, checksums
        self._steps: list[Step] = []
        self._registers: dict[Name, int] = {
            name: number for number, name in enumerate(FIXED_NAMES)
        }
        self._bits: dict[str, int] = {}  # fewest bits of the fields that get an input
        self._frames: dict[str, Message] = {}  # telemetry by the name of `as`
        self._frame_of: dict[int, str] = {}  # that name by index of the request
        self._entry: Message | None = None
        self._blocks: Blocks | None = None

    def read_procedure(self, name: str) -> Procedure:
        """Return the procedure under its name."""
        section, limits = self._section, self._limits
        # Before the steps: a client writes its inputs into consecutive registers.
        for key, row in self._inputs.items():
            if row.get("type") != BYTES:
                self._register(("", key))
        self._add(section["steps"])
        outputs = [
            self._output(key, path) for key, path in section.get("outputs", {}).items()
        ]
        # Last: now all fields are known that steps and outputs use.
        self._keep_fields()
        return Procedure(
            name=name,
            summary=section.get("summary", ""),
            inputs=tuple(self._input(key, row) for key, row in self._inputs.items()),
            outputs=tuple(outputs),
            entry=self._entry,
            most_entries=limits.get("entries", 0),
            blocks=self._blocks,
            register_names=tuple(
                f"{owner}.{name}" if owner in FIXED_OWNERS else name
                for owner, name in self._registers
            ),
            time=limits["time_s"] * 1000,
            requests=limits["requests"],
            steps=tuple(self._steps),
            source=section.get("source", {}),
            effect=self._effect(section.get("effect")),
        )

    def _input(self, name: str, row: Section) -> Input:
        register = self._registers.get(("", name))
        # An input must fit into each field that gets it.
        most = (1 << self._bits.get(name, 32)) - 1
        # A number that fits into its field can still exceed the bytes of the procedure.
        if self._blocks and register is not None and register == self._blocks.total:
            most = min(most, self._blocks.most)
        is_flag = row.get("type") == FLAG
        return Input(
            name=name,
            is_bytes=row.get("type") == BYTES,
            is_flag=is_flag,
            enum=self._enums.get(row.get("enum", "")),
            most=1 if is_flag else row.get("most", most),
            values=tuple(row.get("values", ())),
            is_optional=row.get("optional", False),
            summary=row.get("summary", ""),
        )

    def _output(self, name: str, path: str) -> Output:
        frame, field_name = name_of(path)
        field = self._field(self._frames[frame], field_name)
        register = self._value(path).number
        return Output(name, register, field.scalar.enum, field.scalar.type == FLAG)

    def _effect(self, row: Section | None) -> Effect | None:
        if row is None:
            return None
        # Fields of an effect are those of the telemetry that is requested last.
        message = list(self._frames.values())[-1] if self._frames else None
        fields = []
        for name, field in row.get("fields", {}).items():
            assert message is not None, "rule ICD194 checks the effect"
            fields.append((name, self._place(message, field)))
        all_if = [
            Test(self._register(("", name)), self._value(value))
            for name, value in row.get("all_if", {}).items()
        ]
        verb, key = next(verb for verb in EFFECTS if verb in row), row.get("key", [])
        return Effect(
            verb=verb,
            kind=row[verb],
            key=tuple(self._register(("", name)) for name in key),
            names=tuple(key),
            all_if=all_if[0] if all_if else None,
            to=tuple(row.get("to", ())),
            fields=tuple(fields),
        )

    def _register(self, name: Name) -> int:
        """Return the register of a name; an unknown name gets the next one."""
        return self._registers.setdefault(name, len(self._registers))

    def _value(self, value: object) -> Value:
        """Return a constant, or the register that a name stands for."""
        if isinstance(value, str):
            return Value(self._register(name_of(value)), True)
        return Value(int(cast(int, value)), False)

    def _field(self, message: Message, name: str) -> NodePlace:
        field = field_of(message, name)
        assert field is not None, "rule ICD191 checks the names of fields"
        return field

    def _place(self, message: Message, name: str) -> NumberPlace:
        place = place_of(self._nodes[message.node], self._field(message, name))
        assert place is not None, "rule ICD191 checks the places of numbers"
        return place

    def _keep_fields(self) -> None:
        """Let each request keep the fields that any step uses."""
        for index, frame in self._frame_of.items():
            request = self._steps[index]
            assert isinstance(request, (Get, Poll))
            takes = tuple(
                Take(self._place(request.message, name), register)
                for (owner, name), register in self._registers.items()
                if owner == frame
            )
            self._steps[index] = replace(request, takes=takes)

    def _add(self, rows: Sequence[Section]) -> None:
        """Add the steps of a list."""
        for row in rows:
            condition = self._condition(row)
            skip = len(self._steps)
            if condition:
                self._steps.append(SkipUnless(condition, _LATER))
            self._add_step(row)
            if condition:
                self._leads_here(skip)

    def _condition(self, row: Section) -> Test | None:
        """Return the condition of a step: a flag is set, or is not set."""
        for key, wanted in (("if", 1), ("unless", 0)):
            if key in row:
                return Test(self._value(row[key]).number, Value(wanted, False))
        return None

    def _leads_here(self, index: int) -> None:
        """Let a step continue at the step that is added next."""
        step = self._steps[index]
        assert isinstance(step, (SkipUnless, NextBlock, NextRound, NextPacket))
        self._steps[index] = replace(step, to=len(self._steps))

    def _add_step(self, row: Section) -> None:
        match row:
            case {"send": name}:
                self._steps.append(self._send(self._messages[name], row))
            case {"get": name}:
                self._request(name, row)
                self._steps.append(Get(self._messages[name], ()))
            case {"poll": name}:
                self._add_poll(name, row)
            case {"blocks": blocks}:
                self._add_blocks(blocks)
            case {"block_length": value}:
                self._steps.append(SetLength(self._value(value)))
            case {"missing": missing}:
                self._add_missing(missing)
            case {"map": direction}:
                self._change_blocks(map=self._map(row))
                self._steps.append(SendMap() if direction == SEND else GetMap())
            case {"receive": name}:
                self._steps.append(self._receive(self._messages[name], row))
            case {"verify": verify}:
                self._steps.append(self._verify(verify, row.get("else") == AGAIN))
            case {"repeat": steps}:
                # The loop has no condition: a step in it, such as `end_if_zeros`, ends
                # the procedure, or a limit does.
                first = len(self._steps)
                self._add(steps)
                self._steps.append(Jump(first))
            case {"collect": frame}:
                self._entry = self._frames[frame]
                self._steps.append(Collect())
            case {"end_if_zeros": _}:
                self._steps.append(EndIfZeros())

    def _send(self, message: Message, row: Section) -> Send:
        puts, packet_at = [], None
        for name, value in row.get("with", {}).items():
            if value == PACKET_DATA:
                packet_at = self._field(message, name).at // 8
                continue
            place = self._place(message, name)
            if value in self._inputs:
                self._bits[value] = min(self._bits.get(value, 32), place.bits)
            puts.append(Put(place, self._value(value)))
        node = self._nodes[message.node]
        # The other fields have their initial values, constants among them.
        data = codec.encode(node, message, codec.initial_values(node, message))
        return Send(
            message=message,
            data=data,
            puts=tuple(puts),
            packet_at=packet_at,
            repeats=not row.get("once", False),
            ignores_timeout="timeout" in row.get("ignore", ()),
        )

    def _request(self, name: str, row: Section) -> str:
        """Note that the next step requests telemetry. Return the name of its frame."""
        frame: str = row.get("as", name)
        self._frames[frame] = self._messages[name]
        self._frame_of[len(self._steps)] = frame
        return frame

    def _add_poll(self, name: str, row: Section) -> None:
        frame = self._request(name, row)

        def tests(key: str) -> tuple[Test, ...]:
            return tuple(
                Test(self._register((frame, field)), self._value(value))
                for field, value in row.get(key, {}).items()
            )

        until, fails = tests("until"), tests("fail")
        times = row["every_ms"], row["for_ms"]
        self._steps.append(Poll(self._messages[name], (), until, fails, *times))

    def _add_blocks(self, blocks: Section) -> None:
        sent = self._inputs[blocks["of"]] if "of" in blocks else None
        total = blocks.get("total")
        most = sent["most"] if sent else self._limits["bytes"]
        first = len(self._steps)
        self._blocks = Blocks(
            sends=sent is not None,
            total=None if total is None else self._value(total).number,
            size=blocks["size"],
            begin=first + 1,
            # A block is one packet, unless `missing` divides it.
            packet_bytes=blocks["size"],
            first_packet=0,
            fill=0,
            rounds=blocks["rounds"],
            most=most,
            map=None,
        )
        self._steps.append(NextBlock(_LATER))
        self._add(blocks["steps"])
        self._steps.append(Jump(first))
        self._leads_here(first)

    def _change_blocks(self, **changes: Any) -> None:
        assert self._blocks is not None, "rule ICD190 checks the places of steps"
        self._blocks = replace(self._blocks, **changes)

    def _add_missing(self, missing: Section) -> None:
        self._change_blocks(
            packet_bytes=missing["packet"],
            first_packet=missing.get("first", 0),
            fill=missing.get("fill", 0),
        )
        # A loop is: decide or leave, the steps, jump back. So its first step continues
        # behind its last one (`_leads_here`).
        rounds = len(self._steps)
        self._steps.append(NextRound(_LATER))
        if "each" in missing:
            packets = len(self._steps)
            self._steps.append(NextPacket(_LATER))
            self._add(missing["each"])
            if "steps" not in missing:  # otherwise a map tells which packets are there
                self._steps.append(PacketDone())
            self._steps.append(Jump(packets))
            self._leads_here(packets)
        self._add(missing.get("steps", ()))
        self._steps.append(Jump(rounds))
        self._leads_here(rounds)

    def _map(self, row: Section) -> PacketMap:
        messages = tuple(self._messages[name] for name in row["messages"])
        field = self._field(messages[0], row["field"])
        return PacketMap(
            messages=messages,
            at=field.at // 8,
            bytes=field.bits // 8,
            msb0=row.get("bit_order") == "msb0",
            received=bool(row.get("received", 1)),
            # By default, packets beyond the end do not count as missing.
            beyond_end=bool(row.get("beyond_end", row.get("received", 1))),
        )

    def _receive(self, message: Message, row: Section) -> Receive:
        return Receive(
            message=message,
            number=self._place(message, row["number"]),
            data_at=self._field(message, row["data"]).at // 8,
            silence=row["silence_ms"],
            requested_on=tuple(row.get("requested_on", ())),
        )

    def _verify(self, verify: Section, again: bool) -> Step:
        value = self._value(verify["equals"])
        if "field" in verify:
            return Verify(Test(self._value(verify["field"]).number, value), again)
        return VerifyChecksum(
            algorithm=self._checksums[verify["checksum"]],
            of_block=verify["of"] == BLOCK,
            covers_fill=verify.get("covers_fill", False),
            value=value,
            again=again,
        )
