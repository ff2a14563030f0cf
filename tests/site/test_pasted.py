"""The page takes what the command line takes, and makes the same of it."""

from __future__ import annotations

import json
import random
import subprocess

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
from tests.site.conftest import program

# Remote requests of 11 and 29 bits, also with a time.
REMOTE = ["100#R", "can0 100 [8] remote request", "r1008", "r10081234", "R059202016"]
GIVEN = ROOT / "templates" / "html" / "given.js"


def node(script: str, argument: object) -> object:
    """What a script gives that is called with the argument."""
    code = f"""
        const given = require({json.dumps(str(GIVEN))});
        const pasted = require({json.dumps(str(GIVEN.with_name("pasted.js")))});
        const argument = JSON.parse(require("node:fs").readFileSync(0, "utf8"));
        const attempt = (call) => {{ try {{ return call(); }} catch (error) {{ return {{ error: error.message }}; }} }};
        process.stdout.write(JSON.stringify(({script})(argument)));
    """
    done = subprocess.run(
        [program("node"), "-e", code],
        input=json.dumps(argument),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_every_way_to_paste_a_frame_is_read_as_on_the_command_line():
    texts = [*BARE.values(), *WHOLE.values(), *REMOTE]
    source = random.Random(1)
    for text in list(texts):  # and what a slip of the hand makes of them
        for _ in range(30):
            at = source.randrange(len(text))
            texts.append(
                text[:at]
                + source.choice(["", " ", "x", "0", "=", "\n", "[", "#"])
                + text[at + 1 :]
            )

    def expected(text: str) -> object:
        try:
            found = read_pasted(text)
        except BadHex:
            return None
        return [
            list(found.data),
            [[p.id, list(p.data), p.extended, p.time] for p in found.packets],
            found.form,
        ]

    found = node(
        """(texts) => texts.map((text) => attempt(() => {
            const { data, form, packets } = pasted.read(text);
            return [[...(data ?? [])], (packets ?? []).map((p) => [p.id, [...p.data], p.extended, p.time]), form ?? ""];
        })).map((one) => (one.error ? null : one))""",
        texts,
    )
    assert [
        (t, f, expected(t))
        for t, f in zip(texts, found, strict=True)
        if f != expected(t)
    ] == []
    assert sum(f is None for f in found) > 100


def facts(icd, id: int) -> tuple[dict, int]:
    owner = icd.node("cubeacp")
    known = of(icd, owner)
    message = known.telemetry[id]
    section, link = owner.protocol, link_of(icd, known)
    return (
        wire.page_facts(
            message,
            wire.Wire(known, section, link, [wire.Speaker(known, section, link)]),
        ),
        message.length,
    )


def test_the_page_of_the_message_takes_every_way(shipped):
    texts = [*BARE.values(), *WHOLE.values()]
    found = node(
        "([[wire, length], texts]) => texts.map((t) => attempt(() => [...given.messageIn(wire, length, t).data]))",
        [facts(shipped, 146), texts],
    )
    assert [(t, f) for t, f in zip(texts, found, strict=True) if f != list(DATA)] == []


def around(source: random.Random, message, ids: list[int]) -> str:
    """Frames of the message and of others, whole and damaged, with noise between them,
    or no framing at all.
    """
    found = b""
    for _ in range(source.randint(1, 3)):
        id = source.choice([*message.ids, source.choice(ids)])
        body = bytes([id]) + source.randbytes(
            source.choice([message.length, message.length, message.length + 1, 0, 2])
        )
        line = b"\x1f\x7f" + body.replace(b"\x1f", b"\x1f\x1f") + b"\x1f\xff"
        at = source.randrange(len(line)) if source.random() < 0.2 else len(line)
        found += (
            source.choice([line, body])
            if source.random() < 0.2
            else line[:at] + line[at + 1 :]
        )
        found += source.randbytes(source.choice([0, 0, 1, 4]))
    return found.hex(" ")


@pytest.mark.parametrize("key", ["146", "1", "Commanded Attitude Angles"])
def test_the_page_of_a_message_makes_of_a_stream_what_the_command_line_makes(
    shipped, key
):
    source = random.Random(key)
    message = find_message(shipped, "cubeacp", key)
    ids = [id for one in shipped.messages_of(shipped.node("cubeacp")) for id in one.ids]
    texts = [around(source, message, ids) for _ in range(400)]

    def expected(text: str) -> str | None:
        try:
            found = recognize(shipped, text, "cubeacp", key)
        except UserError:
            return None
        whole = [
            one.data
            for one in found
            if one.what in ("telecommand", "telemetry", "configuration")
        ]
        return whole[0].hex() if whole else None

    known = of(shipped, shipped.node("cubeacp"))
    travels = Relations(shipped).wire(message)
    travels = travels._replace(
        facts=known,
        checked=[one for one in travels.checked if one.facts.node is known.node],
    )
    found = node(
        """([wire, length, texts]) => texts.map((text) =>
            attempt(() => Buffer.from(given.messageIn(wire, length, text).data).toString("hex")))""",
        [wire.page_facts(message, travels), message.length, texts],
    )
    shown = [
        one if isinstance(one, str) and len(one) == 2 * message.length else None
        for one in found
    ]
    assert [
        (t, f, expected(t))
        for t, s, f in zip(texts, shown, found, strict=True)
        if s != expected(t)
    ] == []
    assert 50 < sum(one is not None for one in shown) < 390


def test_the_page_of_a_message_takes_the_packet_whose_identifier_is_its_id_and_no_other(
    tmp_path,
):
    icd = train(tmp_path)
    relations, message = Relations(icd), find_message(icd, "train", "Brake")
    texts = [f"101#{BRAKE}", f"100#{DRIVE}\n101#{BRAKE}", f"100#{DRIVE}"]
    found = node(
        """([wire, length, texts]) => texts.map((text) => attempt(() => {
            const { data, remarks } = given.messageIn(wire, length, text);
            return [Buffer.from(data).toString("hex"), ...remarks];
        }))""",
        [wire.page_facts(message, relations.wire(message)), message.length, texts],
    )
    taken = [BRAKE, "CAN identifier 0x101 removed"]
    assert found[:2] == [taken, [*taken, "1 other CAN packet left out"]]
    assert "CAN identifier 0x100, which is not this message's" in str(found[2])


def test_packets_of_a_long_message_are_joined_whatever_their_order(shipped):
    known = of(shipped, shipped.node("cubeacp"))
    id, message = next((i, m) for i, m in known.telemetry.items() if m.length > 21)
    data = bytes(range(message.length))
    pieces = [data[at : at + 7].ljust(7, b"\0") for at in range(0, len(data), 7)]
    lines = [
        f"08{id:02X}0201#{piece.hex()}{len(pieces) - 1 - n:02x}"
        for n, piece in enumerate(pieces)
    ]
    found = node(
        """([[wire, length], lines]) => [
            [...given.messageIn(wire, length, [...lines].reverse().join("\\n")).data],
            attempt(() => given.messageIn(wire, length, lines.slice(1).join("\\n"))).error,
            attempt(() => given.messageIn(wire, length, "04110201#")).error,
            attempt(() => given.messageIn(wire, length, `04${wire.ids[0].toString(16)}0201#`)).error,
        ]""",
        [facts(shipped, id), lines],
    )
    assert (
        found[0] == list(data)
        and "packets are missing" in found[1]
        and "another message's" in found[2]
    )
    assert "carry no data" in found[3]
