"""Telemetry of procedures on framed links is requested by a telecommand or a packet."""

from __future__ import annotations

import pytest

from tests.icd.rules.marked import findings_of, reported

MESSAGES = """\
messages:
  - {name: Next, id: 2, kind: telecommand, length: 0}
  - {name: Get Sum, id: 3, kind: telecommand, length: 0, response: {reply: Sum}}
  - {name: Ask, id: 4, kind: telecommand, length: 0}
"""
NAMES = ("State", "Sum", "Low", "High", "More")
TELEMETRY = "".join(
    f"  - {{name: {name}, id: {id}, kind: telemetry, length: 1, "
    "fields: [{at: 0, bits: 8, name: Bits, type: bytes}]}\n"
    for id, name in enumerate(NAMES, 130)
)
POLL = "poll: {}, until: {{Bits: 1}}, every_ms: 1, for_ms: 9"
MAP = (
    "blocks: {{size: 4, rounds: 1, steps: [{{missing: {{packet: 4, each: [{{send: Next}}], "
    "steps: [{{map: {}, messages: [Low, Sum, High], field: Bits}}]}}}}]}}"
)


def icd(*steps: str, link: str = "", framing: str = "framing: {by: slip}, ") -> str:
    rows = "".join(f"        - {{{step}}}\n" for step in steps)
    return (
        "protocol:\n"
        f"  link: {{{framing}header: [{{bits: 8, role: id}}]{link}}}\n"
        "  procedures:\n    one:\n      limits: {time_s: 60, requests: 100}\n"
        f"      steps:\n{rows}{MESSAGES}{TELEMETRY}"
    )


def unrequested(folder, text: str) -> list[str]:
    rows = reported(folder, text, "ICD195")
    for name, message in rows:
        assert message == (
            f"nothing requests `{name}`: no telecommand has it as `reply`, "
            "and no packet requests it"
        )
    return [name for name, _ in rows]


def test_all_telemetry_that_steps_request_is_requested(tmp_path):
    steps = (
        "get: Sum",
        "get: State",
        "get: Nothing",
        POLL.format("More"),
        POLL.format("Sum"),
        MAP.format("get"),
        "get: State",
    )
    text = icd(*steps)
    expected = ["State", "More", "Low", "High", "State"]
    assert unrequested(tmp_path, text) == expected
    helps = {f.help for f in findings_of(tmp_path, text, "ICD195")}
    assert helps == {
        "add `response: {reply: ...}` to the telecommand, or `requests` to the link"
    }


def test_a_map_that_is_sent_requests_nothing(tmp_path):
    assert unrequested(tmp_path, icd(MAP.format("send"))) == []


def test_received_telemetry_is_not_requested(tmp_path):
    receive = MAP.format("send").replace(
        "{map: send, messages: [Low, Sum, High], field: Bits}",
        "{receive: State, number: Bits, data: Bits, silence_ms: 1}",
    )
    assert unrequested(tmp_path, icd(receive)) == []


def test_only_framed_links_need_requests(tmp_path):
    assert unrequested(tmp_path, icd("get: State", framing="")) == []


@pytest.mark.parametrize("name", ["State", "Sum"])
def test_the_reply_of_any_telecommand_is_requested(name, tmp_path):
    text = icd("get: State", "get: Sum").replace("reply: Sum", f"reply: {name}")
    (other,) = {"State", "Sum"} - {name}
    assert unrequested(tmp_path, text) == [other]


def test_a_packet_requests_telemetry_unless_a_telecommand_has_its_id(tmp_path):
    steps = "get: State", "get: More"
    packets = (
        ", packets: {out: {from: host}, in: {from: device}}, requests: {packet: out}"
    )
    text = icd(*steps, link=packets)
    assert unrequested(tmp_path, text) == []
    text = text.replace("name: Ask, id: 4", "name: Ask, id: 130")
    assert unrequested(tmp_path, text) == ["State"]
    text = text.replace(
        "name: More, id: 134,", "name: More, id: 134, requested: false,"
    )
    assert unrequested(tmp_path, text) == ["State", "More"]
