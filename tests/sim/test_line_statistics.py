"""`icdgen monitor` and `icdgen send` report line statistics and outcomes."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.events import (
    Busy,
    Gap,
    Late,
    LineError,
    Refused,
    Stray,
    Timeout,
)

from icdgen.link.line_statistics import LineStatistics
from icdgen.link.outcomes import attempts_text, failure_text, outcome_report
from tests.sim.device import ICD

NODE = ICD.node("cubeacp")


def report(*events) -> str:
    statistics = LineStatistics(ICD, NODE)
    for event in events:
        statistics.event(event)
    return statistics.text()


def test_a_line_without_errors_has_no_report():
    assert report() == ""


@pytest.mark.parametrize(
    ("events", "text"),
    [
        ([LineError("checksum", 3)] * 2, "wrong checksum (2)"),
        ([LineError("length"), LineError("checksum")], "wrong checksum (1), wrong length (1)"),
        ([LineError("protocol_error")], "protocol error (1)"),
        ([Gap(3, 2), Gap(3, 5)], "messages missing (7)"),
        ([Gap(3, 0), Gap(3, 0)], "messages that came again (2)"),
        ([Gap(3, 0), Gap(3, 4)], "messages missing (4), messages that came again (1)"),
        ([Late(1, b"")], "late responses (1)"),
        ([Stray(b"")], "responses without a request (1)"),
    ],
)  # fmt: skip
def test_each_kind_of_error_is_counted_on_its_own(events, text):
    assert report(*events) == f"on the line: {text}"


def test_a_message_is_the_one_of_its_id_that_has_the_length():
    statistics = LineStatistics(ICD, NODE)
    message = next(message for message in NODE.messages if message.telemetry_id)
    id, length = message.telemetry_id, message.length
    assert statistics.message_of(id, bytes(length)) is message
    assert statistics.message_of(id, bytes(length + 1)) is None
    assert statistics.message_of(1 << 20, bytes(length)) is None


@pytest.mark.parametrize(
    ("outcome", "text"),
    [
        (Refused(1, 1), "refused"),
        (Refused(1, 1, code=0), "refused: unknown error (code 0)"),
        (Refused(1, 1, 2, "Bad length"), "refused: Bad length (code 2)"),
        (Busy(1, 1), "busy"),
        (Busy(1, 1, 0, "Nothing"), "busy"),
        (Busy(1, 1, 4, "Erasing"), "busy: Erasing (code 4)"),
    ],
)
def test_a_failure_has_its_reason_if_it_has_one(outcome, text):
    assert failure_text(outcome) == text


def test_attempts_are_counted_if_there_were_several():
    assert attempts_text(Timeout(1, 1)) == ""
    assert attempts_text(Timeout(1, 2)) == " after 2 attempts"


def test_a_report_for_programs_has_only_what_the_outcome_has():
    assert outcome_report("Set", Timeout(1, 3), None) == {
        "message": "Set", "event": "timeout", "attempts": 3,
    }  # fmt: skip
    assert outcome_report("Set", Refused(1, 1, 0, "None"), None) == {
        "message": "Set", "event": "refused", "reason": "None", "code": 0, "attempts": 1,
    }  # fmt: skip
