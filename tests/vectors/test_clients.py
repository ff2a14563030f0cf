"""Scripts of clients on buses have the events, at the times, that their purpose states."""

from __future__ import annotations

from functools import cache
from random import Random

import pytest

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of_node
from icdgen.runtime_objects.scripts import client
from icdgen.vectors.wire import clients
from tests.conformance.icds import icd_of


@cache
def acp():
    """Return link and facts of the node."""
    icd = icd_of()
    node = icd.node("cubeacp")
    return link_of_node(icd, node), facts.of(icd, node)


@cache
def all_scripts():
    return dict(clients.scripts(*acp()))


def run_script(why):
    """Return time and name of each event, and the number of transmissions."""
    script = all_scripts()[why]
    steps = client(acp()[0], script)["steps"]
    events = [
        f"{row['at']} {event['event']}"
        for row, step in zip(script["script"], steps, strict=True)
        for event in step["events"]
    ]
    return events, sum(len(step["out"]) for step in steps)


# Retries after 100 ms, at most 2; late responses are awaited for 100 ms.
UART = {
    "a telecommand and its acknowledge": ("30 done, 40 done", 2),
    "refused with a code that has no name": ("30 refused", 1),
    "the next before the acknowledge": ("30 done", 1),
    "no acknowledge": ("100 timeout, 102 done", 2),
    "no acknowledge, and it may be repeated": ("300 timeout", 3),
    "a late acknowledge is not that of the next with the same id": (
        "120 done, 130 late, 230 timeout, 230 late", 3,
    ),
    "after a late acknowledge another id need not wait": (
        "120 done, 130 late, 140 done", 3,
    ),
    "a late acknowledge confirms nothing after another request has ended": (
        "100 timeout, 102 done, 120 late, 130 refused", 3,
    ),
    "a late frame that is damaged is still awaited": ("3 length, 4 late, 5 done", 2),
    "an unexpected acknowledge": ("0 stray, 2 stray, 3 done", 1),
    "the acknowledge of another telecommand": ("1 stray, 2 done", 1),
    "a frame": ("30 done", 1),
    "the longest frame and the longest telecommand": ("90 done", 2),
    "a frame that comes in pieces, after noise": ("4 done", 1),
    "a frame that comes at the third try": ("250 done", 3),
    "a frame that never comes": ("300 timeout", 3),
    "time stands still, then jumps": ("5001 done", 2),
    "a frame that is too long": ("1 length, 2 done", 1),
    "a frame that was not asked for": ("1 stray, 2 done", 1),
    "errors in the stream": (
        "1 protocol_error, 2 empty, 3 unexpected_start, 3 done", 1,
    ),
    "cancelled: its acknowledge is unexpected, and another id need not wait": (
        "6 late, 7 done", 2,
    ),
    "cancelled, and the same id again": ("7 late, 199 timeout, 201 late", 2),
    "cancelled while it is delayed": ("201 done", 2),
    "cancelled twice, and with nothing to cancel": ("501 done", 2),
    "a setting is repeated": ("110 done", 2),
    "not acknowledged": ("0 sent, 0 sent, 9 done", 3),
    "a reset": ("0 sent, 5 stray", 1),
    "an unknown id": ("", 0),
    "a wrong length": ("", 0),
    "download packets": ("0 arrived, 0 arrived", 0),
    "an unsolicited log while a reply is awaited": ("1 log, 2 done", 1),
}  # fmt: skip


@pytest.mark.parametrize("why", UART)
def test_a_client_on_the_uart_reports_what_the_purpose_states(why):
    expected, transmissions = UART[why]
    assert run_script(f"UART: {why}") == (
        expected.split(", ") if expected else [],
        transmissions,
    )


def test_each_reason_of_a_refusal_has_a_script():
    for reason in acp()[1].reasons:
        assert run_script(f"UART: refused: {reason}") == (["30 refused"], 1)


def test_a_client_remembers_a_limited_number_of_late_frames():
    head = (
        "UART: more late frames than a client remembers: the next request waits until"
    )
    cancelled, last = run_script(f"{head} one is forgotten"), 205
    assert cancelled == ([f"{last} done"], 9)
    forgotten = all_scripts()[f"{head} one is forgotten"]
    steps = client(acp()[0], forgotten)["steps"]
    rows = zip(forgotten["script"], steps, strict=True)
    sent = [row["at"] for row, step in rows if step["out"]]
    # Eight requests are sent at once, the ninth when one is forgotten.
    assert sent[-1] == 200
    assert run_script(f"{head} one has arrived")[0] == ["90 late", f"{last} done"]


def test_a_wrong_checksum_is_sent_again_until_the_retries_are_used():
    again = "UART with checksum: sent again after a wrong checksum"
    assert run_script(again) == (["2 done"], 2)
    always = "UART with checksum: always a wrong checksum"
    assert run_script(always) == (["3 refused", "4 stray"], 3)


I2C = {
    "a telecommand, polled until it is processed": ("23 done", 3),
    "the acknowledge is still that of another telecommand": ("23 done", 3),
    "never processed": (
        "55 timeout, 56 stray, 67 stray, 78 stray, 89 stray, 100 stray", 5,
    ),
    "polling fails once": ("23 done", 3),
    "the write fails": ("1 timeout", 1),
    "the write fails, and it may be repeated": ("23 timeout", 3),
    "the driver says nothing": ("320 timeout", 3),
    "a frame": ("1 done", 1),
    "a frame of the wrong length, then the right one": ("1 length, 12 done", 2),
    "not acknowledged": ("1 sent, 3 sent", 2),
    "a transfer that was not asked for": ("0 stray", 0),
    "a frame that takes longer than its request waits": ("101 late, 112 done", 2),
    "a frame that is sent for again before the first has come": (
        "111 late, 112 done", 2,
    ),
    "a write that comes late does not write the reset that follows": (
        "100 timeout, 102 late, 103 sent", 2,
    ),
    "more transfers than requested": ("1 done, 2 stray, 4 done", 2),
}  # fmt: skip


@pytest.mark.parametrize("why", I2C)
def test_a_client_on_i2c_reports_what_the_purpose_states(why):
    expected, transmissions = I2C[why]
    for bus in ("I2C", "I2C with checksum"):
        assert run_script(f"{bus}: {why}") == (expected.split(", "), transmissions)


def test_outcomes_on_i2c_are_those_of_the_polled_telemetry():
    for reason in acp()[1].reasons:
        assert run_script(f"I2C: outcome {reason}") == (["12 refused"], 2)
    assert run_script("I2C: outcome none") == (["12 done"], 2)
    # With a checksum, a damaged telecommand is sent again at once.
    assert run_script("I2C with checksum: outcome checksum") == ([], 3)
    wrong = "I2C with checksum: a frame with a wrong checksum"
    assert run_script(wrong) == (["1 checksum", "12 stray"], 2)


CAN = {
    "a telecommand and its acknowledge": "5 done",
    "a long telecommand": "5 done",
    "refused": "5 refused",
    "a request refused": "5 refused",
    "a frame": "5 done",
    "a long frame": "5 done",
    "a long frame, turned round": "5 done",
    "a lost packet, and the repeated frame": "105 done",
    "a frame that is too short": "5 length",
    "from another node": "5 stray, 6 done",
    "to somebody else": "",
    "no reply": "300 timeout",
    "an unexpected acknowledge": "0 stray",
    "cancelled: its acknowledge is unexpected": "3 late, 4 done",
    "a late acknowledge confirms nothing after another request has ended": (
        "100 timeout, 102 refused, 120 late, 130 refused"
    ),
    "not acknowledged": "0 sent, 0 sent",
}


@pytest.mark.parametrize("why", CAN)
def test_a_client_on_can_reports_what_the_purpose_states(why):
    expected = CAN[why]
    assert run_script(f"CAN: {why}")[0] == (expected.split(", ") if expected else [])
    assert all_scripts()[f"CAN: {why}"]["address"] == 0x42


def test_a_sample_has_a_message_of_each_kind():
    link, acp_facts = acp()
    sample = clients.BusSample(link, acp_facts, Random(1))
    sent = acp_facts.telecommands.values()
    acknowledged = [m for m in sent if m.acknowledge and m.kind != "configuration"]
    # The longest that fits into a packet of CAN.
    short = [m.length for m in acknowledged if m.length <= 8]
    assert sample.plain.acknowledge and sample.plain.length == max(short)
    assert sample.long.length == max(m.length for m in sent)
    assert sample.setting.kind == "configuration"
    assert not sample.silent.acknowledge and not sample.silent.expects_reset
    assert sample.reset.expects_reset
    assert sample.wide.length == max(m.length for m in acp_facts.telemetry.values())
    assert sample.frame is next(m for m in acp_facts.telemetry.values() if m.length > 1)


def test_without_telecommands_or_telemetry_there_are_no_scripts():
    for key in ("telecommands", "telemetry"):
        empty = type(
            "Empty", (), {"telecommands": {1: 1}, "telemetry": {1: 1}, key: {}}
        )
        assert list(clients.scripts(acp()[0], empty)) == []
