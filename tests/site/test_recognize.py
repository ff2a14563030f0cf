"""The page recognises the same frames as the command line, with the same results."""

from __future__ import annotations

import json
import random

import pytest

from icdgen.backends.html import recognition
from icdgen.backends.html.relations import Relations
from icdgen.errors import UserError
from icdgen.recognize import recognize
from icdgen.values.errors import Ambiguous
from tests.conftest import ROOT
from tests.recognize.test_identifiers import BRAKE, CANDUMP, DRIVE, train
from tests.recognize.ways import BARE, WHOLE
from tests.site.javascript import run_script

SCRIPT = ROOT / "templates" / "html" / "recognize.js"


def on_the_page(index: dict, texts: list[str]) -> list[object]:
    """Return for each text the interpretations, the number of equally likely messages,
    or the error.
    """
    code = f"""
        const {{ recognize, Ambiguous }} = require({json.dumps(str(SCRIPT))});
        const [index, texts] = argument;
        const plain = (one) => [one.node, one.message, one.what, Buffer.from(one.data).toString("hex"), one.id];
        return texts.map((text) => {{
            try {{ return recognize(index, text).map(plain); }}
            catch (error) {{ return error instanceof Ambiguous ? "ambiguous" : {{ error: error.message }}; }}
        }});
    """
    return run_script(code, [index, texts])


def on_the_command_line(icd, text: str) -> object:
    try:
        findings = recognize(icd, text)
    except Ambiguous:
        return "ambiguous"
    except UserError:
        return None
    return [
        [
            finding.endpoint.node.name,
            finding.message.name,
            finding.what,
            finding.data.hex(),
            finding.id,
        ]
        for finding in findings
    ]


def streams(icd) -> list[str]:
    """Return random traffic, complete and damaged: framed, unframed, with and without
    ids, as CAN packets.
    """
    source = random.Random(7)
    messages = [m for node in icd.nodes for m in icd.messages_of(node)]
    texts = []
    for _ in range(700):
        message = source.choice(messages)
        data = source.randbytes(
            message.length if source.random() < 0.8 else source.randrange(12)
        )
        id = source.choice(message.ids)
        body = (
            bytes([id]) + data + (source.randbytes(1) if source.random() < 0.2 else b"")
        )
        line = b"\x1f\x7f" + body.replace(b"\x1f", b"\x1f\x1f") + b"\x1f\xff"
        if source.random() < 0.3:
            line = (
                source.randbytes(source.randrange(4)) + line + b"\x1f\x7f\x92\x1f\xff"
            )
        at = source.randrange(len(line))
        damaged = line[:at] + source.randbytes(source.randrange(2)) + line[at + 1 :]
        texts += [stream.hex() for stream in (line, body, data, damaged) if stream]
        texts.append(
            "\n".join(stream.hex(" ") for stream in (body, body[:3]) if stream)
        )
        kind = 1 if message.telecommand_id == id else 5
        if len(data) <= 8:
            texts.append(f"can0 {kind:02X}{id:02X}0201#{data.hex()}")
            continue
        pieces = [data[at : at + 7].ljust(7, b"\0") for at in range(0, len(data), 7)]
        kind = 7 if message.telecommand_id == id else 8
        rows = [
            f"{kind:02X}{id:02X}0201#{piece.hex()}{len(pieces) - 1 - n & 255:02x}"
            for n, piece in enumerate(pieces)
        ]
        texts.append("\n".join(rows if source.random() < 0.7 else rows[1:]))
    return texts


@pytest.fixture(scope="module")
def index(shipped) -> dict:
    return json.loads(json.dumps(recognition.frame_index(Relations(shipped))))


def test_every_way_to_paste_a_frame_leads_to_the_same_message(shipped, index):
    texts = [*BARE.values(), *WHOLE.values()]
    expected = [on_the_command_line(shipped, text) for text in texts]
    assert on_the_page(index, texts) == expected
    assert expected.count("ambiguous") == len(BARE)


def test_random_traffic_is_decoded_like_on_the_command_line(shipped, index):
    texts = streams(shipped)
    shown = [
        answer if not isinstance(answer, dict) else None
        for answer in on_the_page(index, texts)
    ]
    expected = [on_the_command_line(shipped, text) for text in texts]
    different = [
        (t, s, e) for t, s, e in zip(texts, shown, expected, strict=True) if s != e
    ]
    assert different[:3] == []
    assert (
        min(sum(e is None for e in expected), sum(e == "ambiguous" for e in expected))
        > 100
    )
    assert sum(isinstance(e, list) for e in expected) > 1000


def test_identifiers_that_are_ids_are_read_as_the_command_line_reads_them(tmp_path):
    icd = train(tmp_path)
    texts = [
        f"can0 {id}#{data}"
        for id in ("100", "101", "200", "18914001", "7FF", "00000300")
        for data in (DRIVE, "01", "01F4", "")
    ]
    texts += [f"t1008{DRIVE}", "100#R", f"100#{DRIVE}\n7FF#00\n101#{BRAKE}"]
    expected = [on_the_command_line(icd, text) for text in texts]
    shown = on_the_page(
        json.loads(json.dumps(recognition.frame_index(Relations(icd)))), texts
    )
    assert [
        answer if not isinstance(answer, dict) else None for answer in shown
    ] == expected
    assert (
        "no message has the CAN identifier 0x7FF" in str(shown)
        and "ambiguous" in expected
    )
    assert sum(isinstance(answer, list) for answer in expected) == 10


def test_invalid_input_is_reported(index):
    expected = {
        "1F 7F 92 2E FB": "end of the message is missing",
        "1F 7F 92 2E 1F 02 1F FF": "followed by neither",
        "1F 7F 92 2E FB 1F FF": "has 6 bytes, 2 given after the id 146",
        "can0 123 [1] 00": "11-bit",
        "can0 1F920201 [1] 00": "is none of",
        "2exb01": "not hexadecimal",
        "1F 7F 6F 1F FF": "no message has the id",
    }
    answers = on_the_page(index, list(expected))
    assert [
        (text, answer)
        for (text, says), answer in zip(expected.items(), answers, strict=True)
        if says not in answer["error"]
    ] == []


def test_the_page_shows_times_of_candump_and_reports_unknown_packets(
    tmp_path,
):
    icd = train(tmp_path)
    index = json.loads(json.dumps(recognition.frame_index(Relations(icd))))
    code = f"""
        const {{ recognize }} = require({json.dumps(str(SCRIPT))});
        return recognize(...argument).map((one) => [one.time, one.leftOut]);
    """
    assert run_script(code, [index, CANDUMP]) == [
        [
            "1600000000.250000",
            ["no message has the CAN identifier 0x7FF (1 CAN packet)"],
        ],
        ["1600000002.000000", []],
    ]
