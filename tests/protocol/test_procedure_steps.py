"""Each step of a procedure works alone and in combinations that no ICD uses."""

from __future__ import annotations

import pytest
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.errors import TooLongError, UnsupportedError
from icdgen_runtime.wire.events import (
    Arrived,
    Busy,
    Done,
    Refused,
    Reply,
    Sent,
    Timeout,
)
from icdgen_runtime.wire.procedure_forms import (
    BLOCK_LENGTH,
    BLOCK_OFFSET,
    FIRST_INPUT,
    Blocks,
    Get,
    Input,
    Jump,
    NextBlock,
    NextPacket,
    NextRound,
    NumberPlace,
    Output,
    PacketDone,
    PacketMap,
    Poll,
    ProcedureForm,
    Put,
    Receive,
    Send,
    SendMap,
    SkipUnless,
    Take,
    Value,
)
from icdgen_runtime.wire.procedure_forms import Test as Condition
from icdgen_runtime.wire.procedures import Procedure

BYTE = NumberPlace(0, 1, 0, 8, True)
SECOND = NumberPlace(1, 1, 0, 8, True)
OTHER = FIRST_INPUT + 1  # register of a field, after one input
BLOCKS = Blocks(
    sends=False,
    total=FIRST_INPUT,
    size=4,
    begin=1,
    packet_bytes=2,
    first_packet=0,
    fill=0xFF,
    rounds=2,
    most=100,
)
SIZE = (Input("size", most=100, is_optional=True),)


def procedure_with(
    link, *steps, inputs=(), values=None, data=b"", block=None, **more
) -> Procedure:
    """Return a procedure with these steps."""
    form = ProcedureForm(inputs, (), 12, 1000, 100, steps)._replace(**more)
    changed = link._replace(procedures={"tested": form})
    return Procedure(changed, "tested", values or {}, data, block)


def done(data=""):
    return Done(0, 1, bytes.fromhex(data))


def packet(number, data="0000"):
    return Arrived(241, bytes((number,)) + bytes.fromhex(data), {})


def test_a_procedure_without_steps_is_done_at_once(link):
    procedure = procedure_with(link)
    assert procedure.next(0) is None
    assert (procedure.result, procedure.deadline) == ("done", None)


def test_a_request_is_returned_once(link):
    procedure = procedure_with(link, Get(128))
    assert procedure.next(0).id == 128
    assert procedure.next(0) is None and procedure.deadline is None
    procedure.event(1, done())
    procedure.next(1)
    assert procedure.result == "done"


def test_a_value_is_masked_to_its_field_and_does_not_change_other_bits(link):
    nibble = NumberPlace(0, 1, 4, 4, True)
    puts = (Put(nibble, Value(FIRST_INPUT, True)), Put(SECOND, Value(7, False)))
    procedure = procedure_with(
        link, Send(1, b"\x0f\xff\xff", puts), inputs=SIZE, values={"size": 5}
    )
    assert procedure.next(0).data == b"\x5f\x07\xff"


@pytest.mark.parametrize(
    ("outcome", "result"),
    [
        (Sent(0), "done"),
        (Done(0, 1), "done"),
        (Timeout(0, 1), "timeout"),
        (Busy(0, 1), "busy"),
        (Refused(0, 1), "refused"),
    ],
)
def test_the_outcome_of_a_telecommand_decides(link, outcome, result):
    procedure = procedure_with(link, Send(1, b""))
    procedure.next(0)
    procedure.event(0, outcome)
    procedure.next(0)
    assert procedure.result == result


def test_a_time_out_can_count_as_done(link):
    procedure = procedure_with(link, Send(1, b"", ignores_timeout=True), Get(128))
    procedure.next(0)
    procedure.event(0, Timeout(0, 1))
    assert procedure.next(0).id == 128
    procedure.event(0, Timeout(0, 1))
    assert procedure.result == "timeout"


def test_a_damaged_refusal_repeats_the_request_only_if_it_may_be_repeated(link):
    damaged = Refused(0, 1, 200, may_be_damaged=True)
    procedure = procedure_with(link, Send(1, b"", repeats=True))
    for _ in range(1 + link.settings.retries):
        assert procedure.next(0).id == 1
        procedure.event(0, damaged)
    assert procedure.result == "timeout"
    procedure = procedure_with(link, Send(1, b""))
    procedure.next(0)
    procedure.event(0, damaged)
    assert procedure.result == "timeout"


def test_a_refusal_on_a_framed_link_is_never_damaged(link):
    framed = link._replace(stream=object())
    procedure = procedure_with(framed, Send(1, b"", repeats=True))
    procedure.next(0)
    procedure.event(0, Refused(0, 1, 200))
    assert procedure.result == "refused"


def test_telemetry_that_arrives_before_its_acknowledge_is_used(link):
    take = (Take(SECOND, OTHER),)
    procedure = procedure_with(link, Get(128, take), outputs=(Output("number", OTHER),))
    procedure.next(0)
    procedure.event(0, Reply(1, b"\x01\x02", None, 128))
    assert procedure.output("number") is None
    procedure.event(0, done("ff"))
    procedure.next(0)
    assert procedure.output("number") == 2


def test_short_telemetry_reads_as_zeros(link):
    procedure = procedure_with(
        link, Get(128, (Take(SECOND, OTHER),)), outputs=(Output("number", OTHER),)
    )
    procedure.next(0)
    procedure.event(0, done("01"))
    procedure.next(0)
    assert procedure.output("number") == 0


def test_a_poll_fails_rather_than_succeeds_and_ends_after_its_time(link):
    takes = (Take(BYTE, OTHER), Take(SECOND, OTHER + 1))
    tests = (
        (Condition(OTHER, Value(1, False)),),
        (Condition(OTHER + 1, Value(1, False)),),
    )
    poll = Poll(128, takes, *tests, 50, 120)
    for frame, result in (("0101", "failed"), ("0100", "done")):
        procedure = procedure_with(link, poll)
        procedure.next(0)
        procedure.event(1, done(frame))
        procedure.next(1)
        assert procedure.result == result
    procedure, now, times = procedure_with(link, poll), 0, []
    while not procedure.result:
        if procedure.next(now):
            times.append(now)
            procedure.event(now, done("0000"))
        now = procedure.deadline or now
    assert (procedure.result, times) == ("timeout", [0, 50, 100, 150])


def test_the_limits_of_requests_and_of_time_end_a_procedure(link):
    procedure = procedure_with(link, Get(128), Jump(0), requests=3)
    for _ in range(3):
        assert procedure.next(0)
        procedure.event(0, done())
    assert procedure.next(0) is None and procedure.result == "limit"
    procedure = procedure_with(link, Get(128), Jump(0), time=100)
    assert procedure.next(50)
    procedure.event(150, done())
    assert procedure.next(150) and not procedure.result
    assert procedure.next(151) is None and procedure.result == "limit"


def test_packets_count_only_from_the_first_round_of_their_block(link):
    receive = Receive(241, BYTE, 1, 100)
    steps = (
        NextBlock(6), Send(1, b""), NextRound(5), receive, Jump(2), Jump(0),
    )  # fmt: skip
    procedure = procedure_with(
        link, *steps, inputs=SIZE, values={"size": 8}, blocks=BLOCKS
    )
    assert procedure.next(0).id == 1
    procedure.event(0, packet(0, "eeee"))  # of another transfer
    procedure.event(1, done())
    assert procedure.next(1) is None and procedure.deadline == 101
    procedure.event(10, packet(0, "0001"))
    assert procedure.deadline == 110
    procedure.event(20, packet(0, "9999"))  # a copy
    procedure.event(20, packet(2, "9999"))  # outside the block
    procedure.event(20, packet(1, "99"))  # too short
    assert procedure.deadline == 110
    procedure.event(30, packet(1, "0203"))
    assert procedure.deadline == 30
    assert procedure.next(30).id == 1
    assert procedure.blocks == [(0, bytes(range(4)))]
    assert procedure.progress == (4, 8)
    procedure.event(31, packet(0, "9999"))  # late, of the first block
    procedure.event(32, done())
    assert procedure.next(32) is None
    procedure.event(33, packet(0, "0405"))
    procedure.event(34, packet(1, "0607"))
    procedure.next(34)
    assert (procedure.result, procedure.data) == ("done", bytes(range(8)))


def test_a_packet_does_not_change_when_a_poll_asks_again(link):
    takes, until = (Take(BYTE, OTHER),), (Condition(OTHER, Value(1, False)),)
    poll, receive = Poll(128, takes, until, (), 50, 1000), Receive(241, BYTE, 1, 100)
    steps = NextBlock(6), NextRound(5), poll, receive, Jump(1), Jump(0)
    procedure = procedure_with(
        link, *steps, inputs=SIZE, values={"size": 4}, blocks=BLOCKS
    )
    procedure.next(0)
    procedure.event(0, done("00"))
    assert procedure.next(0) is None and procedure.deadline == 50
    procedure.event(10, packet(0))
    assert procedure.deadline == 50
    assert procedure.next(50).id == 128
    procedure.event(60, done("01"))
    assert procedure.next(60) is None and procedure.deadline == 160


def test_missing_packets_end_with_the_rounds(link):
    receive = Receive(241, BYTE, 1, 100)
    steps = NextBlock(5), NextRound(4), receive, Jump(1), Jump(0)
    procedure = procedure_with(
        link, *steps, inputs=SIZE, values={"size": 4}, blocks=BLOCKS
    )
    procedure.next(0)
    procedure.event(0, packet(0))
    for now in (100, 200):
        assert procedure.deadline == now
        procedure.next(now)
    assert procedure.result == "rounds"


def test_on_a_bus_of_requests_each_missing_packet_is_requested_once(link):
    receive = Receive(241, BYTE, 1, 100, ("can",))
    steps = NextBlock(5), NextRound(4), receive, Jump(1), Jump(0)
    procedure = procedure_with(
        link, *steps, inputs=SIZE, values={"size": 4}, blocks=BLOCKS
    )
    procedure.bus = "can"
    for outcome in (Timeout(0, 1), done("01" + "0203"), done("00" + "0001")):
        request = procedure.next(0)
        assert (request.id, request.repeat) == (241, True)
        procedure.event(0, outcome)
    procedure.next(0)
    assert procedure.blocks == [(0, bytes(range(4)))]


def test_a_sent_packet_is_missing_until_it_is_done(link):
    puts = (Put(BYTE, Value(BLOCK_OFFSET, True)), Put(SECOND, Value(4, True)))
    steps = (
        NextBlock(8), NextRound(7), NextPacket(6), Send(1, bytes(4), puts, 2),
        PacketDone(), Jump(2), Jump(1), Jump(0),
    )  # fmt: skip
    inputs = (Input("image", is_bytes=True, most=10),)
    blocks = BLOCKS._replace(sends=True, total=None)
    data = bytes(range(0x10, 0x17))
    procedure = procedure_with(
        link, *steps, inputs=inputs, data=data, block=3, blocks=blocks
    )
    sent = []
    while request := procedure.next(0):
        sent.append(request.data.hex(" ", 2))
        procedure.event(0, Sent(0))
    # Offsets of block and packet, and its bytes, filled at the end of each block.
    assert sent == ["0000 1011", "0002 12ff", "0303 1314", "0305 15ff", "0606 16ff"]
    assert (procedure.result, procedure.progress) == ("done", (7, 7))


def test_a_map_has_the_packets_that_arrived_before_each_of_its_messages(link):
    form = PacketMap((120, 121), (247, 248), 2, 1, 1, False, True, False)
    blocks = BLOCKS._replace(size=20, map=form)
    receive = Receive(241, BYTE, 1, 100)
    steps = NextBlock(6), NextRound(5), SendMap(), receive, Jump(1), Jump(0)
    procedure = procedure_with(
        link, *steps, inputs=SIZE, values={"size": 20}, blocks=blocks
    )
    first = procedure.next(0)
    assert (first.id, first.data) == (120, b"\x00\x00")
    procedure.event(0, packet(9))
    procedure.event(0, done())
    second = procedure.next(0)
    assert (second.id, second.data) == (121, b"\x00\x02")


def test_a_step_can_depend_on_a_flag(link):
    flag = (Input("all", most=1),)
    steps = SkipUnless(Condition(FIRST_INPUT, Value(1, False)), 2), Get(128)
    for value, request in ((0, None), (1, 128)):
        procedure = procedure_with(link, *steps, inputs=flag, values={"all": value})
        sent = procedure.next(0)
        assert (sent.id if sent else None) == request


def test_inputs_out_of_range_are_rejected_before_the_start(link):
    numbers = (Input("one", most=3), Input("two", most=255, values=(4, 5)))
    for values in ({"one": 4, "two": 4}, {"one": -1, "two": 4}, {"one": 3, "two": 3}):
        with pytest.raises(RangeError):
            procedure_with(link, inputs=numbers, values=values)
    with pytest.raises(RangeError, match="one"):
        procedure_with(link, inputs=numbers, values={"two": 4})
    procedure_with(link, inputs=numbers, values={"one": 3, "two": 5})
    data = (Input("image", is_bytes=True, most=10),)
    with pytest.raises(TooLongError):
        procedure_with(link, inputs=data, data=bytes(11))
    for block in (0, -1):
        with pytest.raises(RangeError, match="1 to 4"):
            procedure_with(link, inputs=SIZE, blocks=BLOCKS, block=block)
    assert procedure_with(link, inputs=SIZE, blocks=BLOCKS, block=5).block_bytes == 4


def test_a_procedure_that_the_icd_does_not_describe_is_unsupported(link):
    with pytest.raises(UnsupportedError, match="none"):
        Procedure(link, "none")
    with pytest.raises(UnsupportedError, match="number"):
        procedure_with(link).output("number")
    with pytest.raises(UnsupportedError, match="entries"):
        _ = procedure_with(link).entries


def test_the_length_of_a_block_is_that_of_the_request_without_another_step(link):
    steps = NextBlock(2), Send(1, b"\0", (Put(BYTE, Value(BLOCK_LENGTH, True)),))
    procedure = procedure_with(
        link, *steps, inputs=SIZE, values={"size": 3}, blocks=BLOCKS
    )
    assert procedure.next(0).data == b"\x03"
