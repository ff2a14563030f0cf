"""The page reads pasted bytes like the command line."""

from __future__ import annotations

import json
import random
from dataclasses import replace

import pytest
from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.uart import uart_encode

from icdgen.backends.html.wire import crc_facts
from icdgen.protocol import declared
from icdgen.protocol.facts import of as facts_of
from icdgen.protocol.sections import Crc
from icdgen.runtime_objects.links import link_of
from icdgen.values.errors import BadHex
from icdgen.values.hexadecimal import parse_hex
from tests import links
from tests.conftest import ROOT
from tests.site.javascript import run_script

FRAMES = ROOT / "templates" / "html" / "frames.js"


def node(script: str, argument: object) -> object:
    """Return the result of a script that gets the frames module and the argument."""
    code = f"""
        const frames = require({json.dumps(str(FRAMES))});
        const {{ unwrap }} = require({json.dumps(str(FRAMES.with_name("given.js")))});
        const attempt = (call) => {{ try {{ return call(); }} catch (error) {{ return {{ error: error.message }}; }} }};
        return ({script})(argument);
    """
    return run_script(code, argument)


def spellings() -> list[str]:
    source = random.Random(1)
    words = [
        "2e", "FB", "0x2e", "0x5", "\\x1f", "$7f", "#aa", "x1", ", ", " ", "\n", ":", "-", "{", "}", "b'", "'", '"', "g", "é", "2",
        "٣", "0x", "_", "(", ")", ";", "xz",
    ]  # fmt: skip
    texts = [
        "".join(source.choices(words, k=source.randint(0, 6))) for _ in range(3000)
    ]
    return [
        "", " ", "2efb 0a00", "0x2e,0xfb", "2E:FB", "{0x2e, 0xfb}", r"\x2e\xfb", 'b"\\x2e"', "'2e'", "0x5, 0x6", "0x", "abc",
        "1F-7F", "2e fb", "zz", "0x0x", *texts,
    ]  # fmt: skip


def test_hexadecimal_is_read_as_on_the_command_line():
    def expected(text: str) -> list[int] | None:
        try:
            return list(parse_hex(text))
        except BadHex:
            return None

    texts = spellings()
    results = node(
        "(texts) => texts.map((t) => attempt(() => [...frames.parseHex(t)])).map((r) => (r.error ? null : r))",
        texts,
    )
    assert [t for t, f in zip(texts, results, strict=True) if f != expected(t)] == []
    assert (
        sum(f is not None for f in results) > 500
        and sum(f is None for f in results) > 500
    )


def facts(seed: int) -> dict:
    source = random.Random(seed)
    return {
        "width": 8, "polynomial": source.randrange(256), "init": source.randrange(256), "xor_out": source.randrange(256),
        "reflect_in": source.random() < 0.5, "reflect_out": source.random() < 0.5,
    } | ({"empty": source.randrange(256)} if seed % 2 else {})  # fmt: skip


def test_checksums_are_those_of_the_generator():
    cases = [
        [facts(seed), list(random.Random(seed).randbytes(seed % 12))]
        for seed in range(300)
    ]
    results = node(
        "(cases) => cases.map(([facts, data]) => frames.sum(facts, data))", cases
    )
    assert results == [
        links.crc(declared.read_part(Crc, checksum), bytes(data))
        for checksum, data in cases
    ]


@pytest.mark.parametrize(
    ("node_name", "key"), [("cubeacp", "crc8"), ("common", "crc16")]
)
def test_checksums_give_the_check_value_of_the_icd(shipped, node_name, key):
    protocol = shipped.node(node_name).protocol["link"]["checksums"][key]
    assert (
        links.crc(declared.read_part(Crc, protocol), b"123456789") == protocol["check"]
    )


CRC8 = {
    "width": 8, "polynomial": 0x12, "init": 0, "reflect_in": True, "reflect_out": True, "xor_out": 0, "empty": 255,
    "bytes": 1,
}  # fmt: skip
WIRE = {
    "ids": [0x1F, 200],
    "id": 0x1F,
    "command": True,
    "framing": [0x1F, 0x7F, 0xFF, 0x1F],
    "crc": [CRC8],
}


def test_an_id_of_several_bytes_is_removed():
    wire = {"ids": [0x0135], "id": 0x0135, "id_bytes": 2, "crc": []}
    results = node(
        "([wire, texts]) => texts.map((text) => [...unwrap(wire, 2, frames.parseHex(text)).data])",
        [wire, ["01 35 aa bb", "aa bb", "01 36 aa bb", "35 aa bb"]],
    )
    assert results == [
        [0xAA, 0xBB],
        [0xAA, 0xBB],
        [0x01, 0x36, 0xAA, 0xBB],
        [0x35, 0xAA, 0xBB],
    ]


WIDER = {  # as the catalogues have them
    8: {},
    16: {"width": 16, "polynomial": 0x1021, "init": 0xFFFF, "reflect_in": False, "reflect_out": False, "xor_out": 0},
    24: {"width": 24, "polynomial": 0x864CFB, "init": 0xB704CE, "reflect_in": False, "reflect_out": False, "xor_out": 0},
    32: {"width": 32, "polynomial": 0x04C11DB7, "init": 0xFFFFFFFF, "reflect_in": True, "reflect_out": True, "xor_out": 0xFFFFFFFF},
}  # fmt: skip


@pytest.mark.parametrize("width", WIDER)
@pytest.mark.parametrize("little", [False, True])
@pytest.mark.parametrize("plain_id", [False, True])
@pytest.mark.parametrize("covers_id", [False, True])
def test_framing_is_that_of_the_generator(shipped, plain_id, covers_id, little, width):
    facts = facts_of(shipped, shipped.node("cubeacp"))
    form = replace(facts.checksum, covers_id=covers_id, bytes=width // 8)
    if WIDER[width]:
        algorithm = replace(form.algorithm, crc=declared.read_part(Crc, WIDER[width]))
        form = replace(form, algorithm=algorithm)
    facts = replace(
        facts,
        checksums={**facts.checksums, form.algorithm.name: form.algorithm},
        framing=replace(facts.framing, escapes_id=not plain_id),
        checksum=form,
        little=little,
    )
    wire = {**WIRE, "plain_id": plain_id, "crc": [crc_facts(facts)]}
    cases = [
        list(random.Random(seed).choices([0x1F, 0x7F, 0xFF, 0, 7], k=seed % 9))
        for seed in range(100)
    ]
    results = node(
        "([wire, cases]) => cases.map((data) => [false, true].map((check) => [...frames.framed(wire, data, check)]))",
        [wire, cases],
    )
    link = link_of(shipped, facts)
    assert results == [
        [
            list(uart_encode(link, i2c_write(link, 0x1F, bytes(data), check)))
            for check in (False, True)
        ]
        for data in cases
    ]
    back = node(
        """([wire, cases]) => cases.map((data) => {
            const { data: back, remarks } = unwrap(wire, data.length, frames.framed(wire, data, true));
            return [[...back], remarks.includes("CRC is right")];
        })""",
        [wire, cases],
    )
    assert back == [[data, True] for data in cases]


def test_framing_and_checksum_of_any_data_are_removed():
    cases = [
        list(random.Random(seed).choices([0x1F, 0x7F, 0xFF, 0, 7], k=seed % 9))
        for seed in range(200)
    ]
    results = node(
        """([wire, cases]) => cases.map((data) => [false, true].map((check) => {
            const { data: back, remarks } = unwrap(wire, data.length, frames.framed(wire, data, check));
            return [[...back], remarks.includes("CRC is right")];
        }))""",
        [WIRE, cases],
    )
    assert results == [[[data, False], [data, True]] for data in cases]


@pytest.mark.parametrize(
    ("text", "length", "says"),
    [
        ("1f 7f 1f 1f 01 02 1f ff", 2, "framing with id 31 removed"),
        ("1f 01 02", 2, "id 31 removed"),
        ("01 02", 2, ""),
        ("1f 7f 05 01 02 1f ff", 2, "another message's"),
        ("1f 7f 1f 1f 01 02", 2, "end of the message is missing"),
        ("1f 7f 1f 1f 01 1f 02 1f ff", 2, "followed by neither"),
        ("1f 7f 1f 1f 01 1f ff 02", 2, "wrong length"),
        ("00 1f 7f 1f 1f 01 02 1f ff 02", 2, "2 bytes around the frame belong to none"),
        ("1f 7f 1f 1f 1f ff", 2, "a request, which carries no data"),
        ("01 02 03", 2, "one byte too many: as CRC"),
    ],
)
def test_a_wrong_header_or_checksum_is_named(text, length, says):
    result = node(
        """([wire, text, length]) => attempt(() => {
            const { data, remarks } = unwrap(wire, length, frames.parseHex(text));
            if (data.length !== length) throw new Error("wrong length");
            return { error: remarks.join() };
        })""",
        [WIRE, text, length],
    )
    assert says in result["error"] and bool(says) == bool(result["error"])
