"""Comments on messages that share an id state how a frame is recognised."""

from __future__ import annotations

from icdgen.describe.shared_ids import sharing_sentence
from icdgen.icd.variants import ids_of
from tests.icd.files import loaded


def sentences(folder, *messages):
    text = "messages:\n" + "".join(f"  - {{{message}}}\n" for message in messages)
    result = loaded(folder, text)
    assert result.ok, [finding.message for finding in result.findings]
    (node,) = result.icd.nodes
    ids = ids_of(result.icd, node)
    return [sharing_sentence(ids, message) for message in node.messages]


def message(name, constant=None, length=2, id="id: 5, kind: telemetry"):
    value = "" if constant is None else f", const: {constant}"
    fields = f"{{at: 0, bits: 8, name: Type, type: uint{value}}}"
    if length > 1:
        bits = 8 * (length - 1)
        fields += f", {{at: 8, bits: {bits}, name: Value, type: uint}}"
    shares = ", shares_id: true"
    return f"name: {name}, {id}{shares}, length: {length}, fields: [{fields}]"


def test_messages_with_one_length_differ_in_their_constants(tmp_path):
    messages = [message(name, n) for n, name in enumerate(("A", "B", "C"))]
    assert sentences(tmp_path, *messages) == [
        "Shares its id with B and C, and has Type 0.",
        "Shares its id with A and C, and has Type 1.",
        "Shares its id with A and B, and has Type 2.",
    ]


def test_lengths_are_stated_if_they_differ(tmp_path):
    messages = message("A", 1), message("B", 2, length=3)
    assert sentences(tmp_path, *messages) == [
        "Shares its id with B, and has 2 bytes and Type 1.",
        "Shares its id with A, and has 3 bytes and Type 2.",
    ]


def test_a_message_without_constants_is_what_none_of_the_others_is(tmp_path):
    assert sentences(tmp_path, message("A", 1), message("B")) == [
        "Shares its id with B, and has Type 1.",
        "Shares its id with A, and is what none of the others is.",
    ]


def test_a_message_with_an_id_of_its_own_shares_nothing(tmp_path):
    alone = "name: Alone, id: 6, kind: telemetry, length: 0"
    command = "name: Command, id: 5, kind: telecommand, length: 0"
    texts = sentences(tmp_path, message("A", 1), message("B", 2), alone, command)
    assert texts[2:] == ["", ""]


def test_a_configuration_message_names_the_id_that_it_shares(tmp_path):
    both = "set_id: 5, get_id: 7, kind: configuration"
    telecommand = "id: 5, kind: telecommand"
    telemetry = "id: 7, kind: telemetry"
    texts = sentences(
        tmp_path,
        message("A", 1, id=both),
        message("B", 2, id=telecommand),
        message("C", 3, id=telemetry),
    )
    assert texts == [
        "Shares its set id with B, and has Type 1. "
        "Shares its get id with C, and has Type 1.",
        "Shares its id with A, and has Type 2.",
        "Shares its id with A, and has Type 3.",
    ]
