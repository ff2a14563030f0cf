"""Changes of the protocol section and of the log mask."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen.diff.changes.framing import fact_differs, mask_bit_differs
from icdgen.diff.pairs import NodePair
from icdgen.icd.annex import Loggable
from icdgen.icd.model import Node
from tests.icd.files import loaded


class Formats:
    """Context in which nodes have packet formats, which changed or not."""

    def __init__(self, have: bool, changed: bool = False) -> None:
        self.have, self.changed = have, changed

    def have_packet_formats(self, pair: NodePair) -> bool:
        return self.have

    def changed_packet_formats(self, pair: NodePair) -> frozenset[str]:
        return frozenset({"telemetry"} if self.changed else ())


@pytest.fixture(scope="module")
def node(tmp_path_factory) -> Node:
    return loaded(tmp_path_factory.mktemp("icd"), "messages: []\n").icd.nodes[0]


BARE, SAME, CHANGED = Formats(False), Formats(True), Formats(True, changed=True)


@pytest.mark.parametrize(
    ("old", "new", "context", "code", "message", "was", "now"),
    [
        # A link without packet formats
        ({"framing": {"start": 0}}, {"framing": {"start": 127}}, BARE, "DIF120",
         "`protocol.link.framing.start` is 127 (0x7F), was 0", "0", "127 (0x7F)"),
        ({"framing": {"start": 0}}, {"framing": {}}, BARE, "DIF121",
         "`protocol.link.framing.start` is no longer stated; it was 0", "0", ""),
        ({"framing": {}}, {"framing": {"start": 0}}, BARE, "DIF121",
         "`protocol.link.framing.start` is stated now: 0", "", "0"),
        # A link with packet formats: the key decides
        ({"framing": {"by": "length"}}, {"framing": {"by": "cobs"}}, CHANGED, "DIF120",
         "`protocol.link.framing.by` is cobs, was length", "length", "cobs"),
        ({"framing": {"end": 3}}, {"framing": {}}, CHANGED, "DIF120",
         "`protocol.link.framing.end` is no longer stated; it was 3", "3", ""),
        ({"buses": {"uart": 3}}, {"buses": {}}, CHANGED, "DIF121",
         "`protocol.link.buses.uart` is no longer stated; it was 3", "3", ""),
        ({"header": [{"role": "id"}]}, {"header": []}, CHANGED, "DIF134",
         "`protocol.link.header.id` is no longer stated; it was {role: id}", "{role: id}", ""),
        ({"packets": {}}, {"packets": {"ask": {"from": "host"}}}, CHANGED, "DIF134",
         "`protocol.link.packets.ask` is stated now: {from: host}", "", "{from: host}"),
        # Another notation of the same packet format
        ({"header": {"id": {"byte_order": "big"}}}, {"header": {"id": {}}}, SAME, "DIF413",
         "`protocol.link.header.id.byte_order` says otherwise", "big", ""),
        # A checksum is no part of the packet format that is compared
        ({"checksums": {"a": {"start": 0}}}, {"checksums": {"a": {"start": 1}}}, SAME,
         "DIF120", "`protocol.link.checksums.a.start` is 1, was 0", "0", "1"),
        ({"trailer": {"checksum": {"start": 0}}}, {"trailer": {"checksum": {"start": 1}}}, SAME,
         "DIF413", "`protocol.link.trailer.checksum.start` says otherwise", "0", "1"),
        # Words
        ({"summary": "One."}, {"summary": "Two."}, BARE, "DIF413",
         "`protocol.link.summary` says otherwise", "One.", "Two."),
        ({"commands": {"summary": "One."}}, {"commands": {}}, CHANGED, "DIF413",
         "`protocol.link.commands.summary` says otherwise", "One.", ""),
    ],
)  # fmt: skip
def test_another_fact_has_the_code_of_its_effect(
    node, old, new, context, code, message, was, now
):
    pair = NodePair(
        *(replace(node, protocol={"link": link}) for link in (old, new))
    )  # fmt: skip
    (result,) = fact_differs(pair, context)
    assert (result.code, result.message) == (code, message)
    assert (result.was, result.now) == (was, now)
    path = message.split("`")[1]
    assert result.where == pair.where()._replace(section=path)
    assert result.keys == (() if code == "DIF413" else (path.rsplit(".", 1)[1],))


def test_responses_are_left_to_their_own_rule(node):
    sides = ({"link": {"commands": {"ack": name}}} for name in ("Ack", "Done"))
    pair = NodePair(*(replace(node, protocol=side) for side in sides))
    assert list(fact_differs(pair, CHANGED)) == []


def test_long_values_are_cut_but_words_are_not(node):
    long = "x" * 81
    pair = NodePair(
        node, replace(node, protocol={"link": {"a": long, "summary": long}})
    )
    fact, word = fact_differs(
        NodePair(replace(node, protocol={"link": {}}), pair.after), BARE
    )
    assert (fact.now, word.now) == ("x" * 77 + "...", long)


def bits(*rows: tuple[int, int | None, str]) -> tuple[Loggable, ...]:
    return tuple(Loggable(bit=bit, id=id, name=name) for bit, id, name in rows)


def test_each_bit_of_the_log_mask_is_reported_by_its_frame(node):
    old = bits((0, 5, "Five"), (3, 6, ""), (1, 7, "Seven"), (2, 8, "Eight"))
    new = bits((0, 0, "Zero"), (1, 7, "Other"), (4, 9, "Nine"), (2, 8, "Eight"))
    pair = NodePair(replace(node, loggable=old), replace(node, loggable=new))
    assert [
        (each.code, each.message, each.was, each.now, each.where.section)
        for each in mask_bit_differs(pair, BARE)
    ] == [
        (
            "DIF122",
            "log mask bit 0 selects telemetry 0 `Zero`, selected telemetry 5 `Five`",
            "telemetry 5",
            "telemetry 0",
            "loggable 0",
        ),
        (
            "DIF123",
            "log mask bit 3 no longer selects telemetry 6",
            "telemetry 6",
            "",
            "loggable 3",
        ),
        (
            "DIF124",
            "log mask bit 4 selects telemetry 9 `Nine`",
            "",
            "telemetry 9",
            "loggable 4",
        ),
    ]
