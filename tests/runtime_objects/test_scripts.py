"""Scripts of clients: each row gives exactly its output, its events and the deadline."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire import events

from icdgen.runtime_objects.refusals import Refusal
from icdgen.runtime_objects.scripts import MOST_REQUESTS, _row, client, stream_client
from tests.limits import assert_limits
from tests.runtime_objects.test_operations import LINK, WHEEL, wheel_packet

SET, FRAME = "1f7f11010203040506", "1f7f922efb0a0000001fff"
TIMEOUT = LINK.settings.reply_timeout


def uart(*script: dict, **request) -> list[dict]:
    return client(LINK, {"bus": "uart", "script": list(script), **request})["steps"]


def wheel(*script: dict, **request) -> list[dict]:
    return stream_client(WHEEL, {"script": list(script), **request})["steps"]


def is_accepted(run, *script: dict, **request) -> bool:
    try:
        run(*script, **request)
    except Refusal:
        return False
    return True


def test_a_request_on_a_uart_has_an_output_a_deadline_and_an_end():
    steps = uart(
        {"at": 10, "telemetry": 146},
        {"at": 20, "receive": FRAME[:8]},
        {"at": 30, "receive": FRAME[8:]},
        {"at": 40},
    )
    assert steps == [
        {"out": ["1f7f921fff"], "events": [], "deadline": 10 + TIMEOUT},
        {"out": [], "events": [], "deadline": 10 + TIMEOUT},
        {
            "out": [],
            "events": [
                {"event": "done", "id": 146, "attempts": 1, "bytes": "2efb0a000000"}
            ],
            "deadline": None,
        },
        {"out": [], "events": [], "deadline": None},
    ]


def test_a_refused_telecommand_has_its_code_and_the_parameter():
    sent, refused = uart(
        {"at": 0, "telecommand": 17, "bytes": "010203040506"},
        {"at": 5, "receive": "1f7f11031fff"},
    )
    assert sent["out"] == [f"{SET}1fff"]
    assert refused["events"] == [
        {"event": "refused", "id": 17, "attempts": 1, "code": 3, "parameter": None}
    ]


def test_output_that_is_not_taken_comes_with_the_next_step():
    steps = uart({"at": 0, "telemetry": 146, "untaken": True}, {"at": 1})
    assert [step["out"] for step in steps] == [[], ["1f7f921fff"]]


def test_a_timeout_before_received_bytes_is_processed_first():
    late = {"at": TIMEOUT, "receive": FRAME}
    first, second = uart({"at": 0, "telemetry": 146}, late)
    assert first["out"] == ["1f7f921fff"]
    assert second["out"] == ["1f7f921fff"]
    (event,) = second["events"]
    assert (event["event"], event["attempts"]) == ("done", 2)


def test_settings_of_a_script_replace_those_of_the_icd():
    for settings, deadline in (({}, TIMEOUT), ({"reply_timeout": 7}, 7)):
        (step,) = uart({"at": 0, "telemetry": 146}, settings=settings)
        assert step["deadline"] == deadline
    steps = uart(
        {"at": 0, "telemetry": 146},
        {"at": 7},
        settings={"reply_timeout": 7, "retries": 0},
    )
    assert steps[1]["events"] == [{"event": "timeout", "id": 146, "attempts": 1}]
    with pytest.raises(Refusal) as refusal:
        uart(settings=[])
    assert refusal.value.details["detail"] == "`settings` is no object"
    assert not is_accepted(uart, settings={"retries": "1"})


def test_one_request_is_in_progress_on_a_bus():
    _, second = uart({"at": 0, "telemetry": 146}, {"at": 1, "telemetry": 146})
    assert (second["error"], second["out"], second["events"]) == ("busy", [], [])
    _, cancelled, again = uart(
        {"at": 0, "telemetry": 146},
        {"at": 1, "cancel": True},
        {"at": 2, "telemetry": 144},
    )
    assert (cancelled["events"], cancelled["deadline"]) == ([], None)
    assert again["out"] == ["1f7f901fff"]


def test_errors_of_a_request_are_members_of_its_step():
    unknown, short = uart(
        {"at": 0, "telemetry": 99}, {"at": 1, "telecommand": 17, "bytes": "01"}
    )
    assert unknown == {"error": "unknown-id", "out": [], "events": [], "deadline": None}
    assert (short["error"], short["expected"], short["actual"]) == ("length", 6, 1)


def test_ids_have_one_byte_on_a_bus_and_32_bits_on_a_framed_link():
    assert_limits(
        lambda n: is_accepted(uart, {"at": 0, "telemetry": n}), least=0, most=255
    )
    assert_limits(
        lambda n: is_accepted(wheel, {"at": 0, "telecommand": n, "bytes": ""}),
        least=0,
        most=0xFFFFFFFF,
    )


def test_addresses_and_numbers_of_requests_are_limited():
    for bus in ("uart", "i2c", "can"):
        assert_limits(
            lambda n, bus=bus: is_accepted(uart, address=n, bus=bus), least=0, most=255
        )
    assert not is_accepted(uart, bus="spi")
    assert MOST_REQUESTS == 3
    assert_limits(lambda n: is_accepted(wheel, requests=n), least=1, most=3)


def test_a_telecommand_that_nothing_responds_to_is_sent_on_each_bus():
    id, command = next(
        (id, row) for id, row in LINK.commands.items() if not row.acknowledged
    )
    request = {"at": 0, "telecommand": id, "bytes": bytes(command.length).hex()}
    for bus in ("uart", "can"):
        (step,) = uart(request, bus=bus)
        assert step["events"] == [{"event": "sent", "id": id, "attempts": 1}]
        assert step["out"] != []
        (step,) = uart(request | {"untaken": True}, bus=bus)
        assert (step["events"], step["out"]) == ([], [])


def test_a_can_client_sends_and_receives_packets():
    sent, done = uart(
        {"at": 0, "telemetry": 146},
        {"at": 1, "receive": {"id": 0x05920105, "bytes": "2efb0a000000"}},
        bus="can",
        address=5,
    )
    assert sent["out"] == [{"id": 0x04920501, "bytes": ""}]
    assert done["events"][0]["bytes"] == "2efb0a000000"
    with pytest.raises(Refusal) as refusal:
        uart({"at": 0, "receive": "00"}, bus="can")
    assert refusal.value.details["detail"] == "`receive` is no packet"


def test_an_i2c_client_writes_and_reads():
    sent, done = uart(
        {"at": 0, "telemetry": 146},
        {"at": 1, "receive": "2efb0a000000"},
        bus="i2c",
    )
    assert sent["out"] == [{"write": "92", "read": 6}]
    assert done["events"][0]["bytes"] == "2efb0a000000"
    _, failed = uart({"at": 0, "telemetry": 146}, {"at": 1, "receive": None}, bus="i2c")
    assert failed["events"] == []


def test_a_framed_client_names_the_reply_and_handles_several_requests():
    first, second, third = wheel(
        {"at": 0, "telecommand": 4, "bytes": ""},
        {"at": 1, "telecommand": 5, "bytes": ""},
        {"at": 2, "receive": wheel_packet("02830102")},
        requests=2,
    )
    assert first["out"] == [wheel_packet("0004")]
    assert "error" not in second
    assert {
        "event": "done",
        "id": 4,
        "attempts": 1,
        "reply": 0x83,
        "bytes": "0102",
    } in third["events"]
    assert (
        wheel(
            {"at": 0, "telecommand": 4, "bytes": ""},
            {"at": 1, "telecommand": 5, "bytes": ""},
        )[1]["error"]
        == "busy"
    )


@pytest.mark.parametrize(
    ("event", "expected"),
    [
        (events.LineError("checksum", 5), {"event": "checksum", "id": 5}),
        (events.LineError("overrun", None), {"event": "overrun"}),
        (
            events.Arrived(5, b"\1", {"sequence": 7}),
            {"event": "message", "id": 5, "bytes": "01", "sequence": 7},
        ),
        (events.Gap(5, 3), {"event": "gap", "id": 5, "missing": 3}),
        (events.Log(b"\2", None), {"event": "log", "bytes": "02"}),
        (events.Timeout(5, 3), {"event": "timeout", "id": 5, "attempts": 3}),
        (events.Sent(5, 1), {"event": "sent", "id": 5, "attempts": 1}),
    ],
)
def test_an_event_is_a_mapping_with_its_name(event, expected):
    assert _row(event) == expected
