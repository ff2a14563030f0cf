"""Sequence diagrams have the arrows, notes and limits of a link."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.html import sequences
from icdgen.backends.html.relations import Relations
from icdgen.backends.html.sequences import Arrow, SequenceDiagram
from icdgen.loading import load
from icdgen.protocol import facts
from tests.conformance.icds import LINKS
from tests.conftest import ROOT


def diagrams_of(path):
    icd = load([path]).icd
    node = icd.nodes[-1]
    relations = Relations(icd)
    return relations, node, facts.of(icd, node)


def arrows(diagram):
    return [(arrow.out, arrow.text, arrow.note, arrow.url) for arrow in diagram.arrows]


def test_arrows_are_placed_below_each_other_and_clipped():
    diagram = SequenceDiagram(
        "Stop",
        "Demo",
        [Arrow(True, "a" * 50, "b" * 62, "x"), Arrow(False, "c" * 51, "d" * 63)],
    )
    assert diagram.height == 40 + 2 * 46 + 14
    assert diagram.placed == [
        (70, Arrow(True, "a" * 50, "b" * 62, "x")),
        (116, Arrow(False, "c" * 49 + "…", "d" * 61 + "…")),
    ]


def test_a_framed_link_shows_responses_with_their_meaning():
    (telecommand,) = sequences.acknowledges(
        *diagrams_of(ROOT / "examples" / "links" / "wheel.yaml")
    )
    assert (telecommand.title, telecommand.node) == (
        "Framed link, telecommand",
        "Reaction wheel",
    )
    assert arrows(telecommand) == [
        (True, "telecommand", "waits 200 ms; if it may be repeated, 2 more times", ""),
        (False, "Ack: Command = id", "it is done", "wheel/ack.html"),
        (False, "Nak: Command = id", "it is refused", "wheel/nak.html"),
        (
            False,
            "Busy: Command = id",
            "sent again after 100 ms, 2 times at most",
            "wheel/busy.html",
        ),
    ]
    assert telecommand.remarks == ["The device sends one of these responses."]


def test_a_response_with_a_status_shows_all_its_meanings():
    telecommand, *_ = sequences.acknowledges(*diagrams_of(LINKS / "outcomes.yaml"))
    assert arrows(telecommand)[1:] == [
        (
            False,
            "Command Result: Group = id[0], Number = id[1]",
            "confirms, or refuses",
            "arm/command_result.html",
        )
    ]
    assert telecommand.remarks == []


def test_the_buses_of_a_node_have_a_diagram_for_each_direction():
    shown = sequences.acknowledges(*diagrams_of(LINKS / "battery.yaml"))
    waits = "waits 1000 ms, tries again 3 times"
    assert [(each.title, arrows(each)) for each in shown] == [
        (
            "UART, telecommand",
            [
                (True, "telecommand: id, parameters", waits, ""),
                (False, "acknowledge: id and error code", "", ""),
            ],
        ),
        (
            "UART, telemetry",
            [
                (True, "request: id of the telemetry", waits, ""),
                (False, "reply: id, data", "", ""),
            ],
        ),
        ("I²C, telecommand", [(True, "write to 20: id, parameters", "", "")]),
    ]


def test_requests_by_packets_have_their_responses():
    *_, telemetry = sequences.acknowledges(*diagrams_of(LINKS / "formats.yaml"))
    assert telemetry.title == "Framed link, telemetry"
    page = "formats/protocol.html#packet-"
    assert arrows(telemetry) == [
        (
            True,
            "packet read: id of the telemetry",
            "waits 60 ms, tries again 1 time",
            f"{page}read",
        ),
        (False, "the telemetry", "", ""),
        (False, "packet refusal: id = id", "it is refused", f"{page}refusal"),
    ]
    assert telemetry.remarks == ["The device sends one of these responses."]


def test_a_procedure_has_an_arrow_for_each_message():
    path = ROOT / "tests" / "procedures" / "other_steps.yaml"
    read, write, entries, copy = sequences.procedures(*diagrams_of(path))
    assert (read.title, read.node) == ("Read", "Store")
    assert arrows(read) == [
        (True, "request for State", "for each block", "store/state.html"),
        (False, "State", "", "store/state.html"),
        (True, "Select", "", "store/select.html"),
        (
            True,
            "request for State",
            "every 10 ms, for 1000 ms at most",
            "store/state.html",
        ),
        (False, "State", "until Phase = 2, Number = number", "store/state.html"),
        (
            True,
            "the map of received packets",
            "while packets are missing",
            "store/map_a.html",
        ),
        (True, "Give", "", "store/give.html"),
        (False, "Packet", "", "store/packet.html"),
        (
            False,
            "… one packet after another",
            "until all are there, or none is new for 20 ms",
            "",
        ),
    ]
    assert arrows(write)[:5] == [
        (True, "Clear", "", "store/clear.html"),
        (True, "Begin", "for each block", "store/begin.html"),
        (
            True,
            "Put",
            "while packets are missing; for each missing packet",
            "store/put.html",
        ),
        (True, "request for the map of received packets", "", "store/map_a.html"),
        (False, "the map", "", "store/map_a.html"),
    ]
    assert [text for _, text, _, _ in arrows(entries)] == [
        "First",
        "request for Entry",
        "Entry",
        "Next",
    ]
    assert entries.remarks == [
        "Entries: 20",
        "Longest duration: 600 s",
        "Requests: 100000",
    ]
    assert arrows(copy) == [(True, "Copy", "", "store/copy.html")]


@pytest.mark.parametrize(
    ("types", "texts"),
    [
        (
            {"telecommand": 1, "acknowledge": 2, "refusal": 3},
            ["telecommand: type 1", "acknowledge: type 2", "refusal: type 3"],
        ),
        ({"telecommand": 0}, ["telecommand: type 0"]),
    ],
)
def test_messages_on_can_have_their_types(types, texts):
    rows = list(sequences._can_arrows(types, "telecommand", "acknowledge", "refusal"))
    assert [row.text for row in rows] == texts
    assert [row.out for row in rows] == [True, False, False][: len(rows)]
    assert [row.note for row in rows] == ["", "", "if it is refused"][: len(rows)]


def test_the_limits_of_a_procedure_are_listed():
    blocks = SimpleNamespace(size=100, packet_bytes=20, rounds=3, most=1000)
    procedure = SimpleNamespace(blocks=blocks, most_entries=7, time=61_999, requests=9)
    assert list(sequences._limit_texts(procedure)) == [
        "Blocks of up to 100 bytes, in packets of 20",
        "Rounds of a block: 3",
        "Bytes in all: 1000",
        "Entries: 7",
        "Longest duration: 61 s",
        "Requests: 9",
    ]
    procedure = SimpleNamespace(blocks=None, most_entries=0, time=1000, requests=1)
    assert list(sequences._limit_texts(procedure)) == [
        "Longest duration: 1 s",
        "Requests: 1",
    ]
