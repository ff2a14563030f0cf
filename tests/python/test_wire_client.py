"""`Client` handles requests of generated messages and reports the outcome of each.

The tests pass bytes, packets and times to the client, without a port.
"""

from __future__ import annotations

import pytest

from tests.python.wire import link


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


def acknowledge(like, wire, id: int, code: int = 0) -> bytes:
    return wire.uart_encode(like, bytes((id, code)))


def test_telemetry_is_requested_and_decoded_by_its_class(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    client.request(0, acp.EstimatedAttitudeAngles)
    assert (client.output(), client.busy, client.deadline) == (
        b"\x1f\x7f\x92\x1f\xff",
        True,
        1000,
    )
    angles = acp.EstimatedAttitudeAngles(estimated_roll_angle=-1234)
    (done,) = client.received(
        30, wire.uart_encode(acp.LINK, b"\x92" + angles.to_bytes())
    )
    assert done == wire.Done(
        146, 1, angles.to_bytes(), acp.EstimatedAttitudeAngles, 146
    )
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


def test_a_request_waits_until_the_previous_one_has_ended(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart", requests=2)
    client.request(0, acp.Identification)
    client.send(0, acp.SetAdcsRunMode(enabled=1))
    with pytest.raises(wire.BusyError):
        client.request(1, acp.State)
    assert client.output() and not client.output()
    data = acp.Identification().to_bytes()
    line = wire.uart_encode(acp.LINK, bytes((acp.Identification.ID,)) + data)
    (done,) = client.received(2, line)
    assert (type(done), done.handle) == (wire.Done, 1)
    assert client.output()
    (done,) = client.received(3, acknowledge(acp.LINK, wire, 10))
    assert (type(done), done.handle, client.busy) == (wire.Done, client.begun, False)


def test_a_telecommand_without_acknowledge_ends_when_it_is_sent(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart", requests=1)
    client.send(0, acp.Reset())
    with pytest.raises(wire.BusyError):
        client.request(0, acp.Identification)
    assert client.sent(client.begun) is None and client.output()
    assert client.sent(client.begun) == wire.Sent(acp.Reset.ID)
    client.request(0, acp.Identification)


def test_each_bus_has_its_own_output_and_input(shipped, wire):
    acp = shipped.module("cubeacp")
    outputs = {"uart": "output", "can": "packets", "i2c": "transfers"}
    inputs = {
        "uart": ("received", b""),
        "can": ("packet", wire.CanPacket(0, b"")),
        "i2c": ("transferred", None),
    }
    for bus, own in outputs.items():
        client = wire.Client(acp.LINK, bus)
        client.request(0, acp.Identification)
        for name in outputs.values():
            assert name == own or not getattr(client, name)()
        assert getattr(client, own)()
        for other, (name, received) in inputs.items():
            if other != bus:
                with pytest.raises(wire.UnsupportedError):
                    getattr(client, name)(1, received)


def test_features_of_another_kind_of_link_are_refused(shipped, wire):
    acp = shipped.module("cubeacp")
    with pytest.raises(wire.UnsupportedError, match="framed"):
        wire.Client(acp.LINK, "uart", values={"source": 1})
    with pytest.raises(wire.UnsupportedError, match="stream"):
        wire.Client(acp.LINK)
    with pytest.raises(wire.UnsupportedError, match="reply"):
        wire.Client(acp.LINK, "uart").send(0, acp.Reset(), reply=acp.State)


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


def test_the_error_explains_a_message_passed_instead_of_a_class_and_vice_versa(
    shipped, wire
):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    with pytest.raises(TypeError, match=r"a class: State, not State\(\.\.\.\)"):
        client.request(0, acp.State())
    with pytest.raises(TypeError, match=r"a message: Reset\(\.\.\.\), not the class"):
        client.send(0, acp.Reset)


def test_unsolicited_input_is_reported(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    log = wire.LogMessage.encode(acp.LINK, bytes(10), [])
    packet = bytes((119, 5, 0)) + bytes(range(20))
    stream = b"".join(
        wire.uart_encode(acp.LINK, data) for data in (log, packet, b"\x1f\x00")
    )
    events = client.received(0, stream + b"\x1f\x7f\x80\x1f\x00")
    assert [type(event) for event in events] == [
        wire.Log,
        wire.Arrived,
        wire.Stray,
        wire.LineError,
    ]
    assert events[0].log.frames == ()
    arrived = events[1].of(acp.FileDownloadBufferWithFileContents)
    assert (arrived.packet_counter, arrived.file_bytes) == (5, bytes(range(20)))
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
    (done,) = events
    assert (done.id, done.attempts, done.data) == (10, 1, b"\x0a\1\0\0")


def test_a_telecommand_with_a_wrong_checksum_is_repeated(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart", crc=True)
    client.send(0, acp.SetAdcsRunMode(enabled=1))
    sent = client.output()
    assert wire.UartDecoder(acp.LINK).feed(sent)[0].message == wire.i2c_write(
        acp.LINK, 10, b"\x01", crc=True
    )
    assert client.received(5, acknowledge(acp.LINK, wire, 10, 4)) == []
    assert client.output() == sent
    assert client.received(9, acknowledge(acp.LINK, wire, 10)) == [
        wire.Done(10, 2, b"\0")
    ]


def test_two_requests_are_in_flight_if_the_device_supports_it(shipped, wire):
    acp = shipped.module("cubeacp")
    settings = acp.LINK.settings._replace(in_flight=2)
    client = wire.Client(acp.LINK, "uart", settings=settings)
    client.request(0, acp.EstimatedAttitudeAngles)
    client.request(0, acp.EstimatedAttitudeAngles)  # its reply could be the first one
    assert client.output() and not client.output()
    client.cancel(handle=client.begun)
    client.send(1, acp.SetAdcsRunMode(enabled=1))
    client.request(1, acp.EstimatedAngularRates)
    assert client.output() and not client.output()
    (done,) = client.received(2, acknowledge(acp.LINK, wire, 10))
    assert (done.id, done.handle) == (10, 3)
    assert client.output()
    (done,) = client.received(3, wire.uart_encode(acp.LINK, b"\x92" + bytes(6)))
    assert (done.id, done.handle) == (146, 1)


def test_i2c_results_are_matched_to_requests_in_the_order_of_transactions(
    shipped, wire
):
    acp = shipped.module("cubeacp")
    settings = acp.LINK.settings._replace(in_flight=3)
    client = wire.Client(acp.LINK, "i2c", settings=settings)
    client.send(0, acp.SetAdcsRunMode(enabled=1))
    client.request(0, acp.EstimatedAttitudeAngles)
    client.request(0, acp.EstimatedAttitudeAngles)
    assert [transfer.write[0] for transfer in client.transfers()] == [10, 146, 146]
    assert client.transferred(1, b"") == []
    (first,) = client.transferred(1, bytes([1, *bytes(5)]))
    assert (first.handle, first.data[0]) == (2, 1)
    client.tick(21)
    assert [transfer.write[0] for transfer in client.transfers()] == [240]
    (second,) = client.transferred(22, bytes([2, *bytes(5)]))
    assert (second.handle, second.data[0]) == (3, 2)
    (done,) = client.transferred(23, bytes((10, 1, 0, 0)))
    assert (done.id, done.handle, client.busy) == (10, 1, False)


def test_the_deadline_of_a_waiting_request_is_that_of_a_late_response_with_its_id(
    shipped, wire
):
    acp = shipped.module("cubeacp")
    settings = acp.LINK.settings._replace(reply_timeout=100, late=100)
    client = wire.Client(acp.LINK, "uart", settings=settings)
    for now, message in (
        (0, acp.EstimatedAttitudeAngles),
        (50, acp.EstimatedAngularRates),
    ):
        client.request(now, message)
        assert client.output()
        client.cancel()
    client.request(60, acp.EstimatedAngularRates)
    assert client.output() == b"" and client.deadline == 250
    client.tick(250)
    assert client.output()
