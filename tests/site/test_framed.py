"""Pages decode packets of framed links like the command line, and show the packet
formats.
"""

from __future__ import annotations

import json
import random
import re

import pytest

from icdgen.backends.html import recognition, wire
from icdgen.backends.html.relations import Relations
from icdgen.errors import UserError
from icdgen.icd.fmt import format_text
from icdgen.loading import load
from icdgen.recognize import recognize
from icdgen.recognize.framed import sync_of
from icdgen.recognize.reading import endpoint_of
from icdgen.site import make_site, write_site
from icdgen.vectors.make import make_vectors
from tests.conftest import ROOT
from tests.features.framed import recorded
from tests.features.outputs import icd_of as motor_of
from tests.recognize.test_asked import LIMIT, load_pack, sent
from tests.recognize.test_cut_frames import MOTOR, POWER, SPEED, packets, prefixes
from tests.site.test_pasted import node
from tests.site.test_recognize import on_the_command_line, on_the_page

LINKS = ROOT / "examples" / "links"
NAMES = sorted(file.stem for file in LINKS.glob("*.yaml"))


def icd_of(name: str):
    loaded = load([LINKS / f"{name}.yaml"])
    assert loaded.ok
    return loaded.icd


def traffic(icd, count: int) -> list[str]:
    """Return messages of a link: complete, damaged, and among noise."""
    source, device = random.Random(7), icd.nodes[0]
    frames = {
        message.message.name: [row.frame for row in message.rows]
        for message in make_vectors(icd, device).messages
    }
    packets = []
    for _ in range(count):
        line = bytearray()
        for name in source.choices(sorted(frames), k=source.randint(1, 3)):
            sent = recorded(icd, device, {name: [source.choice(frames[name])]})
            line += source.choice([frame for frame in sent.values() if frame] or [b""])
            line += source.randbytes(source.choice([0, 0, 0, 1, 5]))
        if line and source.random() < 0.3:
            at = source.randrange(len(line))
            line[at : at + 1] = source.randbytes(source.randrange(2))
        if line:
            packets.append(bytes(line).hex())
    return packets


@pytest.mark.parametrize("name", NAMES)
def test_pasted_packets_are_decoded_like_on_the_command_line(name):
    icd = icd_of(name)
    index = json.loads(json.dumps(recognition.frame_index(Relations(icd))))
    texts = traffic(icd, 200)
    shown = [
        answer if not isinstance(answer, dict) else None
        for answer in on_the_page(index, texts)
    ]
    expected = [on_the_command_line(icd, text) for text in texts]
    assert [
        row for row in zip(texts, shown, expected, strict=True) if row[1] != row[2]
    ][:2] == []
    assert sum(isinstance(answer, list) for answer in expected) > 30


@pytest.mark.parametrize("name", NAMES)
def test_a_truncated_golden_frame_is_not_decoded_on_the_page(name):
    icd = icd_of(name)
    index = json.loads(json.dumps(recognition.frame_index(Relations(icd))))
    sent_frames = [packet for _, packet in packets(icd)]
    cuts = [cut.hex() for packet in sent_frames for cut in prefixes(packet, 20)]
    assert [
        row
        for row in zip(cuts, on_the_page(index, cuts), strict=True)
        if isinstance(row[1], list)
    ] == []
    source = random.Random(3)
    ends = [
        packet[source.randrange(1, len(packet)) :].hex()
        for packet in sent_frames
        for _ in range(6)
    ]
    holes = []
    for packet in sent_frames:
        at = source.randrange(1, len(packet))
        holes.append((packet[:at] + packet[at + 2 :]).hex())
    texts = [*ends, *holes]
    shown = [
        answer if not isinstance(answer, dict) else None
        for answer in on_the_page(index, texts)
    ]
    assert shown == [on_the_command_line(icd, text) for text in texts]


@pytest.mark.parametrize("name", NAMES)
def test_the_page_of_a_message_does_not_decode_a_truncated_packet_as_data(name):
    icd = icd_of(name)
    relations = Relations(icd)
    for message in icd.nodes[0].messages:
        facts = wire.page_facts(message, relations.wire(message))
        cuts = [cut.hex() for _, packet in packets(icd) for cut in prefixes(packet, 20)]
        result = node(
            """([wire, length, texts]) => texts.map((text) => attempt(() => {
                const { data, remarks } = given.messageIn(wire, length, text);
                const [least, step] = wire.lengths ?? [length, 1];
                const fits = data.length >= least && data.length <= length && (data.length - least) % step === 0;
                return fits && !remarks.length ? text : null;
            })).filter((one) => typeof one === "string")""",
            [facts, message.length, cuts],
        )
        has_sync = bool(sync_of(endpoint_of(icd, icd.nodes[0])))
        assert result == [] or not has_sync, message.name


def test_the_page_gives_the_reasons_of_the_command_line(
    tmp_path,
):
    motor = motor_of(MOTOR, tmp_path)
    index = json.loads(json.dumps(recognition.frame_index(Relations(motor))))
    texts = [
        "a55a03020186",
        POWER[:-2] + "0f",
        "a55a090009",
        "a55a030107 0b",
        "a55a03ff",
        "a5",
        "000102",
    ]
    for text, answer in zip(texts, on_the_page(index, texts), strict=True):
        with pytest.raises(UserError) as wrong:
            recognize(motor, text)
        plain = (
            str(wrong.value)
            .replace("`", "")
            .replace("motor has", "it has")
            .replace("motor", "Motor")
        )
        assert (
            answer["error"] == plain
            if plain.startswith("a packet")
            else "no packet of Motor" in answer["error"]
        )


def test_the_page_reads_packets_of_both_directions_and_reports_the_others(tmp_path):
    motor = motor_of(MOTOR, tmp_path)
    index = json.loads(json.dumps(recognition.frame_index(Relations(motor))))
    text = SPEED + "a55a090009" + POWER + "a55a03"
    (shown,) = on_the_page(index, [text])
    assert shown == on_the_command_line(motor, text) and len(shown) == 2
    script = json.dumps(str(ROOT / "templates" / "html" / "recognize.js"))
    left = node(
        f"([index, text]) => require({script}).recognize(index, text)[0].leftOut",
        [index, text],
    )
    assert left == [
        reason.replace("`", "").replace("motor has", "it has").replace("motor", "Motor")
        for reason in recognize(motor, text)[0].left_out
    ]


def test_the_page_of_a_message_removes_the_header():
    icd = icd_of("ubx")
    relations = Relations(icd)
    message = next(
        message for message in icd.nodes[0].messages if message.name == "End of Epoch"
    )
    facts = wire.page_facts(message, relations.wire(message))
    sent = recorded(
        icd, icd.nodes[0], {"End of Epoch": [bytes(4), bytes.fromhex("4AB37B0F")]}
    )["telemetry"]
    other = recorded(icd, icd.nodes[0], {"Navigation Clock": [bytes(20)]})["telemetry"]
    damaged = sent[:-1] + bytes([sent[-1] ^ 1])
    texts = [
        sent.hex(),
        (b"noise" + other + sent[12:]).hex(),
        damaged[12:].hex(),
        other.hex(),
    ]
    results = node(
        """([wire, length, texts]) => texts.map((text) => attempt(() => {
            const { data, remarks } = given.messageIn(wire, length, text);
            return [Buffer.from(data).toString("hex"), remarks.join("; ")];
        }))""",
        [facts, message.length, texts],
    )
    assert results[0] == [
        "00000000",
        "header with id 01 61 removed; 1 other frame left out",
    ]
    assert (
        results[1][0] == "4ab37b0f"
        and "33 bytes around the frame belong to none" in results[1][1]
    )
    assert "wrong checksum" in str(results[2]) and "another message's" in str(
        results[3]
    )


def test_the_page_removes_a_header_that_could_also_be_data(
    tmp_path,
):
    icd = load_pack(tmp_path)
    relations = Relations(icd)
    message = next(
        message for message in icd.nodes[0].messages if message.name == "Log"
    )
    facts = wire.page_facts(message, relations.wire(message))
    texts = [sent(icd, "telemetry", 261, b"ready"), b"ready".hex(), LIMIT]
    results = node(
        """([wire, length, texts]) => texts.map((text) => Buffer.from(given.messageIn(wire, length, text).data).toString("hex"))""",
        [facts, message.length, texts],
    )
    assert results == [
        recognize(icd, text, "pack", "Log")[0].data.hex() for text in texts
    ]


def test_the_page_of_the_protocol_shows_the_packet_format(tmp_path):
    file = tmp_path / "odd.yaml"
    hostile = "</script><img src=x>"
    content = (LINKS / "mavlink2.yaml").read_text().replace("x25", f'"{hostile}"')
    file.write_text(format_text(content, "odd.yaml"))
    result = make_site([file])
    assert result.ok, result.findings
    write_site(result, tmp_path / "site")
    text = (tmp_path / "site" / "autopilot" / "protocol.html").read_text("utf-8")
    assert hostile not in text and "<img" not in text
    plain = re.sub(r"\s+", " ", re.sub("<[^>]*>", " ", text))
    for words in (
        "sync header, bits 0 to 7 begins a message 253 (0xFD)",
        "source header, bits 40 to 47 says who sends 255 (0xFF) in telecommands, 1 (0x1) in telemetry",
        "A packet ends where its length says.",
        ", from the length to the data",
        "Heartbeat 50",
        "without the leading term 0x1021",
    ):
        assert words in plain, words
    message = (tmp_path / "site" / "autopilot" / "heartbeat.html").read_text("utf-8")
    assert (
        'title="header: constant, length' in message
        and 'title="trailer: checksum"' in message
    )


def test_ids_of_class_and_number_are_written_as_two_bytes(tmp_path):
    write_site(make_site([LINKS / "ubx.yaml"]), tmp_path / "ubx")
    page = (tmp_path / "ubx" / "receiver" / "end_of_epoch.html").read_text()
    assert '<span class="id"><b>01 61</b></span>' in page
    overview = (tmp_path / "ubx" / "receiver" / "index.html").read_text()
    assert (
        '<span id="telemetry-353">01 61</span>' in overview and ">Hex<" not in overview
    )
    assert "telemetry 01 61 " in (tmp_path / "ubx" / "search-index.js").read_text()


def test_other_ids_are_written_as_number_and_in_hexadecimal(tmp_path):
    write_site(make_site([LINKS / "mavlink1.yaml"]), tmp_path / "mavlink")
    pages = [page.read_text() for page in (tmp_path / "mavlink").rglob("*.html")]
    assert any(
        '<span class="id"><b>11</b> <code>0x0B</code></span>' in page for page in pages
    )
    assert any(
        ">Hex<" in page and '<td class="n hex">0B</td>' in page for page in pages
    )
