"""`icdgen send`: the text, the JSON and the exit status of each outcome, without a
port.
"""

from __future__ import annotations

import json
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from icdgen_runtime.wire.events import Busy, Done, Refused, Sent, Timeout

from icdgen.commands import send as command
from icdgen.errors import UserError
from tests.conftest import ROOT

WHEEL = ROOT / "examples" / "links" / "wheel.yaml"
SPEED = ("wheel", "Set Speed", "speed=100")
TELECOMMANDS = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Reset
    id: 7
    kind: telecommand
    acknowledge: reset
    length: 1
    fields: [{at: 0, bits: 8, name: Magic, type: uint, const: 0x5A}]
  - {name: Ping, id: 8, kind: telecommand, length: 0}
  - {name: Shout, id: 9, kind: telecommand, acknowledge: false, length: 0}
  - {name: Fire, id: 10, kind: telecommand, hazard: It burns., length: 0}
"""


@pytest.fixture
def send(icdgen, monkeypatch):
    """Return a function that sends with the given outcome; ``.sent`` has the requests
    and the options of the session.
    """

    def run(outcome: object, *words: object):
        @contextmanager
        def open_session(icd, facts, **options):
            run.sent.append(options)
            yield SimpleNamespace(
                start=lambda request: run.sent.append(request) or outcome
            )

        monkeypatch.setattr(command, "open_session", open_session)
        return icdgen("send", *words, "--port", "tcp://x:1")

    run.sent = []
    return run


def wheel(send, outcome: object, *words: object):
    return send(outcome, *(words or SPEED), "--icd", WHEEL)


UNKNOWN = "whether it was executed is not known"


@pytest.mark.parametrize(
    ("outcome", "status", "text"),
    [
        (Done(2, 1), 0, "acknowledged"),
        (Sent(2, 1), 0, "sent; the ICD describes no response to it"),
        (Refused(2, 1), 1, "refused"),
        (Refused(2, 1, 3, "Out of range"), 1, "refused: Out of range (code 3)"),
        (Refused(2, 1, 0), 1, "refused: unknown error (code 0)"),
        (Timeout(2, 1), 3, f"no answer; {UNKNOWN}"),
        (Timeout(2, 2), 3, f"no answer after 2 attempts; {UNKNOWN}"),
        (Busy(2, 1), 4, "busy"),
        (Busy(2, 3, 0), 4, "busy after 3 attempts"),
        (Busy(2, 3, 5, "Full"), 4, "busy: Full (code 5) after 3 attempts"),
    ],
)
def test_each_outcome_has_its_text_and_its_exit_status(send, outcome, status, text):
    result = wheel(send, outcome)
    shown, other = (result.err, result.out) if status else (result.out, result.err)
    assert (result.status, shown, other) == (status, f"Set Speed: {text}\n", "")


def response(name: str) -> type:
    return type("Response", (), {"NAME": name})


def test_a_response_confirms_or_answers_and_shows_its_further_fields(send):
    done = Done(2, 1, b"\2", response("Ack"), 0x06)
    assert wheel(send, done).out == "Set Speed: acknowledged with Ack\n"
    events = Done(4, 1, b"\1\2", response("Events"), 0x83)
    first, *lines = wheel(send, events, "wheel", "Get Events").out.splitlines()
    assert first == "Get Events: answered with Events"
    assert lines[0] == "wheel: Events (telemetry 131), 2 bytes"
    assert lines[-1].split() == ["Count", "258", "258"]
    unnamed = Done(4, 1, b"\1\2", None, 0x83)
    assert wheel(send, unnamed, "wheel", "Get Events").out == (
        "Get Events: answered with an unknown message\n"
    )


def test_json_has_the_outcome_and_goes_to_standard_output(send):
    refused = Refused(2, 1, 3, "Out of range", None, b"\2\3", response("Nak"))
    result = wheel(send, refused, *SPEED, "--format", "json")
    assert (result.status, result.err) == (1, "")
    report = json.loads(result.out)
    assert report.pop("response")["message"] == "Nak"
    assert report == {
        "message": "Set Speed",
        "event": "refused",
        "reason": "Out of range",
        "code": 3,
        "attempts": 1,
    }
    assert result.out.count("\n") == 1


def test_the_telecommand_is_sent_with_its_id_and_data(send):
    wheel(send, Done(2, 1), "wheel", "Set Speed", "speed=7", "--raw")
    options, request = send.sent
    assert (request.kind, request.id, request.data) == ("telecommand", 2, b"\0\0\7")
    assert {key: options[key] for key in ("port", "crc", "address", "chosen")} == {
        "port": "tcp://x:1",
        "crc": False,
        "address": 0,
        "chosen": (),
    }
    assert (options["timeout"], options["retries"]) == (None, None)


def test_options_of_the_session_are_passed_on(send):
    wheel(
        send,
        Done(2, 1),
        *SPEED,
        "--crc",
        "--address",
        "5",
        "--timeout",
        "9",
        "--retries",
        "0",
        "--header",
        "a=1",
        "--header",
        "b=2",
    )
    options = send.sent[0]
    del options["on_event"]
    assert options == {
        "port": "tcp://x:1",
        "crc": True,
        "address": 5,
        "timeout": 9,
        "retries": 0,
        "chosen": ("a=1", "b=2"),
    }


@pytest.mark.parametrize(
    ("option", "value", "is_accepted"),
    [
        ("--timeout", 0, False),
        ("--timeout", 1, True),
        ("--retries", -1, False),
        ("--retries", 255, True),
        ("--retries", 256, False),
        ("--address", -1, False),
    ],
)
def test_options_of_the_session_have_limits(send, option, value, is_accepted):
    result = wheel(send, Done(2, 1), *SPEED, option, value)
    assert result.status == (0 if is_accepted else 2)
    assert bool(send.sent) is is_accepted


@pytest.fixture
def demo(tmp_path):
    file = tmp_path / "demo.yaml"
    file.write_text(TELECOMMANDS)
    return file


@pytest.mark.parametrize(
    ("outcome", "words", "text"),
    [
        (Done(8, 1), ("Ping",), "Ping: acknowledged"),
        (Sent(9, 1), ("Shout",), "Shout: sent; it is never acknowledged"),
        (
            Sent(7, 1),
            ("Reset",),
            "Reset with Magic 90 (0x5A): sent; the device restarts instead of acknowledging",
        ),
        (
            Sent(7, 1),
            ("Reset", "magic=1", "--raw"),
            "Reset with Magic 1: sent; the device need not restart, for Magic must be 90 (0x5A)",
        ),
    ],
)
def test_on_a_bus_the_icd_says_what_an_outcome_means(send, demo, outcome, words, text):
    result = send(outcome, *words, "--icd", demo)
    assert (result.status, result.err) == (0, "")
    assert result.out == f"{text}\n"


def test_a_hazard_needs_a_confirmation_before_the_port_is_opened(
    send, demo, monkeypatch
):
    result = send(Done(10, 1), "Fire", "--icd", demo)
    assert (result.status, result.out, send.sent) == (2, "", [])
    assert "Fire is dangerous: It burns." in result.err
    assert "--yes sends it without asking" in result.err
    assert send(Done(10, 1), "Fire", "--icd", demo, "--yes").status == 0
    assert len(send.sent) == 2
    for answer, status, count in ((False, 1, 0), (True, 0, 2)):
        send.sent.clear()
        monkeypatch.setattr(command, "_is_confirmed", lambda frame, a=answer: a)
        result = send(Done(10, 1), "Fire", "--icd", demo)
        assert (result.status, len(send.sent)) == (status, count)
        assert result.err == ("" if answer else "Fire: not sent\n")
    # A telecommand without a hazard is sent at once.
    monkeypatch.setattr(command, "_is_confirmed", lambda frame: False)
    assert send(Done(8, 1), "Ping", "--icd", demo).status == 0


def test_an_error_of_the_port_is_wrong_usage(icdgen, monkeypatch):
    @contextmanager
    def open_session(icd, facts, **options):
        raise UserError("no such port", "check it")
        yield

    monkeypatch.setattr(command, "open_session", open_session)
    result = icdgen("send", *SPEED, "--icd", WHEEL, "--port", "x")
    assert result.status == 2
    assert "no such port" in result.err and "check it" in result.err
