"""Random scripts of the client of framed links: all languages report the outcomes of
the reference implementation, and every request ends.
"""

from __future__ import annotations

import random
from itertools import islice

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.events import OUTCOMES

from icdgen.protocol import facts
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of
from tests.conformance import outcomes
from tests.conformance.build import build
from tests.conformance.driver import Testee
from tests.conformance.icds import icd_of
from tests.conformance.languages import all_languages

SCRIPTS = 1500
WAITS = 100  # more than the number of attempts of all requests of a script


@pytest.fixture(scope="module")
def icd():
    return icd_of(outcomes.EXAMPLES)


@pytest.fixture(scope="module")
def cases(icd):
    return outcomes.cases(icd, 1, SCRIPTS)


def test_the_scripts_lead_to_all_events_and_errors(cases):
    steps = [step for _, answer in cases for step in answer["steps"]]
    kinds = {event["event"] for step in steps for event in step["events"]}
    outcome = {"done", "sent", "refused", "busy", "timeout"}
    assert kinds >= outcome | {"progress", "reply", "late", "stray", "message", "gap"}
    errors = {step["error"] for step in steps if "error" in step}
    assert errors == {"busy", "length", "unknown-id", "unsupported"}


@pytest.mark.parametrize("name", ["python", "c-sanitizers", "rust-debug"])
def test_a_language_reports_the_outcomes_of_the_reference(icd, cases, name):
    testee = Testee(build(all_languages()[name], icd))
    assert list(outcomes.differences(testee, cases)) == []
    assert testee.close() == 0, testee.complaint()


@pytest.mark.parametrize("name", ["c-sanitizers", "rust-debug"])
def test_a_clock_of_32_bits_may_wrap_around(icd, cases, name):
    testee = Testee(build(all_languages()[name], icd))
    shifted = [(later(request), later(answer)) for request, answer in cases[:300]]
    assert list(outcomes.differences(testee, shifted)) == []
    assert testee.close() == 0, testee.complaint()


def later(script):
    """Return a script, or its answer, with times that pass 0 after a second."""
    if isinstance(script, list):
        return [later(row) for row in script]
    if not isinstance(script, dict):
        return script
    return {
        key: (
            (value - 1000) % 2**32
            if key in ("at", "deadline") and value is not None
            else later(value)
        )
        for key, value in script.items()
    }


def test_every_request_ends_once_if_tick_is_called_at_the_deadline(icd):
    for script in islice(outcomes.requests(icd, random.Random(2)), SCRIPTS):
        link = link_of(icd, facts.of(icd, icd.node(script["node"])))
        settings = link.settings._replace(**script["settings"])
        client = Client(link, settings=settings, requests=script["requests"])
        ended, now = 0, 0
        for row in script["script"]:
            now = row["at"]
            ended += number_of_ends(client, now, row)
            while not row.get("untaken") and client.output():
                pass
        for _ in range(WAITS):
            while client.output():
                pass
            if not client.busy:
                break
            assert client.deadline is not None, script
            now = max(now, client.deadline)
            ended += number_of_ends(client, now, {})
        assert not client.busy and ended == client.begun, script


def number_of_ends(client, now, row):
    """Return how many requests end in a row of a script, also by cancelling."""
    reported = []
    try:
        if "cancel" in row:
            before = len(client._slots)
            kind = next(
                (key for key in ("telecommand", "telemetry") if key in row), None
            )
            client.cancel(kind, row.get(kind))
            return before - len(client._slots)
        if "telecommand" in row:
            data, repeat = bytes.fromhex(row["bytes"]), row.get("repeat", False)
            request = Request("telecommand", row["telecommand"], data, repeat)
            client.start(now, request, row.get("reply"))
        elif "telemetry" in row:
            client.start(now, Request("telemetry", row["telemetry"]))
        elif "receive" in row:
            reported = client.received(now, bytes.fromhex(row["receive"]))
        else:
            reported = client.tick(now)
    except ValueError:
        pass  # the request did not start
    return sum(isinstance(event, OUTCOMES) for event in reported)


NINE = """\
icdgen: 1
node: {name: nine, title: Nine telecommands, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: length}
    header: [{at: 0, bits: 8, role: id}, {at: 8, bits: 8, role: length}]
    commands: {ack: {message: Ack, echo: Command}}
    client: {reply_timeout_ms: 100, late_ms: 900, in_flight: 8}
messages:
  - name: Ack
    id: 99
    kind: telemetry
    length: 1
    fields: [{at: 0, bits: 8, name: Command, type: uint}]
"""
TELECOMMAND = "  - {name: Command %d, id: %d, kind: telecommand, length: 0}\n"


@pytest.mark.parametrize("name", ["python", "c-sanitizers", "rust-debug"])
def test_a_ninth_request_waits_until_responses_to_another_can_no_longer_come(
    name, tmp_path
):
    rows = "".join(TELECOMMAND % (id, id) for id in range(1, 10))
    (tmp_path / "nine.yaml").write_text(NINE + rows)
    icd = icd_of([tmp_path / "nine.yaml"])
    script = []
    for id in range(1, 9):
        script.append({"at": id, "telecommand": id, "bytes": ""})
        script.append({"at": id, "cancel": True})
    script += [{"at": 9, "telecommand": 9, "bytes": ""}, {"at": 1000}, {"at": 1001}]
    request = {"op": "stream_client", "node": "nine", "script": script}
    answer = reference.answer(icd, request)
    assert [step["out"] for step in answer["steps"][-3:]] == [[], [], ["0900"]]
    assert answer["steps"][-3]["deadline"] == 1001
    testee = Testee(build(all_languages()[name], icd))
    assert list(outcomes.differences(testee, [(request, answer)])) == []
    assert testee.close() == 0, testee.complaint()


MOVE, READ_POSITION, READ_LOAD = 0x0201, 0x0205, 0x0208
RESULT, POSITION, LOAD = 0x8001, 0x0205, 0x0208
DONE, LATER, MOVING, FAILED = range(4)


def result(at, telecommand, status):
    """Return what arrives when the test link `arm` reports the result of a
    telecommand.
    """
    return at, RESULT, bytes([status, 0]) + telecommand.to_bytes(2, "big") + bytes(2)


def send(at, id, size, **more):
    """Return a row that starts a telecommand that may be sent again."""
    return {
        "at": at,
        "telecommand": id,
        "bytes": bytes(size).hex(),
        "repeat": True,
    } | more


# Settings, steps and the events that they lead to. Random scripts rarely meet these.
RARE = {
    "progress-prolongs-the-late-time": (
        {"retries": 0},
        [
            send(0, MOVE, 7),
            result(200, MOVE, MOVING),
            {"at": 500},
            send(510, MOVE, 7),
            result(549, MOVE, DONE),
        ],
        ["progress", "timeout", "late"],
    ),
    "progress-does-not-prolong-a-pause": (
        {"retries": 2, "busy_pause": 100},
        [
            send(0, MOVE, 7),
            {"at": 300},
            result(310, MOVE, LATER),
            result(320, MOVE, MOVING),
            {"at": 410},
            result(420, MOVE, DONE),
        ],
        ["progress", "progress", "done"],
    ),
    "progress-in-a-pause-prolongs-the-late-time": (
        {"retries": 2, "busy_pause": 500},
        [
            send(0, MOVE, 7),
            {"at": 300},
            result(310, MOVE, LATER),
            result(600, MOVE, MOVING),
            {"at": 601, "cancel": True},
            result(920, MOVE, DONE),
        ],
        ["progress", "progress", "late"],
    ),
    "two-acknowledges-leave-room-for-a-reply": (
        {"retries": 0},
        [
            send(0, READ_POSITION, 1),
            result(10, READ_POSITION, DONE),
            result(11, READ_POSITION, DONE),
            {"at": 120},
            send(130, READ_POSITION, 1),
            (140, POSITION, bytes(3)),
        ],
        ["progress", "progress", "timeout", "late"],
    ),
    "a-named-reply-replaces-one-with-a-status": (
        {},
        [
            send(0, READ_LOAD, 0, reply=POSITION),
            (10, LOAD, bytes(3)),
            (20, POSITION, bytes(3)),
        ],
        ["message", "done"],
    ),
    "a-named-reply-keeps-its-status": (
        {},
        [send(0, READ_LOAD, 0, reply=LOAD), (10, LOAD, bytes([FAILED, 0, 0]))],
        ["refused"],
    ),
}


@pytest.fixture(scope="module")
def rare_cases(icd):
    """Return requests and answers of the rare cases."""
    of_node = facts.of(icd, icd.node("arm"))
    rows = {row.id: row for row in of_node.stream.telemetry}
    cases = []
    for settings, steps, _ in RARE.values():
        link = link_of(icd, of_node)
        sample = outcomes.StreamSample(link, of_node.stream, random.Random(1))
        script = [
            (
                step
                if isinstance(step, dict)
                else sample.come(step[0], rows[step[1]], data=step[2])
            )
            for step in steps
        ]
        request = {"op": "stream_client", "node": "arm", "requests": 2}
        request |= {"settings": settings, "script": script}
        cases.append((request, reference.answer(icd, request)))
    return cases


def test_rare_cases_lead_to_the_events_that_a_user_expects(rare_cases):
    for (_, answer), (name, (*_, expected)) in zip(
        rare_cases, RARE.items(), strict=True
    ):
        steps = answer["steps"]
        events = [event["event"] for step in steps for event in step["events"]]
        assert events == expected, name


@pytest.mark.parametrize("name", ["python", "c-sanitizers", "rust-debug"])
def test_a_language_reports_the_events_of_rare_cases(icd, rare_cases, name):
    testee = Testee(build(all_languages()[name], icd))
    assert list(outcomes.differences(testee, rare_cases)) == []
    assert testee.close() == 0, testee.complaint()
