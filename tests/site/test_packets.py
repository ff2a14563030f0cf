"""Pages of links with several packet formats per direction show them, and their scripts
decode every packet like the Python runtime.
"""

from __future__ import annotations

import json
import random
import re
from pathlib import Path

import pytest
from icdgen_runtime._errors import IcdError
from icdgen_runtime.wire.stream import (
    StreamDecoder,
    stream_encode,
    stream_encode_packet,
    stream_encode_request,
)

from icdgen.backends.html import packet_formats, recognition, wire
from icdgen.backends.html.relations import Relations
from icdgen.errors import UserError
from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.recognize import recognize
from icdgen.recognize.framed import DIRECTIONS
from icdgen.runtime_objects.links import link_of_node
from icdgen.site import make_site, write_site
from tests.conftest import ROOT
from tests.features.outputs import icd_of
from tests.site.relay import RELAY
from tests.site.test_browser import opened
from tests.site.test_framed import LINKS
from tests.site.test_pasted import node
from tests.site.test_recognize import on_the_command_line, on_the_page
from tests.site.test_responses import plain

SCRIPTS = ROOT / "templates" / "html"
CONFORMANCE = ROOT / "tests" / "conformance" / "links"
FILES = [*sorted(LINKS.glob("*.yaml")), *sorted(CONFORMANCE.glob("*.yaml"))]
NAMED = {path.stem: path.read_text("utf-8") for path in FILES}
# The relay with other delimiters, where no length gives the end of a packet.
DELIMITERS = {name: name for name in ("length", "slip", "cobs", "datagram")}
DELIMITERS["escape"] = "escape, escape: 0x10, start: 0x02, end: 0x03"
RELAYS = {
    f"relay_{name}": RELAY.replace("framing: {by: length}", f"framing: {{by: {text}}}")
    for name, text in DELIMITERS.items()
}
ICDS = {
    name: text
    for name, text in (NAMED | RELAYS).items()
    if "\n  link:\n    framing:" in text
}


def packets_of(icd, direction: str, source: random.Random) -> list[bytes]:
    """Return packets of all kinds of a direction with random values: messages,
    requests, and packets without a message.
    """
    link = link_of_node(icd, icd.nodes[0])
    form = link.stream
    packets = []
    for row in form.rows(direction):
        for size in {row.least, source.randint(row.least, row.most), row.most}:
            packets.append(stream_encode(link, row.id, bytes(size), direction))
            data = source.randbytes(size)
            packets.append(stream_encode(link, row.id, data, direction))
    for row in form.telemetry if direction == "telecommand" else ():
        if row.is_requested:
            packets.append(stream_encode_request(link, row.id))
    for number, packet in enumerate(form.packets):
        if packet.content == "none" and direction in packet.directions:
            ids = [row.id for row in (*form.telecommands, *form.telemetry)]
            for id in [*ids, 99] if packet.of("id") else [0]:
                try:
                    sent = stream_encode_packet(
                        link, number, id, direction, reason=source.choice([1, 2])
                    )
                except IcdError:  # no room for the value
                    sent = stream_encode_packet(link, number, id, direction)
                packets.append(sent)
    return packets


def lines_of(icd, direction: str, count: int) -> list[bytes]:
    """Return traffic of a direction: complete and damaged packets, and noise between
    them.
    """
    source = random.Random(11)
    packets = packets_of(icd, direction, source)
    one_packet = facts.of(icd, icd.nodes[0]).stream.delimited_by == "datagram"
    lines = [*packets] if packets else []
    for _ in range(count if packets else 0):
        line = bytearray()
        for packet in source.choices(packets, k=1 if one_packet else 3):
            line += packet
            if not one_packet:
                line += source.randbytes(source.choice([0, 0, 0, 1, 4]))
        if source.random() < 0.5 and line:
            at = source.randrange(len(line))
            line[at : at + 1] = source.randbytes(source.randrange(3))
        lines.append(bytes(line))
    return [line for line in lines if line]


def decoded(icd, direction: str, line: bytes) -> list[object]:
    """Return the result of the decoder of the Python runtime for a line."""
    decoder = StreamDecoder(link_of_node(icd, icd.nodes[0]), direction)
    events = [
        [
            event.event,
            event.id if event.event in ("message", "request", "packet") else None,
            event.data.hex(),
            dict(event.values),
            event.packet,
        ]
        for event in decoder.feed(line)
        if event.event != "gap"
    ]
    return [events, decoder.discarded + decoder.pending]


@pytest.mark.parametrize("name", ICDS)
def test_the_page_decodes_every_packet_as_the_python_runtime_does(name, tmp_path):
    icd = icd_of(ICDS[name], tmp_path)
    stream = facts.of(icd, icd.nodes[0]).stream
    form = json.loads(
        json.dumps(packet_formats.script_facts(stream, with_responses=True))
    )
    kinds = set()
    for direction in DIRECTIONS:
        if not stream.packets_of(direction):
            continue
        lines = lines_of(icd, direction, 100)
        script = json.dumps(str(SCRIPTS / "framed.js"))
        shown = node(
            f"""([form, direction, lines]) => lines.map((line) => {{
                const {{ events, lost }} = require({script}).decode(form, direction, Uint8Array.from(Buffer.from(line, "hex")));
                const hex = (bytes) => Buffer.from(bytes ?? []).toString("hex");
                const isValid = (one) => one.is === "message";
                return [events.filter(({{ event }}) => event !== "cut").map((one) => [
                    one.event, isValid(one) ? one.id : null, one.event === "packet" ? hex(one.frame) : hex(one.data),
                    isValid(one) ? one.values : {{}}, one.event === "packet" ? one.packet : null,
                ]), lost];
            }})""",
            [form, direction, [line.hex() for line in lines]],
        )
        expected = [decoded(icd, direction, line) for line in lines]
        different = [
            (line.hex(), *pair)
            for line, *pair in zip(lines, shown, expected, strict=True)
            if pair[0] != pair[1]
        ]
        assert different[:2] == []
        kinds.update(event[0] for events, _ in expected for event in events)
    assert "message" in kinds
    if name in RELAYS or name == "jbd":
        assert {"request", "packet"} <= kinds


@pytest.fixture(scope="module")
def relay(tmp_path_factory):
    return icd_of(RELAY, tmp_path_factory.mktemp("relay"))


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    file = folder / "relay.yaml"
    file.write_text(RELAY, "utf-8")
    result = make_site([file, LINKS / "jbd.yaml"])
    assert result.ok, result.findings
    write_site(result, folder / "site")
    return folder / "site"


def index_of(icd) -> dict:
    return json.loads(json.dumps(recognition.frame_index(Relations(icd))))


JBD = {
    "DD A5 03 00 FF FD 77": ["jbd", "Basic Information", "request", "", 3],
    "DD 03 80 00 FF 80 77": ["jbd", "Basic Information", "refusal", "", 3],
    "DD E1 80 00 FF 80 77": ["jbd", "Switch Off", "refusal", "", 225],
    "DD E1 00 00 00 00 77": ["jbd", "Switched Off", "telemetry", "", 225],
    "DD 5A E1 02 00 00 FF 1D 77": ["jbd", "Switch Off", "telecommand", "0000", 225],
}


def test_requests_naks_and_messages_can_be_pasted():
    icd = load([LINKS / "jbd.yaml"]).icd
    request, refusal = [*JBD][:2]
    # The request is also a NAK of the id 165, but no message has this id.
    texts = [*JBD, " ".join(JBD), f"{request} {refusal} DD 99 80 00 FF 80 77"]
    shown = on_the_page(index_of(icd), texts)
    two_packets = [JBD[request], JBD[refusal]]
    assert shown == [*([row] for row in JBD.values()), [*JBD.values()], two_packets]
    assert shown == [on_the_command_line(icd, text) for text in texts]
    first, *_ = recognize(icd, texts[-1])
    assert first.left_out == (
        "a packet `refusal` of jbd with the id 153 is a refusal, reason Error: "
        "no message has this id",
    )
    assert "7 bytes around the frame belong to none" in first.remarks


def test_traffic_of_several_packet_formats_is_decoded_like_on_the_command_line(relay):
    for icd in (relay, load([LINKS / "tfmini.yaml"]).icd):
        texts = [line.hex() for side in DIRECTIONS for line in lines_of(icd, side, 40)]
        # The command line has no interpretation without a message, as for `busy`.
        texts = [text for text in texts if "d5d6" not in text]
        shown = [
            row if not isinstance(row, dict) else None
            for row in on_the_page(index_of(icd), texts)
        ]
        expected = [on_the_command_line(icd, text) for text in texts]
        different = [
            row for row in zip(texts, shown, expected, strict=True) if row[1] != row[2]
        ]
        assert different[:2] == []
        assert sum(isinstance(row, list) for row in expected) > 40


def remarks_of(icd, texts: list[str]) -> list[object]:
    """Return title and remarks of the only interpretation of each text, or the error."""
    script = json.dumps(str(SCRIPTS / "recognize.js"))
    return node(
        f"""([index, texts]) => texts.map((text) => attempt(() => {{
            const [{{ what, message, remarks }}] = require({script}).recognize(index, text);
            return [what, message, remarks.join("; ")];
        }}))""",
        [index_of(icd), texts],
    )


def test_a_nak_has_its_reason_and_a_response_without_id_needs_no_message(relay):
    link = link_of_node(relay, relay.nodes[0])
    names = [packet.name for packet in link.stream.packets]
    refusal, busy = names.index("refusal"), names.index("busy")
    used = names.index("taken")
    sent = [
        stream_encode_packet(link, refusal, 0x0203, reason=1),
        stream_encode_packet(link, refusal, 0x0203, reason=7),
        stream_encode_packet(link, busy),
        stream_encode_packet(link, refusal, 0x0999, reason=2),
        stream_encode_request(link, 0x0203),
        stream_encode(link, 0x0102, bytes(2), "telemetry", status=1),
        stream_encode_packet(link, used, 0x0103),
    ]
    shown = remarks_of(relay, [packet.hex() for packet in sent])
    assert shown[:3] == [
        ["refusal", "Counters", "packet refusal; reason Too hot"],
        ["refusal", "Counters", "packet refusal; reason 7"],
        ["refusal", "", "packet busy"],
    ]
    assert shown[3]["error"] == (
        "a packet refusal of Relay with the id 09 99 is a refusal, reason Locked: "
        "no message has this id"
    )
    assert shown[4] == ["request", "Counters", "header with id 02 03 removed"]
    assert shown[5] == [
        "telemetry",
        "Temperature",
        "header with id 01 02 removed; it has status 1",
    ]
    assert shown[6] == ["acknowledge", "Blink", "packet taken"]


@pytest.mark.parametrize(
    ("packet", "text"),
    [
        ("C2 02", "a packet of Relay is cut off: 2 bytes came, its header has 3"),
        (
            "C2 02 03 00",
            "a packet of Relay, request of Counters (telemetry 02 03) is cut off: "
            "4 bytes came, 6 are needed",
        ),
        (
            "C2 02 03 00 00 00",
            "a packet of Relay, request of Counters (telemetry 02 03) has a wrong "
            "checksum: it is 00, expected C3",
        ),
        (
            "D2 D3 00 01",
            "a packet of Relay, Beat (telemetry 02 04) is cut off: 4 bytes came, "
            "6 are needed",
        ),
        (
            "C1 02 07 04 01 00 00",
            "a packet of Relay with the id 02 04 has a wrong checksum: it is 00 00, "
            "expected 3C F8",
        ),
        (
            "D4 02 03",
            "a packet refusal of Relay with the id 02 03 is cut off: 3 bytes came, "
            "its header has 4",
        ),
        (
            "C2 09 99 00 00",
            "a packet of Relay with the id 09 99 is no message: it has no message with "
            "this id",
        ),
        (
            "D4 09 99 02 00 46",
            "a packet refusal of Relay with the id 09 99 is a refusal, reason Locked: "
            "no message has this id",
        ),
    ],
)
def test_the_page_gives_the_reason_for_any_undecodable_packet(relay, packet, text):
    (shown,) = remarks_of(relay, [packet])
    assert text in str(shown)
    with pytest.raises(UserError) as wrong:
        recognize(relay, packet)
    reason = str(wrong.value).replace("`", "").replace("relay has", "it has")
    assert text in reason.replace("relay", "Relay")


def test_the_page_of_a_message_decodes_its_packet_and_names_other_packets(relay):
    relations = Relations(relay)
    link = link_of_node(relay, relay.nodes[0])
    telecommand, beat, temperature, request, refusal = (
        stream_encode(link, 0x0102, b"\1\2").hex(),
        stream_encode(link, 0x0204, b"\3\4\5", "telemetry").hex(),
        stream_encode(link, 0x0102, b"\6\7", "telemetry").hex(),
        stream_encode_request(link, 0x0102).hex(),
        stream_encode_packet(link, 4, 0x0102, reason=1).hex(),
    )
    shown = {}
    for message in relay.nodes[0].messages:
        results = node(
            """([wire, length, texts]) => texts.map((text) => attempt(() =>
                Buffer.from(given.messageIn(wire, length, text).data).toString("hex")))""",
            [
                wire.page_facts(message, relations.wire(message)),
                message.length,
                [telecommand, beat + temperature, beat, request, refusal],
            ],
        )
        shown[message.name] = [
            text if isinstance(text, str) else text["error"] for text in results
        ]
    assert shown["Set Contact"][0] == "0102"
    assert shown["Temperature"][1] == "0607" and shown["Beat"][1] == "030405"
    assert shown["Beat"][2] == "030405"
    assert "another message's" in shown["Temperature"][2]
    assert shown["Temperature"][3] == "a request of this message, which carries no data"
    assert shown["Temperature"][4] == "a packet refusal, which carries no message"
    # An id of the other direction does not make it this message.
    assert not re.fullmatch("[0-9a-f]{4}", shown["Temperature"][0])


def test_the_protocol_page_shows_each_packet_format(site):
    page = plain(site / "relay" / "protocol.html")
    for words in (
        "A packet ends where its length says. In a packet without a length the data "
        "are as long as the message.",
        "Packet order Sent by host Carries Set Contact , Blink",
        "Packet question Its two bytes of data mean nothing Sent by host",
        "Requests Temperature , Counters , with 2 bytes of zeros as data",
        "Packet report Sent by device Carries Done , Temperature , Counters",
        "Packet beat Sent by device Carries Beat",
        "Packet refusal Sent by device Carries no message Responds to Set Contact , "
        "Blink , requests of telemetry",
        "id header, bits 8 to 15 identifies the message: bits 8 to 15 of its id",
        "id header, bits 24 to 31 identifies the message: bits 0 to 7 of its id",
        "status header, bits 24 to 31 says whether it succeeded State",
        "reason header, bits 24 to 31 says why it was refused Reason",
        "packet refusal refuses id = id reason in reason",
        "packet busy the device is busy",
        "Packet taken Sent by device Carries no message Responds to Blink",
        "Blink confirms: packet taken ; refuses: packet refusal ; the device is busy: "
        "packet busy",
        "Requests of telemetry Requested by packet question with its id "
        "Telemetry Temperature , Counters",
        "Time-out 250 ms",
        "without the leading term 0x1021",
    ):
        assert words in page, words
    text = (site / "relay" / "protocol.html").read_text("utf-8")
    assert 'href="../relay/enum-reason.html">Reason</a>' in text
    assert 'href="../relay/protocol.html#packet-refusal">packet refusal</a>' in text
    assert 'id="packet-refusal"' in text
    assert ">1 byte<" in text and ">2 bytes<" in text  # reserved data, in the drawings
    assert 'protocol.html#packet-beat"' in (site / "search-index.js").read_text("utf-8")


def test_the_page_of_a_message_shows_its_request_and_the_packet_in_which_it_is_sent(
    site,
):
    text = (site / "relay" / "counters.html").read_text("utf-8")
    page = plain(site / "relay" / "counters.html")
    assert "Requested by packet question with its id" in page
    assert "Refused by packet refusal" in page and "Time-out 250 ms" in page
    assert "Request C2 02 03 00 00 C3 Telemetry D1 02 03 " in page
    assert 'title="header of question: constant, id"' in text
    assert 'title="header of report: constant, id, status, length"' in text
    beat = plain(site / "relay" / "beat.html")
    assert "Telemetry D2 D3 " in beat and "Request" not in beat


def test_a_link_with_one_format_shows_it_without_a_name(tmp_path):
    write_site(make_site([LINKS / "ubx.yaml"]), tmp_path)
    text = (tmp_path / "receiver" / "protocol.html").read_text("utf-8")
    assert text.count('aria-label="A packet"') == 1
    assert "Sent by" not in text and "Packet " not in plain(
        tmp_path / "receiver" / "protocol.html"
    )


def test_a_nak_pasted_on_the_first_page_leads_to_its_message(browser, site):
    with opened(browser, site.as_uri() + "/", "index.html") as page:
        page.fill("#paste", "DD A5 03 00 FF FD 77 DD 03 80 00 FF 80 77")
        page.wait_for_selector("#pasted li")
        shown = page.inner_text("#pasted")
        assert "request for Basic Information" in shown
        assert "refusal of Basic Information" in shown and "reason Error" in shown
        page.fill("#paste", "D5 D6 03")
        page.wait_for_selector("#pasted li a[href*='relay/protocol.html']")
        assert page.inner_text("#pasted li a") == "refusal"


def test_names_of_packets_are_escaped(tmp_path):
    hostile = "</script><img src=x>"
    content = RELAY.replace(" refusal:", f' "{hostile}":')
    content = content.replace("packet: refusal", f'packet: "{hostile}"')
    file = tmp_path / "relay.yaml"
    file.write_text(content, "utf-8")
    result = make_site([file])
    assert result.ok, result.findings
    write_site(result, tmp_path / "site")
    pages = [page.read_text("utf-8") for page in (tmp_path / "site").rglob("*.html")]
    assert not [page for page in pages if "<img" in page]
    anchors = re.findall('id="(packet-[^"]*)"', "".join(pages))
    assert len(anchors) == len(set(anchors)) == 7
    assert all(re.fullmatch(r"packet-\w+", anchor) for anchor in anchors)
