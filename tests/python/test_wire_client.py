"""The client: whatever happens on the bus, it does what the reference does, and a
program can rely on the outcome.
"""

from __future__ import annotations

import json

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from icdgen.protocol import can, crc, uart
from icdgen.protocol.sections import CAN_KINDS, CAN_WITH_DATA
from icdgen.runtime_objects import reference
from tests.python import packages
from tests.python.wire import NOISE, known, link

OURS = 0x42
TELECOMMANDS, TELEMETRY = [1, 2, 7, 31, 37], [128, 144, 146, 240]
QUICK = {"reply_timeout": 100, "retries": 2, "poll_interval": 10, "poll_timeout": 50}


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


@st.composite
def asked(draw) -> dict:
    """A request that a script begins."""
    if draw(st.booleans()):
        return {"telemetry": draw(st.sampled_from([*TELEMETRY, 5]))}
    id = draw(st.sampled_from([*TELECOMMANDS, 200]))
    length = (
        known().telecommands[id].length
        if id in TELECOMMANDS and draw(st.integers(0, 9))
        else 3
    )
    return {
        "telecommand": id,
        "bytes": draw(st.binary(min_size=length, max_size=length)).hex(),
        "repeat": draw(st.booleans()),
    }


def frame_of(draw) -> tuple[int, bytes]:
    id = draw(st.sampled_from(TELEMETRY))
    length = known().telemetry[id].length + (1 if not draw(st.integers(0, 7)) else 0)
    if id == 240:  # tells what became of a telecommand
        return id, bytes(
            (
                draw(st.sampled_from(TELECOMMANDS)),
                draw(st.integers(0, 1)),
                draw(st.integers(0, 5)),
                9,
            )
        )
    return id, draw(st.binary(min_size=length, max_size=length))


@st.composite
def from_uart(draw) -> dict:
    if draw(st.booleans()):
        message = bytes(
            (
                draw(st.sampled_from(TELECOMMANDS)),
                draw(st.sampled_from([0, 0, 1, 4, 77])),
            )
        )
    else:
        id, frame = frame_of(draw)
        message = bytes((id,)) + frame
    line = uart.encode(known().framing, message)
    place = draw(st.integers(0, len(line)))
    pieces = [
        draw(NOISE) + line,
        line,
        line,
        line[:place],
        line[place:],
        draw(NOISE),
        bytes((119,)) + bytes(22),
    ]
    return {"receive": draw(st.sampled_from(pieces)).hex()}


@st.composite
def from_i2c(draw) -> dict:
    _, frame = frame_of(draw)
    sum_ = crc.compute(known().checksum.crc, frame)
    checked = frame + bytes((sum_ if draw(st.integers(0, 5)) else sum_ ^ 1,))
    given = draw(st.sampled_from([None, b"", b"", frame, checked]))
    return {"receive": None if given is None else given.hex()}


@st.composite
def from_can(draw) -> dict:
    kind = draw(st.sampled_from(CAN_KINDS))
    if kind in CAN_WITH_DATA:
        id, data = frame_of(draw)
    else:
        id, data = draw(st.sampled_from(TELECOMMANDS + TELEMETRY)), b""
    packets = can.split(
        known(), can.Message(kind, id, draw(st.sampled_from([1, 1, 1, 9])), OURS, data)
    )
    packet = draw(st.sampled_from(packets))
    return {"receive": {"id": packet.id, "bytes": packet.data.hex()}}


@st.composite
def scripts(draw) -> dict:
    bus = draw(st.sampled_from(["uart", "i2c", "can"]))
    heard = {"uart": from_uart(), "i2c": from_i2c(), "can": from_can()}[bus]
    rows, now = [], 0
    for row in draw(
        st.lists(
            asked() | heard | heard | st.just({}) | st.just({"cancel": True}),
            max_size=25,
        )
    ):
        now += draw(st.sampled_from([0, 1, 5, 10, 49, 60, 100, 150]))
        rows.append({"at": now, **row})
    return {"op": "client", "node": "cubeacp", "bus": bus, "crc": draw(st.booleans()), "address": OURS, "settings": QUICK,
            "script": rows}  # fmt: skip


@given(request=scripts())
@settings(max_examples=300, suppress_health_check=[HealthCheck.too_slow])
def test_whatever_happens_it_does_what_the_reference_does(shipped, request):
    made = shipped.answer(json.dumps(request).encode())
    assert made == reference.answer(packages.shipped(), request)


def acknowledge(like, wire, id: int, code: int = 0) -> bytes:
    return wire.uart_encode(like, bytes((id, code)))


def test_typed_telemetry(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    assert client.request(0, acp.EstimatedAttitudeAngles) == []
    assert (client.output(), client.busy, client.deadline) == (
        b"\x1f\x7f\x92\x1f\xff",
        True,
        1000,
    )
    angles = acp.EstimatedAttitudeAngles(estimated_roll_angle=-1234)
    (done,) = client.received(
        30, wire.uart_encode(acp.LINK, b"\x92" + angles.to_bytes())
    )
    assert done == wire.Done(146, 1, angles.to_bytes(), acp.EstimatedAttitudeAngles)
    assert done.message == angles
    assert (client.busy, client.deadline, client.output()) == (False, None, b"")


def test_settings_are_written_by_one_id_and_read_by_the_other(shipped, wire):
    acp = shipped.module("cubeacp")
    setting = acp.SdLog1Configuration()
    set_id, get_id = setting.IDS
    client = wire.Client(acp.LINK, "uart")
    client.send(0, setting)
    (sent,) = wire.UartDecoder(acp.LINK).feed(client.output())
    assert sent.message[0] == set_id
    client.received(1, acknowledge(acp.LINK, wire, set_id))
    client.request(2, type(setting))
    assert wire.UartDecoder(acp.LINK).feed(client.output())[0].message == bytes(
        (get_id,)
    )


def test_a_request_while_another_one_goes_on_is_refused(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    client.request(0, acp.Identification)
    with pytest.raises(wire.BusyError):
        client.request(1, acp.Identification)
    client = wire.Client(acp.LINK, "uart")
    client.send(0, acp.Reset())  # not acknowledged: over at once, but not sent
    assert not client.busy
    with pytest.raises(wire.BusyError):
        client.request(0, acp.Identification)
    client.output()
    client.request(0, acp.Identification)


def test_messages_of_another_node_are_refused(shipped, wire):
    acp, bootloader, errors = (
        shipped.module("cubeacp"),
        shipped.module("bootloader"),
        shipped.module(),
    )
    client = wire.Client(acp.LINK, "uart")
    for call, message in (
        (client.request, bootloader.State),
        (client.send, bootloader.SetBootIndex()),
    ):
        with pytest.raises(
            errors.UnknownIdError,
            match=r"cubeacp has no tele\w+ '.*': it is a message of bootloader",
        ):
            call(0, message)
    with pytest.raises(
        errors.UnknownIdError, match="'Reset': it is a telecommand: send it"
    ):
        client.request(0, acp.Reset)
    with pytest.raises(
        errors.UnknownIdError, match="Angles': it is telemetry: request it"
    ):
        client.send(0, acp.EstimatedAttitudeAngles())
    with pytest.raises(errors.RangeError):
        client.send(0, acp.SetAdcsRunMode(enabled=300))


def test_a_message_in_the_place_of_its_class_is_told_of_and_the_other_way_round(
    shipped, wire
):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    with pytest.raises(TypeError, match=r"a class: State, not State\(\.\.\.\)"):
        client.request(0, acp.State())
    with pytest.raises(TypeError, match=r"a message: Reset\(\.\.\.\), not the class"):
        client.send(0, acp.Reset)


def test_what_comes_unasked_is_told(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    log = wire.LogMessage.encode(acp.LINK, bytes(10), [])
    packet = bytes((119, 5, 0)) + bytes(range(20))
    stream = b"".join(
        wire.uart_encode(acp.LINK, one) for one in (log, packet, b"\x1f\x00")
    )
    events = client.received(0, stream + b"\x1f\x7f\x80\x1f\x00")
    assert [type(event) for event in events] == [
        wire.Log,
        wire.Packet,
        wire.Stray,
        wire.LineError,
    ]
    assert (events[0].log.frames, events[1].number, events[1].data) == (
        (),
        5,
        bytes(range(20)),
    )
    assert events[3] == wire.LineError("protocol_error")


def test_a_bus_that_the_icd_does_not_describe_is_refused(shipped, wire):
    like = link(shipped)._replace(framing=None, can=None, i2c_address=None)
    for bus in ("uart", "can", "i2c"):
        with pytest.raises(wire.UnsupportedError, match=bus):
            wire.Client(like, bus)
    with pytest.raises(
        wire.UnsupportedError, match="'uart', 'can' or 'i2c', not 'UART'"
    ):
        wire.Client(link(shipped), "UART")


def test_i2c_polls_until_the_telecommand_is_processed(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "i2c")
    client.send(0, acp.SetAdcsRunMode(enabled=1))
    assert client.transfers() == [wire.I2cTransfer(b"\x0a\x01", 0)]
    assert client.transferred(1, b"") == []
    for now, processed in ((21, 0), (41, 1)):
        assert client.deadline == now
        client.tick(now)
        assert client.transfers() == [wire.I2cTransfer(b"\xf0", 4)]
        events = client.transferred(now, bytes((10, processed, 0, 0)))
    assert events == [wire.Done(10, 1)]


def test_a_wrong_checksum_is_sent_again(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart", crc=True)
    client.send(0, acp.SetAdcsRunMode(enabled=1))
    sent = client.output()
    assert wire.UartDecoder(acp.LINK).feed(sent)[0].message == wire.i2c_write(
        acp.LINK, 10, b"\x01", crc=True
    )
    assert client.received(5, acknowledge(acp.LINK, wire, 10, 4)) == []
    assert client.output() == sent
    assert client.received(9, acknowledge(acp.LINK, wire, 10)) == [wire.Done(10, 2)]
