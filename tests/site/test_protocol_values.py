"""Values of the page of a protocol: settings, boxes of drawings, errors and search."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.html import packets, protocol, responses
from icdgen.backends.html.all_facts import FactRow
from icdgen.backends.html.protocol import BusBox
from icdgen.backends.html.relations import Relations
from icdgen.loading import load
from icdgen.protocol import facts
from tests.conformance.icds import LINKS
from tests.conftest import ROOT


def opened(path):
    icd = load([path]).icd
    return Relations(icd), icd.nodes[-1]


def test_settings_of_a_bus_are_shown_with_their_notation():
    section = {
        "link": {
            "line": {"baud_rate": 9600, "parity": "even"},
            "buses": {
                "uart": {"line": {"baud_rate": 115200, "is_idle": True}},
                "i2c": {
                    "write": {"address_7bit": 5, "stop": "after"},
                    "read": {"address_7bit": 0x57},
                    "other": {"rate": 7},
                },
                "can": {"formats": ["base", "extended"], "sizes": [1, 2], "none": {}},
            },
        }
    }
    assert protocol.bus_settings(section) == [
        ("Serial line", [FactRow("baud rate", "9,600"), FactRow("parity", "even")]),
        ("UART", [FactRow("baud rate", "115,200")]),
        (
            "I²C",
            [
                FactRow("write, address 7bit", "0x05"),
                FactRow("write, stop", "after"),
                FactRow("read, address 7bit", "0x57"),
            ],
        ),
        ("CAN", [FactRow("formats", "base or extended")]),
    ]
    assert protocol.bus_settings({}) == []


def test_boxes_share_the_width_of_a_drawing():
    boxes = protocol._adjacent_boxes(
        [("a", "one", 1, ""), ("b", "", 2, "7 … 0"), ("c", "", 1, "")]
    )
    assert boxes == [
        BusBox(1.0, 179.5, "a", "one", ""),
        BusBox(180.5, 359.0, "b", "", "7 … 0"),
        BusBox(539.5, 179.5, "c", "", ""),
    ]


@pytest.mark.parametrize(
    ("checksum", "box"),
    [
        (None, []),
        (SimpleNamespace(telecommand_buses=("i2c",), telecommand_always=()), []),
        (
            SimpleNamespace(telecommand_buses=("uart",), telecommand_always=("uart",)),
            [("CRC", "")],
        ),
        (
            SimpleNamespace(telecommand_buses=("uart",), telecommand_always=()),
            [("CRC", "optional")],
        ),
    ],
)
def test_a_frame_has_escapes_around_id_data_and_checksum(checksum, box):
    framing = SimpleNamespace(escape=0x1F, start=0x7F, end=5)
    facts = SimpleNamespace(framing=framing, checksum=checksum)
    boxes = protocol._framing(facts)
    assert [(each.text, each.about) for each in boxes] == [
        ("1F", "escape"),
        ("7F", "start"),
        ("id", ""),
        ("data", ""),
        *box,
        ("1F", "escape"),
        ("05", "end"),
    ]
    assert protocol._framing(SimpleNamespace(framing=None)) == []


def test_errors_have_their_role_and_the_link_to_their_member():
    relations, node = opened(LINKS / "battery.yaml")
    values = protocol.values(relations, node)
    page = "battery/enum-error.html#member-"
    assert values["errors"] == [
        (0, "None", "", f"{page}none"),
        (1, "Unknown Id", "unknown id", f"{page}unknown_id"),
        (2, "Length", "length", f"{page}length"),
        (3, "Parameter", "value", f"{page}parameter"),
        (4, "Checksum", "checksum", f"{page}checksum"),
    ]
    assert (values["escaped"], values["escaped_as"]) == ("1F", "1F 1F")


def test_errors_without_names_are_sorted_by_code():
    facts = SimpleNamespace(
        reasons={"unknown_id": 7, "length": 2}, stream=object(), reason_enums=[1]
    )
    assert protocol.error_codes(None, facts) == [
        (2, "length", "", ""),
        (7, "unknown id", "", ""),
    ]


def test_the_search_finds_only_sections_of_the_page():
    relations, node = opened(ROOT / "examples" / "links" / "wheel.yaml")
    entries = list(protocol.search_entries(relations, node, "wheel/protocol.html"))
    assert [(title, place.url.partition("#")[2]) for _, title, place in entries] == [
        ("Packets", "packets"),
        ("ccitt parameters and calculator", "checksums"),
        ("Responses to telecommands", "responses"),
        ("Acknowledges", "acknowledges"),
        ("Time-outs", "times"),
        ("Assumptions", "assumptions"),
    ]
    assert {place.text for *_, place in entries} == {"Reaction wheel"}


def test_responses_to_a_telecommand_are_rows_with_links():
    relations, node = opened(LINKS / "outcomes.yaml")
    values = responses.of_node(relations, node)
    (general,) = values["general"]
    assert general[:5] == (
        "ack",
        "Command Result",
        "arm/command_result.html",
        "confirms, or refuses",
        "Group = id[0], Number = id[1]",
    )
    assert general.judges == (
        "Status: Done, 6: confirms; Later: the device is busy; "
        "Moving: still being executed; otherwise: refuses; reason in Detail"
    )
    assert general.has_status
    rows = {row.name: row for row in values["telecommands"]}
    assert list(rows) == [
        "Move Joint",
        "Read Position",
        "Read Load",
        "Read All",
        "Halt",
    ]
    assert [row[:2] for row in rows["Read All"].rows] == [
        ("reply", "Position"),
        ("nak", "Command Error"),
    ]
    assert (rows["Read Position"].timeout, rows["Read Position"].repeat) == (
        "120 ms",
        "yes",
    )
    assert rows["Halt"][2:] == ([], "", "")
    (reply,) = rows["Read Load"].rows
    assert (reply.about, reply.judges) == (
        "requested telemetry, or refuses",
        "Result: Done: requested telemetry; Later: the device is busy;"
        " otherwise: refuses",
    )


CONTENTS = {
    "formats": {
        "stopped": [
            ("Sent by", "device", []),
            ("Carries", "no message", []),
            ("Responds to", "", ["Stop"]),
        ],
        "refusal": [
            ("Sent by", "device", []),
            ("Carries", "no message", []),
            ("Responds to", "requests of telemetry", ["Turn", "Stop"]),
        ],
        "data": [
            ("Sent by", "device", []),
            ("Carries", "", ["Done", "Position", "History", "Alarm"]),
        ],
        "command": [("Sent by", "host", []), ("Carries", "", ["Turn", "Stop"])],
        "read": [
            ("Sent by", "host", []),
            ("Requests", "with 3 bytes of zeros as data", ["Position", "History"]),
        ],
    },
    "nameless": {
        "read": [("Sent by", "host", []), ("Requests", "", ["Level", "Flow", "Heat"])],
        "block": [
            ("Sent by", "device", []),
            (
                "Carries",
                "the requested telemetry, without its id",
                ["Level", "Flow", "Heat"],
            ),
        ],
        "refused": [
            ("Sent by", "device", []),
            ("Carries", "no message", []),
            ("Responds to", "requests of telemetry", ["Set Level", "Start"]),
        ],
        "event": [("Sent by", "device", []), ("Carries", "", ["Alarm", "Written"])],
        "write": [("Sent by", "host", []), ("Carries", "", ["Set Level", "Start"])],
    },
    "packets": {"": []},
}


@pytest.mark.parametrize("name", CONTENTS)
def test_packets_say_who_sends_them_and_what_they_carry(name):
    relations, node = opened(LINKS / f"{name}.yaml")
    stream = facts.of(relations.icd, node).stream
    views = packets.packet_views(relations, node, stream)
    assert {
        view.name: [
            (content.label, content.text, [link.text for link in content.messages])
            for content in view.contents
        ]
        for view in views
    } == CONTENTS[name]
    assert [view.anchor for view in views] == [
        f"packet-{view.name}" if view.name else "packets" for view in views
    ]


@pytest.mark.parametrize(
    ("kind", "row", "text"),
    [
        ("ack", {"message": "Ack"}, ""),
        (
            "ack",
            {"status": "Result", "success": ["OK", 0]},
            "Result: OK, 0: confirms; otherwise: refuses",
        ),
        (
            "reply",
            {"status": "Result", "success": [0], "busy": [1], "progress": [2]},
            "Result: 0: requested telemetry; 1: the device is busy;"
            " 2: still being executed; otherwise: refuses",
        ),
        ("nak", {"reason": "Code"}, "reason in Code"),
        (
            "nak",
            {"reason": "Code", "busy": ["Later", 9]},
            "Later, 9: the device is busy; reason in Code",
        ),
        ("busy", {"busy": ["Later"]}, ""),
    ],
)
def test_values_of_status_and_reason_are_words(kind, row, text):
    assert responses._judges(kind, row) == text


@pytest.mark.parametrize(
    ("timeout", "text"), [(None, ""), (0, ""), (1, "1 ms"), (3000, "3,000 ms")]
)
def test_a_time_out_is_in_milliseconds(timeout, text):
    assert responses._milliseconds(timeout) == text


MESSAGES = {
    ROOT / "examples" / "links" / "wheel.yaml": {
        "Nak": [
            (
                "Response",
                "refuses: Set Mode, Set Speed, Get Events, Save",
                "wheel/protocol.html#responses",
            )
        ],
        "Status": [],
        "Save": [
            ("Confirmed by", "Ack", "wheel/ack.html"),
            ("Refused by", "Nak", "wheel/nak.html"),
            ("Busy device", "Busy", "wheel/busy.html"),
            ("Time-out", "3,000 ms", ""),
            ("May be repeated", "", ""),
        ],
        "Reset": [
            ("Response", "none", ""),
            ("Time-out", "", ""),
            ("May be repeated", "", ""),
        ],
    },
    LINKS / "formats.yaml": {
        "Position": [
            (
                "Requested by",
                "packet read with its id",
                "formats/protocol.html#packet-read",
            ),
            ("Refused by", "packet refusal", "formats/protocol.html#packet-refusal"),
            ("Time-out", "60 ms", ""),
        ],
        "Alarm": [],
        "Turn": [
            ("Confirmed by", "Done", "formats/done.html"),
            ("Refused by", "packet refusal", "formats/protocol.html#packet-refusal"),
            ("Time-out", "", ""),
            ("May be repeated", "yes", ""),
        ],
    },
}


@pytest.mark.parametrize("path", MESSAGES, ids=lambda path: path.stem)
def test_a_message_has_its_responses_or_what_it_responds_to(path):
    relations, node = opened(path)
    messages = {message.name: message for message in node.messages}
    assert {
        name: list(responses.of_message(relations, node, messages[name]))
        for name in MESSAGES[path]
    } == MESSAGES[path]


@pytest.mark.parametrize(
    ("count", "end"), [(6, ""), (7, " and 1 more"), (8, " and 2 more")]
)
def test_a_response_names_six_telecommands(tmp_path, count, end):
    text = (ROOT / "examples" / "links" / "wheel.yaml").read_text("utf-8")
    # Four telecommands have the response already.
    text += "".join(
        f"  - {{name: Go {n}, id: {0x20 + n}, kind: telecommand, length: 0}}\n"
        for n in range(count - 4)
    )
    (tmp_path / "wheel.yaml").write_text(text, "utf-8")
    relations, node = opened(tmp_path / "wheel.yaml")
    nak = next(message for message in node.messages if message.name == "Nak")
    ((_, about, _),) = responses.of_message(relations, node, nak)
    assert about == "refuses: Set Mode, Set Speed, Get Events, Save, Go 0, Go 1" + end


def test_reasons_and_requests_of_a_link_are_listed():
    relations, node = opened(ROOT / "examples" / "links" / "wheel.yaml")
    values = responses.of_node(relations, node)
    assert [(row.about, row.value) for row in values["reasons"]] == [
        ("No such telecommand", "Unknown command"),
        ("Wrong length", "Bad length"),
        ("A value is not allowed", "Out of range"),
        ("Wrong checksum: it is sent again at once", "Bad CRC"),
    ]
    assert values["requests"] is None
    assert [(row.kind, row.judges, row.has_status) for row in values["general"]] == [
        ("ack", "", False),
        ("nak", "reason in Reason", False),
        ("busy", "", False),
    ]
    relations, node = opened(LINKS / "formats.yaml")
    request = responses.of_node(relations, node)["requests"]
    assert request.packet.text == "read" and request.response is None
    assert [link.text for link in request.messages] == ["Position", "History"]
    assert [(row.name, row.echo) for row in request.rows] == [
        ("packet refusal", "id = id")
    ]


def test_the_search_finds_each_packet_format():
    relations, node = opened(LINKS / "formats.yaml")
    found = {
        title: (words.split()[-1], place.url)
        for words, title, place in protocol.search_entries(relations, node, "x.html")
        if title.startswith("Packet ")
    }
    assert found == {
        f"Packet {name}": (name, f"x.html#packet-{name}")
        for name in ("stopped", "refusal", "data", "command", "read")
    }
