"""Changes of acknowledges, responses, periods, names and identification."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen.diff.changes.sense import (
    _effect_of_response,
    _response,
    _response_words,
    general_responses_changed,
    response_changed,
)
from icdgen.diff.compare import Comparison
from icdgen.diff.pairs import MessagePair, NodePair
from tests.diff.cases import compared_texts, rows_of
from tests.icd.files import HEAD, loaded

FIELD = "{at: 0, bits: 8, name: Level, type: uint}"
WAITS = "A program that waits for the acknowledge times out."
SENDS = "The device sends an acknowledge that old programs do not expect."
RESTART = "No answer comes in either case, but the node restarts in one of them."


def answer(name: str, now: str, was: str, old: str, new: str, detail: str) -> tuple:
    places = (old, new)
    return ("DIF212", "error", f"`{name}` is {now} now", was, now, *places, detail)


ACKNOWLEDGED, NOT, RESET = "acknowledged", "not acknowledged", "answered by a restart"
# Keys of the old and of the new message, and the changes.
CASES = {
    "No Answer": ("", "acknowledge: false", [answer("No Answer", NOT, ACKNOWLEDGED, "No Answer", "false", WAITS)]),
    "Answer": ("acknowledge: false", "", [answer("Answer", ACKNOWLEDGED, NOT, "false", "Answer", SENDS)]),
    "Restart": ("", "acknowledge: reset", [answer("Restart", RESET, ACKNOWLEDGED, "Restart", "reset", WAITS)]),
    "No Restart": ("acknowledge: reset", "acknowledge: true", [answer("No Restart", ACKNOWLEDGED, RESET, "reset", "true", SENDS)]),
    "Silent": ("acknowledge: reset", "acknowledge: false", [answer("Silent", NOT, RESET, "reset", "false", RESTART)]),
    "Period": ("kind: telemetry, period_ms: 1000", "kind: telemetry, period_ms: 100", [
        ("DIF218", "warning", "the period of `Period` is 100 ms, was 1000 ms", "1000 ms", "100 ms", "1000", "100")]),
    "Periodic": ("kind: telemetry", "kind: telemetry, period_ms: 5", [
        ("DIF218", "warning", "the period of `Periodic` is 5 ms, was not stated", "not stated", "5 ms", "Periodic", "5")]),
    "On Request": ("kind: telemetry, period_ms: 5", "kind: telemetry", [
        ("DIF218", "warning", "the period of `On Request` is not stated, was 5 ms", "5 ms", "not stated", "5", "On Request")]),
    "Repeat": ("repeat: true", "", [
        ("DIF217", "error", "`Repeat` is sent once, was sent again after a time-out",
         "sent again after a time-out", "sent once", "true", "Repeat")]),
}  # fmt: skip


@pytest.fixture(scope="module")
def comparison(tmp_path_factory) -> Comparison:
    old, new = (
        "messages:\n"
        + "".join(
            f"  - {{name: {name}, id: {id}, length: 1, fields: [{FIELD}]"
            f"{', kind: telecommand' * ('kind' not in case[side])}"
            f"{', ' * bool(case[side])}{case[side]}}}\n"
            for id, (name, case) in enumerate(CASES.items(), 10)
        )
        for side in (0, 1)
    )
    folder = tmp_path_factory.mktemp("sense")
    return compared_texts(folder, old, new, is_checked=False)


@pytest.mark.parametrize("name", CASES)
def test_another_answer_or_period_is_reported_completely(comparison, name):
    rows = rows_of(comparison, "DIF212", "DIF217", "DIF218")
    assert [row for row in rows if f"`{name}`" in row[2]] == CASES[name][2]


def message_pair(folder, **changes) -> MessagePair:
    """Return a message and a copy with other attributes."""
    text = f"messages:\n  - {{name: Go, id: 1, kind: telecommand, length: 1, fields: [{FIELD}]}}\n"
    node = loaded(folder, text).icd.nodes[0]
    (message,) = node.messages
    after = replace(message, **changes)
    return MessagePair(message, after, old_node=node, new_node=node)


@pytest.mark.parametrize(
    ("changes", "was", "now", "message"),
    [
        ({"response": {"ack": "Done"}}, "those of all telecommands", "{ack: Done}",
         "the responses to `Go` are {ack: Done}, were those of all telecommands"),
        ({"response": {}}, "those of all telecommands", "{}",
         "the responses to `Go` are {}, were those of all telecommands"),
        ({"requested": False}, "requested by its id", "not requested by its id",
         "`Go` is not requested by its id, was requested by its id"),
        ({"repeat": True}, "sent once", "sent again after a time-out",
         "`Go` is sent again after a time-out, was sent once"),
    ],
)  # fmt: skip
def test_other_responses_of_a_message_are_reported_in_both_directions(
    tmp_path, changes, was, now, message
):
    pair = message_pair(tmp_path, **changes)
    (result,) = response_changed(pair, None)
    assert (result.message, result.was, result.now) == (message, was, now)
    pair.before, pair.after = pair.after, pair.before
    (result,) = response_changed(pair, None)
    assert (result.was, result.now) == (now, was)
    assert f"{now}, were" not in result.message


UNKNOWN = "A program with the old ICD reports this response as other telemetry"
ALTERED = (
    "A program with the old ICD may not recognize this response, or take it for the "
    "response to another telecommand."
)
MISSING = (
    "A program with the old ICD waits until its time-out, because this response does "
    "not come."
)
REQUEST = (
    "The device does not take the request of a program with the old ICD for a request "
    "of telemetry."
)
REQUESTS = (
    "A program with the old ICD requests telemetry in a way that the device does not "
    "know."
)


@pytest.mark.parametrize(
    ("section", "keys", "old", "new", "effect"),
    [
        ("commands", ["ack"], None, "Ack", f"{UNKNOWN}."),
        ("commands", ["reply"], None, "Reply", f"{UNKNOWN}."),
        ("commands", ["nak"], None, "Nak",
         f"{UNKNOWN} and does not learn that the telecommand was refused."),
        ("commands", ["busy"], None, "Busy",
         f"{UNKNOWN} and does not learn that the device is busy."),
        ("commands", ["progress"], None, "Going",
         f"{UNKNOWN} and does not learn that the telecommand is still being executed."),
        ("commands", ["ack"], "Ack", None, MISSING),
        ("commands", ["reply"], "Reply", None, ""),
        ("commands", ["nak"], "Nak", None, ""),
        ("commands", ["ack"], "Ack", "Done", ALTERED),
        ("commands", ["nak"], "Nak", "No", ALTERED),
        ("commands", ["ack", "echo"], None, "Id", ALTERED),
        ("commands", ["ack", "echo"], "Id", None, ALTERED),
        ("commands", ["nak", "reason"], None, "Reason", ""),
        ("commands", ["reasons", "checksum"], "Damaged", None, ""),
        ("commands", [], None, {"ack": "Ack"}, f"{UNKNOWN}."),
        ("commands", [], {"ack": "Ack"}, None, MISSING),
        ("requests", [], {"ack": "Ack"}, None, REQUESTS),
        ("requests", [], None, {"ack": "Ack"}, ""),
        ("requests", ["packet"], "ask", "query", REQUEST),
        ("requests", ["reserved"], None, 1, REQUEST),
        ("requests", ["ack"], "Ack", None, MISSING),
    ],
)  # fmt: skip
def test_the_effect_of_another_response_on_a_program_with_the_old_icd(
    section, keys, old, new, effect
):
    assert _effect_of_response(section, keys, old, new) == effect


@pytest.mark.parametrize(
    ("section", "keys", "words"),
    [
        ("commands", [], "the section `commands` with responses to telecommands"),
        ("requests", [], "the section `requests` with responses to requests of telemetry"),
        ("commands", ["nak"], "the response `nak` to telecommands"),
        ("requests", ["ack"], "the response `ack` to requests of telemetry"),
        ("commands", ["ack", "status", "busy"],
         "`status.busy` of the response `ack` to telecommands"),
        ("requests", ["packet"], "`packet` in `requests`"),
        ("commands", ["reasons", "checksum"], "`reasons.checksum` in `commands`"),
    ],
)  # fmt: skip
def test_a_response_is_named_with_its_section(section, keys, words):
    assert _response_words(section, keys) == words


def test_a_response_may_be_only_the_name_of_its_message():
    assert _response("Ack") == _response({"message": "Ack"}) == {"message": "Ack"}
    assert _response(["Ack"]) == ["Ack"]


def test_a_general_response_is_reported_with_its_section_and_severity(tmp_path):
    (node,) = loaded(tmp_path, "messages: []\n").icd.nodes
    old, new = (
        replace(node, protocol={"link": {"commands": commands}})
        for commands in (
            {"ack": "Ack", "nak": "Nak", "busy": {"message": "Busy"}},
            {"ack": "Done", "busy": "Busy"},
        )
    )
    results = list(general_responses_changed(NodePair(old, new), None))
    path = "protocol.link.commands"
    assert [
        (each.message, each.was, each.now, each.details, each.severity, each.where)
        for each in results
    ] == [
        (
            "the response `ack` to telecommands is Done, was Ack",
            "Ack",
            "Done",
            (ALTERED,),
            None,
            NodePair(old, new).where()._replace(section=f"{path}.ack"),
        ),
        (
            "the response `nak` to telecommands is gone; it was Nak",
            "Nak",
            "",
            (),
            "warning",
            NodePair(old, new).where()._replace(section=f"{path}.nak"),
        ),
    ]
    assert [each.keys for each in results] == [("ack",), ("nak",)]


@pytest.mark.parametrize(
    ("key", "old", "new", "message", "was", "now"),
    [
        ("node_type", ", node_type: 0", ", node_type: 2",
         "the node type of `demo` is 2, was 0", "0", "2"),
        ("node_type", "", ", node_type: 0",
         "the node type of `demo` is 0, was not stated", "", "0"),
        ("interface_version", ", interface_version: 3", "",
         "the interface version of `demo` is not stated, was 3", "3", ""),
    ],
)  # fmt: skip
def test_another_identification_of_a_node_is_reported(
    tmp_path, key, old, new, message, was, now
):
    texts = (HEAD.replace("}", f"{more}}}") + "messages: []\n" for more in (old, new))
    (row,) = rows_of(compared_texts(tmp_path, *texts, is_checked=False), "DIF215")
    assert row[:5] == ("DIF215", "warning", message, was, now)
    assert [text for text in row[5:7] if text in ("0", "2", "3")] == [
        text for text in (was, now) if text
    ]


def test_a_name_that_only_gets_more_precise_keeps_its_meaning(tmp_path):
    names = (
        ("Battery Voltage", "Voltage Battery"),
        ("Mode", "Control Mode"),
        ("Temperature", "Humidity"),
    )
    old, new = (
        "messages:\n  - {name: Status, id: 1, kind: telemetry, length: 3, fields: ["
        + ", ".join(
            f"{{at: {8 * number}, bits: 8, name: {pair[side]}, type: uint}}"
            for number, pair in enumerate(names)
        )
        + "]}\n"
        for side in (0, 1)
    )
    rows = rows_of(compared_texts(tmp_path, old, new, is_checked=False), "DIF213")
    assert [row[:7] for row in rows] == [
        (
            "DIF213",
            "warning",
            "what was called `Temperature` is called `Humidity`: make sure that it is the same thing",
            "Temperature",
            "Humidity",
            "Temperature",
            "Humidity",
        )
    ]
