"""The procedures of an ICD become exactly these steps, registers and limits."""

from __future__ import annotations

import pytest
import yaml

from icdgen.icd.procedures import FIXED_NAMES
from icdgen.protocol.exchange import NumberPlace
from icdgen.protocol.procedure_steps import ProcedureReader
from icdgen.protocol.procedures import (
    Collect,
    EndIfZeros,
    Get,
    GetMap,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    PacketDone,
    Poll,
    Put,
    Receive,
    Send,
    SendMap,
    SetLength,
    SkipUnless,
    Take,
    Value,
    Verify,
    VerifyChecksum,
)
from icdgen.protocol.procedures import Test as Comparison
from icdgen.protocol.sections import ChecksumAlgorithm
from tests.icd.files import loaded

MESSAGES = """\
enums:
  - {name: Kinds, members: [{value: 1, name: Log}]}
messages:
  - name: Open
    id: 1
    kind: telecommand
    length: 6
    fields:
      - {at: 0, bits: 8, name: Mark, type: uint, const: 0xA5}
      - {at: 8, bits: 4, name: Kind, type: uint}
      - {at: 16, bits: 32, name: Size, type: uint}
  - name: Write
    id: 2
    kind: telecommand
    length: 6
    fields:
      - {at: 0, bits: 16, name: Number, type: uint}
      - {at: 16, bits: 32, name: Data, type: bytes}
  - {name: Close, id: 3, kind: telecommand, length: 0}
  - {name: Map 1, set_id: 10, get_id: 140, kind: configuration, length: 4, reserved: 1,
     fields: [{at: 8, bits: 16, name: Bits, type: bytes}]}
  - {name: Map 2, set_id: 11, get_id: 141, kind: configuration, length: 4, reserved: 1,
     fields: [{at: 8, bits: 16, name: Bits, type: bytes}]}
  - name: State
    id: 130
    kind: telemetry
    length: 8
    fields:
      - {at: 0, bits: 1, name: Ready, type: bool}
      - {at: 1, bits: 1, name: Failed, type: bool}
      - {at: 8, bits: 8, name: Kind, type: enum, enum: Kinds}
      - {at: 16, bits: 16, name: Length, type: uint}
      - {at: 32, bits: 32, name: Sum, type: uint}
  - name: Packet
    id: 131
    kind: telemetry
    length: 6
    fields:
      - {at: 0, bits: 16, name: Number, type: uint}
      - {at: 16, bits: 32, name: Data, type: bytes}
"""
LIMITS = {"time_s": 3, "requests": 50}
SUM = ChecksumAlgorithm("sum", "sum", None, {})
FIRST = len(FIXED_NAMES)  # first register of an input
BYTE, WORD = NumberPlace(1, 1, 0, 4, True), NumberPlace(2, 4, 0, 32, True)
READY, FAILED = NumberPlace(0, 1, 0, 1, True), NumberPlace(0, 1, 1, 1, True)
KIND, LENGTH = NumberPlace(1, 1, 0, 8, True), NumberPlace(2, 2, 0, 16, True)


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    result = loaded(tmp_path_factory.mktemp("icd"), MESSAGES)
    assert result.ok, [finding.message for finding in result.findings]
    return result.icd


@pytest.fixture
def read(model):
    """Function that reads a procedure from YAML: its steps and other keys."""
    (node,) = model.nodes
    messages = {message.name: message for message in node.messages}
    enums = {enum.name: enum for enum in node.enums}

    def read(steps, **section):
        given = {"steps": yaml.safe_load(steps), "limits": LIMITS, **section}
        reader = ProcedureReader(given, {"demo": node}, messages, enums, {"sum": SUM})
        return reader.read_procedure("tested")

    return read


@pytest.fixture
def message(model):
    return {message.name: message for message in model.nodes[0].messages}


NUMBER = {"size": {}}


def test_a_procedure_has_its_limits_and_texts(read):
    procedure = read("[send: Close]", summary="Closes.", source={"section": "7"})
    assert (procedure.name, procedure.summary) == ("tested", "Closes.")
    assert (procedure.time, procedure.requests, procedure.most_entries) == (3000, 50, 0)
    assert procedure.source == {"section": "7"}
    assert (procedure.inputs, procedure.outputs, procedure.entry) == ((), (), None)
    assert (procedure.blocks, procedure.effect) == (None, None)
    assert procedure.register_names == (
        "block.offset",
        "block.length",
        "block.is_empty",
        "packet.number",
        "packet.offset",
    )
    listed = read("[send: Close]", limits={**LIMITS, "entries": 9})
    assert listed.most_entries == 9


def test_a_telecommand_has_its_constants_and_gets_values(read, message):
    (send,) = read("[{send: Open, with: {Size: size, Kind: 3}}]", inputs=NUMBER).steps
    assert send == Send(
        message=message["Open"],
        data=bytes.fromhex("a50000000000"),
        puts=(
            Put(WORD, Value(FIRST, True)),
            Put(BYTE, Value(3, False)),
        ),
        packet_at=None,
        repeats=True,
        ignores_timeout=False,
    )


@pytest.mark.parametrize(
    ("keys", "repeats", "ignores"),
    [
        ("", True, False),
        (", once: true", False, False),
        (", once: false", True, False),
        (", ignore: [timeout]", True, True),
        (", ignore: [busy]", True, False),
    ],
)
def test_a_telecommand_is_repeated_unless_it_is_sent_once(read, keys, repeats, ignores):
    (send,) = read(f"[{{send: Close{keys}}}]").steps
    assert (send.repeats, send.ignores_timeout) == (repeats, ignores)


def test_a_telecommand_carries_the_bytes_of_a_packet(read):
    (send,) = read(
        "[{send: Write, with: {Number: packet.number, Data: packet.data}}]"
    ).steps
    assert send.packet_at == 2
    assert send.puts == (Put(NumberPlace(0, 2, 0, 16, True), Value(3, True)),)


def test_requests_keep_the_fields_that_steps_and_outputs_use(read, message):
    procedure = read(
        """
        - get: State
        - {poll: State, as: ready, until: {Ready: 1, Kind: size}, fail: {Failed: 1},
           every_ms: 50, for_ms: 800}
        - send: Open
          with: {Size: State.Length}
        """,
        inputs=NUMBER,
        outputs={
            "kind": "State.Kind",
            "flag": "ready.Failed",
            "length": "State.Length",
        },
    )
    get, poll, send = procedure.steps
    names = ["size", "Ready", "Kind", "Failed", "Length", "Kind"]
    assert list(procedure.register_names[FIRST:]) == names
    ready, kind, failed, length, own_kind = range(FIRST + 1, FIRST + 6)
    state = message["State"]
    assert get == Get(state, (Take(LENGTH, length), Take(KIND, own_kind)))
    assert poll == Poll(
        state,
        (Take(READY, ready), Take(KIND, kind), Take(FAILED, failed)),
        (Comparison(ready, Value(1, False)), Comparison(kind, Value(FIRST, True))),
        (Comparison(failed, Value(1, False)),),
        50,
        800,
    )
    assert send.puts == (Put(WORD, Value(length, True)),)
    rows = [
        (o.name, o.register, o.enum and o.enum.name, o.is_flag)
        for o in procedure.outputs
    ]
    assert rows == [
        ("kind", own_kind, "Kinds", False),
        ("flag", failed, None, True),
        ("length", length, None, False),
    ]


@pytest.mark.parametrize(("key", "wanted"), [("if", 1), ("unless", 0)])
def test_a_step_with_a_condition_is_skipped(read, message, key, wanted):
    procedure = read(
        f"[{{send: Close, {key}: all}}, {{get: State}}]",
        inputs={"all": {"type": "bool"}},
    )
    skip, send, get = procedure.steps
    assert skip == SkipUnless(Comparison(FIRST, Value(wanted, False)), 2)
    assert (send.message.name, get) == ("Close", Get(message["State"], ()))


def kinds(procedure):
    """Return the name of each step, with the step at which it continues."""
    rows = [
        (type(step).__name__, getattr(step, "to", None)) for step in procedure.steps
    ]
    return [name if to is None else f"{name} {to}" for name, to in rows]


def test_a_loop_without_a_condition_jumps_back(read):
    procedure = read("[{send: Close}, {repeat: [{get: State}, {end_if_zeros: State}]}]")
    assert kinds(procedure) == ["Send", "Get", "EndIfZeros", "Jump 1"]
    assert isinstance(procedure.steps[2], EndIfZeros)
    assert procedure.steps[3] == Jump(1)


def test_entries_are_collected_from_the_named_telemetry(read, message):
    procedure = read("[{get: State, as: entry}, {collect: entry}]")
    assert procedure.entry is message["State"]
    assert kinds(procedure) == ["Get", "Collect"]
    assert isinstance(procedure.steps[1], Collect)


SENT = {"image": {"type": "bytes", "most": 100}}
SEND_BLOCKS = """
- send: Close
- blocks:
    of: image
    size: 16
    rounds: 4
    steps:
      - missing:
          packet: 4
          first: 1
          fill: 0xEE
          each: [{send: Write, with: {Number: packet.number, Data: packet.data}}]
      - send: Close
- get: State
"""


def test_sent_blocks_are_loops_of_rounds_and_packets(read):
    procedure = read(SEND_BLOCKS, inputs=SENT)
    assert kinds(procedure) == [
        "Send",
        "NextBlock 10",
        "NextRound 8",
        "NextPacket 7",
        "Send",
        "PacketDone",
        "Jump 3",
        "Jump 2",
        "Send",
        "Jump 1",
        "Get",
    ]
    steps = procedure.steps
    assert steps[1:4] == (NextBlock(10), NextRound(8), NextPacket(7))
    assert isinstance(steps[5], PacketDone)
    blocks = procedure.blocks
    assert (blocks.sends, blocks.total, blocks.size, blocks.begin) == (
        True,
        None,
        16,
        2,
    )
    assert (blocks.packet_bytes, blocks.first_packet, blocks.fill) == (4, 1, 0xEE)
    assert (blocks.rounds, blocks.most, blocks.map, blocks.packets) == (4, 100, None, 4)
    (image,) = procedure.inputs
    assert (image.is_bytes, image.most, image.is_flag) == (True, 100, False)


def test_a_block_is_one_packet_by_default(read):
    procedure = read("[{blocks: {size: 16, rounds: 4, steps: [send: Close]}}]",
                     limits={**LIMITS, "bytes": 77})  # fmt: skip
    blocks = procedure.blocks
    assert kinds(procedure) == ["NextBlock 3", "Send", "Jump 0"]
    assert (blocks.sends, blocks.total, blocks.most, blocks.begin) == (
        False,
        None,
        77,
        1,
    )
    assert (blocks.packet_bytes, blocks.first_packet, blocks.fill) == (16, 0, 0)
    assert blocks.packets == 1


RECEIVED = """
- blocks:
    total: size
    size: 16
    rounds: 4
    steps:
      - block_length: 8
      - missing:
          packet: 4
          steps:
            - {map: send, messages: [Map 1, Map 2], field: Bits, %s}
            - receive: Packet
              number: Number
              data: Data
              silence_ms: 250
              requested_on: [can]
"""


def received(read, keys="received: 1", **more):
    limits = {**LIMITS, "bytes": 77}
    return read(
        RECEIVED % keys, inputs={"size": {"optional": True}}, limits=limits, **more
    )


def test_received_blocks_have_a_map_and_packets(read, message):
    procedure = received(read)
    assert kinds(procedure) == [
        "NextBlock 7",
        "SetLength",
        "NextRound 6",
        "SendMap",
        "Receive",
        "Jump 2",
        "Jump 0",
    ]
    assert procedure.steps[1] == SetLength(Value(8, False))
    assert isinstance(procedure.steps[3], SendMap)
    assert procedure.steps[4] == Receive(
        message["Packet"], NumberPlace(0, 2, 0, 16, True), 2, 250, ("can",)
    )
    blocks = procedure.blocks
    assert (blocks.sends, blocks.total, blocks.most) == (False, FIRST, 77)
    assert (blocks.first_packet, blocks.fill) == (0, 0)
    assert [each.name for each in blocks.map.messages] == ["Map 1", "Map 2"]
    assert (blocks.map.at, blocks.map.bytes) == (1, 2)
    # An input that is the number of bytes is at most that of the procedure.
    (size,) = procedure.inputs
    assert (size.most, size.is_optional) == (77, True)


@pytest.mark.parametrize(
    ("keys", "msb0", "is_received", "beyond"),
    [
        ("received: 1", False, True, True),
        ("received: 0", False, False, False),
        ("bit_order: msb0", True, True, True),
        ("bit_order: lsb0, received: 0, beyond_end: 1", False, False, True),
        ("beyond_end: 0", False, True, False),
    ],
)
def test_a_map_has_a_bit_for_each_packet(read, keys, msb0, is_received, beyond):
    map_ = received(read, keys).blocks.map
    assert (map_.msb0, map_.received, map_.beyond_end) == (msb0, is_received, beyond)


def test_with_a_map_packets_are_not_done_one_by_one(read):
    procedure = read(
        """
        - blocks:
            of: image
            size: 16
            rounds: 4
            steps:
              - missing:
                  packet: 4
                  each: [send: Write]
                  steps: [{map: get, messages: [Map 1], field: Bits}]
        """,
        inputs=SENT,
    )
    assert kinds(procedure) == [
        "NextBlock 8",
        "NextRound 7",
        "NextPacket 5",
        "Send",
        "Jump 2",
        "GetMap",
        "Jump 1",
        "Jump 0",
    ]
    assert any(isinstance(step, GetMap) for step in procedure.steps)


@pytest.mark.parametrize(
    ("verify", "expected"),
    [
        (
            "{checksum: sum, of: block, equals: 5}",
            (True, False, Value(5, False), False),
        ),
        (
            "{checksum: sum, of: image, covers_fill: true, equals: State.Sum}, else: again",
            (False, True, Value(FIRST, True), True),
        ),
        (
            "{checksum: sum, of: block, equals: 5}, else: fail",
            (True, False, Value(5, False), False),
        ),
    ],
)
def test_a_checksum_is_compared_with_a_value(read, verify, expected):
    procedure = read(f"[{{get: State}}, {{verify: {verify}}}]", inputs=SENT)
    assert procedure.steps[1] == VerifyChecksum(SUM, *expected)


@pytest.mark.parametrize(("more", "again"), [("", False), (", else: again", True)])
def test_a_number_of_telemetry_is_verified(read, more, again):
    text = f"[{{get: State}}, {{verify: {{field: State.Length, equals: size}}{more}}}]"
    _, verify = read(text, inputs=NUMBER).steps
    assert verify == Verify(Comparison(FIRST + 1, Value(FIRST, True)), again)


def test_an_input_fits_into_each_field_that_gets_it(read):
    steps = "[{send: Open, with: {Size: a, Kind: b}}, {send: Write, with: {Number: a}}]"
    procedure = read(
        steps,
        inputs={
            "a": {},
            "b": {"summary": "The kind.", "values": [1, 3], "enum": "Kinds"},
            "c": {},
            "image": {"type": "bytes", "most": 9},
            "d": {"most": 7},
            "e": {"type": "bool"},
        },
    )
    a, b, *_ = procedure.inputs
    assert [each.most for each in procedure.inputs] == [0xFFFF, 15, 2**32 - 1, 9, 7, 1]
    assert [each.is_flag for each in procedure.inputs] == [False] * 5 + [True]
    assert [each.is_bytes for each in procedure.inputs] == [False] * 3 + [
        True,
        False,
        False,
    ]
    assert (b.values, b.enum.name, b.summary, b.is_optional) == (
        (1, 3), "Kinds", "The kind.", False,
    )  # fmt: skip
    assert (a.values, a.enum, a.summary) == ((), None, "")
    # Numbers have consecutive registers, in the order of the ICD.
    assert procedure.register_names[FIRST:] == ("a", "b", "c", "d", "e")


EFFECT = {
    "describe": "file",
    "key": ["kind", "size"],
    "all_if": {"all": 1},
    "to": [3, 4],
    "fields": {"size": "Length", "checksum": "Sum"},
}


def test_an_effect_has_its_key_and_the_numbers_of_the_last_telemetry(read):
    inputs = {"all": {"type": "bool"}, "kind": {}, "size": {}}
    effect = read("[{get: Packet}, {get: State}]", inputs=inputs, effect=EFFECT).effect
    assert (effect.verb, effect.kind) == ("describe", "file")
    assert (effect.key, effect.names) == ((FIRST + 1, FIRST + 2), ("kind", "size"))
    assert effect.all_if == Comparison(FIRST, Value(1, False))
    assert effect.to == (3, 4)
    assert effect.fields == (
        ("size", LENGTH),
        ("checksum", NumberPlace(4, 4, 0, 32, True)),
    )


@pytest.mark.parametrize("verb", ["list", "read", "write", "erase", "copy"])
def test_an_effect_needs_only_a_verb_and_a_kind(read, verb):
    effect = read("[send: Close]", effect={verb: "program"}).effect
    assert (effect.verb, effect.kind, effect.key, effect.names) == (
        verb,
        "program",
        (),
        (),
    )
    assert (effect.all_if, effect.to, effect.fields) == (None, (), ())
