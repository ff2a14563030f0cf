"""The page accepts the same forms of frames as the command line, with the same results."""

from __future__ import annotations

import json
import random

import pytest

from icdgen.backends.html import wire
from icdgen.backends.html.relations import Relations
from icdgen.errors import UserError
from icdgen.protocol.facts import of
from icdgen.recognize import read_pasted, recognize
from icdgen.runtime_objects.links import link_of
from icdgen.values.errors import BadHex
from icdgen.values.find import find_message
from tests.conftest import ROOT
from tests.recognize.test_identifiers import BRAKE, DRIVE, train
from tests.recognize.ways import BARE, DATA, WHOLE
from tests.site.javascript import run_script

# Remote requests of 11 and 29 bits, also with a time.
REMOTE = ["100#R", "can0 100 [8] remote request", "r1008", "r10081234", "R059202016"]
GIVEN = ROOT / "templates" / "html" / "given.js"


def node(script: str, argument: object) -> object:
    """Return the result of a script that gets the argument."""
    code = f"""
        const given = require({json.dumps(str(GIVEN))});
        const pasted = require({json.dumps(str(GIVEN.with_name("pasted.js")))});
        const attempt = (call) => {{ try {{ return call(); }} catch (error) {{ return {{ error: error.message }}; }} }};
        return ({script})(argument);
    """
    return run_script(code, argument)


def test_every_way_to_paste_a_frame_is_read_as_on_the_command_line():
    texts = [*BARE.values(), *WHOLE.values(), *REMOTE]
    source = random.Random(1)
    for text in list(texts):  # and with typing errors
        for _ in range(30):
            at = source.randrange(len(text))
            texts.append(
                text[:at]
                + source.choice(["", " ", "x", "0", "=", "\n", "[", "#"])
                + text[at + 1 :]
            )

    def expected(text: str) -> object:
        try:
            paste = read_pasted(text)
        except BadHex:
            return None
        return [
            list(paste.data),
            [[p.id, list(p.data), p.extended, p.time] for p in paste.packets],
            paste.form,
        ]

    results = node(
        """(texts) => texts.map((text) => attempt(() => {
            const { data, form, packets } = pasted.read(text);
            return [[...(data ?? [])], (packets ?? []).map((p) => [p.id, [...p.data], p.extended, p.time]), form ?? ""];
        })).map((one) => (one.error ? null : one))""",
        texts,
    )
    assert [
        (t, f, expected(t))
        for t, f in zip(texts, results, strict=True)
        if f != expected(t)
    ] == []
    assert sum(f is None for f in results) > 100


def facts(icd, id: int) -> tuple[dict, int]:
    owner = icd.node("cubeacp")
    facts_of_owner = of(icd, owner)
    message = facts_of_owner.telemetry[id]
    section, link = owner.protocol, link_of(icd, facts_of_owner)
    return (
        wire.page_facts(
            message,
            wire.Wire(
                facts_of_owner,
                section,
                link,
                [wire.Speaker(facts_of_owner, section, link)],
            ),
        ),
        message.length,
    )


def test_the_page_of_the_message_accepts_every_form(shipped):
    texts = [*BARE.values(), *WHOLE.values()]
    results = node(
        "([[wire, length], texts]) => texts.map((t) => attempt(() => [...given.messageIn(wire, length, t).data]))",
        [facts(shipped, 146), texts],
    )
    assert [
        (t, f) for t, f in zip(texts, results, strict=True) if f != list(DATA)
    ] == []


def around(source: random.Random, message, ids: list[int]) -> str:
    """Return frames of this and other messages, complete and damaged, with noise
    between them, or without framing.
    """
    stream = b""
    for _ in range(source.randint(1, 3)):
        id = source.choice([*message.ids, source.choice(ids)])
        body = bytes([id]) + source.randbytes(
            source.choice([message.length, message.length, message.length + 1, 0, 2])
        )
        line = b"\x1f\x7f" + body.replace(b"\x1f", b"\x1f\x1f") + b"\x1f\xff"
        at = source.randrange(len(line)) if source.random() < 0.2 else len(line)
        stream += (
            source.choice([line, body])
            if source.random() < 0.2
            else line[:at] + line[at + 1 :]
        )
        stream += source.randbytes(source.choice([0, 0, 1, 4]))
    return stream.hex(" ")


@pytest.mark.parametrize("key", ["146", "1", "Commanded Attitude Angles"])
def test_the_page_of_a_message_decodes_a_stream_like_the_command_line(shipped, key):
    source = random.Random(key)
    message = find_message(shipped, "cubeacp", key)
    ids = [
        id
        for message in shipped.messages_of(shipped.node("cubeacp"))
        for id in message.ids
    ]
    texts = [around(source, message, ids) for _ in range(400)]

    def expected(text: str) -> str | None:
        try:
            findings = recognize(shipped, text, "cubeacp", key)
        except UserError:
            return None
        frames = [
            piece.data
            for piece in findings
            if piece.what in ("telecommand", "telemetry", "configuration")
        ]
        return frames[0].hex() if frames else None

    facts = of(shipped, shipped.node("cubeacp"))
    travels = Relations(shipped).wire(message)
    travels = travels._replace(
        facts=facts,
        checked=[
            checked for checked in travels.checked if checked.facts.node is facts.node
        ],
    )
    results = node(
        """([wire, length, texts]) => texts.map((text) =>
            attempt(() => Buffer.from(given.messageIn(wire, length, text).data).toString("hex")))""",
        [wire.page_facts(message, travels), message.length, texts],
    )
    shown = [
        answer
        if isinstance(answer, str) and len(answer) == 2 * message.length
        else None
        for answer in results
    ]
    assert [
        (t, f, expected(t))
        for t, s, f in zip(texts, shown, results, strict=True)
        if s != expected(t)
    ] == []
    assert 50 < sum(frame is not None for frame in shown) < 390


def test_the_page_of_a_message_only_decodes_packets_with_its_identifier(
    tmp_path,
):
    icd = train(tmp_path)
    relations, message = Relations(icd), find_message(icd, "train", "Brake")
    texts = [f"101#{BRAKE}", f"100#{DRIVE}\n101#{BRAKE}", f"100#{DRIVE}"]
    results = node(
        """([wire, length, texts]) => texts.map((text) => attempt(() => {
            const { data, remarks } = given.messageIn(wire, length, text);
            return [Buffer.from(data).toString("hex"), ...remarks];
        }))""",
        [wire.page_facts(message, relations.wire(message)), message.length, texts],
    )
    used = [BRAKE, "CAN identifier 0x101 removed"]
    assert results[:2] == [used, [*used, "1 other CAN packet left out"]]
    assert "CAN identifier 0x100, which is not this message's" in str(results[2])


def test_packets_of_a_long_message_are_joined_in_any_order(shipped):
    facts_of_node = of(shipped, shipped.node("cubeacp"))
    id, message = next(
        (i, m) for i, m in facts_of_node.telemetry.items() if m.length > 21
    )
    data = bytes(range(message.length))
    pieces = [data[at : at + 7].ljust(7, b"\0") for at in range(0, len(data), 7)]
    lines = [
        f"08{id:02X}0201#{piece.hex()}{len(pieces) - 1 - n:02x}"
        for n, piece in enumerate(pieces)
    ]
    results = node(
        """([[wire, length], lines]) => [
            [...given.messageIn(wire, length, [...lines].reverse().join("\\n")).data],
            attempt(() => given.messageIn(wire, length, lines.slice(1).join("\\n"))).error,
            attempt(() => given.messageIn(wire, length, "04110201#")).error,
            attempt(() => given.messageIn(wire, length, `04${wire.ids[0].toString(16)}0201#`)).error,
        ]""",
        [facts(shipped, id), lines],
    )
    assert (
        results[0] == list(data)
        and "packets are missing" in results[1]
        and "another message's" in results[2]
    )
    assert "carry no data" in results[3]
