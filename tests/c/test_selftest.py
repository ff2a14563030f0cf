"""The C self-test expects the result of the reference codec for every frame."""

from __future__ import annotations

import re
import struct
import subprocess
from pathlib import Path

import pytest

from icdgen import backends, codec
from icdgen.backends.c_selftest import rows as selftest_rows
from icdgen.icd.model import Icd
from icdgen.loading import load
from icdgen.render import Renderer
from tests.c import harness
from tests.icd.files import loaded, status, write
from tests.limits import assert_limits

MESSAGES = """\
messages:
  - name: Start
    id: 5
    kind: telecommand
    shares_id: true
    length: 1
    fields: [{{at: 0, bits: 8, name: Action, type: uint, const: 1}}]
  - name: Stop
    id: 5
    kind: telecommand
    shares_id: true
    length: {length}
    fields: [{{at: 0, bits: 8, name: Action, type: uint, const: 2}}]
"""
START, STOP = ("ICD_OK", '"Start"'), ("ICD_OK", '"Stop"')
UNKNOWN, LENGTH = ("ICD_ERROR_UNKNOWN_ID", "NULL"), ("ICD_ERROR_LENGTH", "NULL")


def rows_of_frames(folder: Path, icd: str) -> dict[bytes, tuple[str, str]]:
    """Return the frames of the shared id 5 with the expected status and message."""
    backend = backends.get("c-selftest")
    files = backend.files(loaded(folder, icd).icd, Renderer.of_backend(backend))
    (text,) = (text for path, text in files if path.parent.name == "nodes")
    rows = re.findall(
        r"^ *\{5u, (\d+)u, (?:NULL|\(const uint8_t\[\]\)\{(.*)\}), (\w+), (.*)\},$",
        text,
        re.MULTILINE,
    )
    frames = {
        bytes(int(byte, 16) for byte in data.split(", ") if byte): (status, name)
        for _, data, status, name in rows
    }
    assert [int(length) for length, *_ in rows] == [len(frame) for frame in frames]
    return frames


@pytest.mark.parametrize(
    ("length", "frames"),
    [
        (1, {"": LENGTH, "00": UNKNOWN, "0000": LENGTH, "01": START, "02": STOP}),
        # Messages of different lengths have no length that a frame could miss.
        (2, {"": UNKNOWN, "00": UNKNOWN, "000000": UNKNOWN, "01": START, "0200": STOP}),
    ],
    ids=["of one length", "of two lengths"],
)
def test_frames_of_a_shared_id_have_their_message_or_the_error_of_the_decoder(
    tmp_path, length, frames
):
    rows = rows_of_frames(tmp_path, MESSAGES.format(length=length))
    expected = {bytes.fromhex(frame): result for frame, result in frames.items()}
    # All other frames are of a possible length and have another constant.
    assert rows == dict.fromkeys(rows, UNKNOWN) | expected
    assert len(rows) > 2 * len(frames)


def icd_of(folder: Path, text: str) -> Icd:
    result = load([write(folder, text)], check=False)
    assert not result.findings, [finding.message for finding in result.findings]
    return result.icd


def selftest_of(folder: Path, *fields: str, length: int, head: str = "") -> str:
    """Return the file of the vectors of a node with the message `Status`."""
    backend = backends.get("c-selftest")
    icd = icd_of(folder, head + status(*fields, length=length))
    files = backend.files(icd, Renderer.of_backend(backend))
    (text,) = (text for path, text in files if path.parent.name == "nodes")
    return text


def table(text: str, name: str) -> list[str]:
    """Return the lines of a table, without comments."""
    (found,) = re.findall(
        rf"^static const [\w *]+ {name}\[\] = \{{\n(.*?)\n\}};", text, re.M | re.S
    )
    return [
        line.strip() for line in found.splitlines() if not line.strip().startswith("/*")
    ]


def numbers(lines: list[str]) -> list[int]:
    return [int(number, 0) for number in " ".join(lines).split(",") if number.strip()]


def members_of(text: str, name: str) -> dict[str, str]:
    """Return the members of the row of a field."""
    (found,) = re.findall(
        rf'^    \{{\n        \.name = "{name}",\n(.*?)^    \}},$', text, re.M | re.S
    )
    return dict(re.findall(r"\.(\w+) = (.*),$", found, re.M))


FIELDS = (
    "at: 4, bits: 12, name: Level, type: int, formula: raw*0.5, unit: V",
    "at: 16, bits: 8, name: Kind, type: uint, const: 7",
    "at: 24, bits: 1, name: Flag, type: bool",
    "at: 32, bits: 24, name: Data, type: bytes",
    "at: 56, bits: 20, name: Turns, type: uint, count: 2",
)


def test_each_vector_is_a_frame_with_the_raw_values_of_its_fields(tmp_path):
    text = selftest_of(tmp_path, *FIELDS, length=14)
    (node,) = icd_of(tmp_path, status(*FIELDS, length=14)).nodes
    (message,) = node.messages
    data = bytes(numbers(table(text, "demo_status_selftest_vectors")))
    sizes = {"Level": 2, "Kind": 1, "Flag": 1, "Data": 3, "Turns[0]": 3, "Turns[1]": 3}
    step = 14 + sum(sizes.values())
    assert re.findall(r"\.vector_size = (\d+),", text) == [str(step)]
    assert re.findall(r"\.vector_count = (\d+),", text) == [str(len(data) // step)]
    assert len(data) % step == 0
    for start in range(0, len(data), step):
        frame, values = data[start : start + 14], data[start + 14 : start + step]
        for name, raw in codec.decode(node, message, frame).items():
            packed, values = values[: sizes[name]], values[sizes[name] :]
            if isinstance(raw, bytes):
                assert packed == raw
            else:
                assert packed == raw.to_bytes(sizes[name], "little", signed=raw < 0)
        assert values == b""
    # Reserved bits are 0 in each encoded frame.
    kept = bytes(numbers(table(text, "demo_status_selftest_kept")))
    assert kept.hex() == "f0ffff01ffffffffffffffff0000"


def test_a_field_has_its_type_its_sizes_and_its_value_in_a_new_message(tmp_path):
    text = selftest_of(tmp_path, *FIELDS, length=14)
    expected = {
        "Level": ("demo_status_t, level", "2", "2", "SIGNED", "0u"),
        "Kind": ("demo_status_t, kind", "1", "1", "UNSIGNED", "7u"),
        "Flag": ("demo_status_t, flag", "1", "1", "BOOL", "0u"),
        "Data": ("demo_status_t, data", "3", "3", "BYTES", "0u"),
        r"Turns\[1\]": ("demo_status_t, turns[1]", "4", "3", "UNSIGNED", "0u"),
    }
    for name, (member, size, packed, type, fresh) in expected.items():
        row = members_of(text, name)
        assert row["offset"] == f"offsetof({member})"
        assert (row["size"], row["packed"], row["fresh"]) == (size, packed, fresh)
        assert row["type"] == f"ICDGEN_SELFTEST_{type}"
    # Elements of an array share the tables of the first.
    assert (
        members_of(text, r"Turns\[1\]")["unfit"] == "demo_status_selftest_turns_0_unfit"
    )
    assert "unfit" not in members_of(text, "Flag") and "unfit" not in members_of(
        text, "Kind"
    )


def test_refused_raw_values_are_beyond_the_field_but_not_beyond_its_type(tmp_path):
    text = selftest_of(tmp_path, *FIELDS, length=14)
    (row,) = re.findall(r"demo_status_selftest_level_unfit\[\] = \{(.*)\};", text)
    raws = [
        int(value.removeprefix("UINT64_C(").rstrip("u)"), 0)
        for value in row.split(", ")
    ]
    signed = [raw - (1 << 64) * (raw >> 63) for raw in raws]
    assert {2048, -2049} <= {*signed}
    for raw in signed:
        assert not -2048 <= raw <= 2047 and -32768 <= raw <= 32767


def test_whole_parts_and_physical_values_are_rows_of_bits_and_raw_values(tmp_path):
    text = selftest_of(tmp_path, *FIELDS, length=14)
    wholes = table(text, "demo_status_selftest_level_wholes")
    rows = [re.fullmatch(r"\{(.*), (.*)\},", line).groups() for line in wholes]
    assert ("UINT64_C(0xFFFFFFFFFFFFF800)", "-1024000") in rows
    assert ("2047u", "1023500") in rows and ("0u", "0") in rows
    settings = table(text, "demo_status_selftest_level_settings")
    # 1 V is the raw value 2; NaN is refused.
    assert "{UINT64_C(0x7ff8000000000000), 0u, true}," in settings
    doubles = [
        re.fullmatch(r"\{UINT64_C\(0x(\w{16})\), (.*), (true|false)\},", line).groups()
        for line in settings
    ]
    for bits, raw, refused in doubles:
        value = struct.unpack(">d", bytes.fromhex(bits))[0]
        is_refused = not -1024.25 <= value < 1023.75
        assert (refused == "true") == is_refused, value
        number = int(raw.removeprefix("UINT64_C(").rstrip("u)"), 0)
        number -= (1 << 64) * (number >> 63)
        assert number == (0 if is_refused else round(value * 2))


def test_names_of_an_enumeration_end_with_a_value_without_one(tmp_path):
    members = "{value: 0, name: 'A \"q\"'}, {value: 255, name: B}"
    head = f"enums: [{{name: Mode, members: [{members}]}}]\n"
    field = "at: 0, bits: 8, name: Mode, type: enum, enum: Mode"
    text = selftest_of(tmp_path, field, length=1, head=head)
    lines = table(text, "demo_selftest_names")
    name = "demo_mode_selftest_name"
    assert lines[:2] == [f'{{{name}, 0u, "A \\"q\\""}},', f'{{{name}, 255u, "B"}},']
    assert len(lines) == 3 and lines[2].endswith(", NULL},")


def test_ids_have_the_longest_and_shortest_frame_and_the_status_of_zeros(tmp_path):
    text = selftest_of(
        tmp_path,
        "at: 0, bits: 8, name: Kind, type: uint",
        "at: 8, bits: 8, name: Last, type: uint",
        "at: 16, bits: 16, name: Data, type: uint, "
        "count: {field: Last, plus: -1}, up_to: 3",
        length=2,
    )
    ids = "".join(table(text, "demo_telemetry_selftest_ids"))
    rows = re.findall(r"\{(\d+)u, (-?\d+), (\d+)u, (\w+)\}", ids)
    by_id = {int(id): row for id, *row in rows}
    # The smallest counter is 1.
    assert by_id[130] == ["8", "2", "ICD_ERROR_LENGTH"]
    assert by_id[0] == by_id[255] == ["-1", "0", "ICD_ERROR_UNKNOWN_ID"]
    assert len(by_id) == len(rows) == 256
    lengths = numbers(table(text, "demo_status_selftest_lengths"))
    assert {2, 4, 6, 8} == {*lengths}
    tail = dict(re.findall(r"^    \.(least|counter|high) = (\d+),$", text, re.M))
    assert tail == {"least": "2", "counter": "1", "high": "4"}


def test_an_overlay_is_a_function_and_an_absent_field_has_its_initial_value(tmp_path):
    text = selftest_of(
        tmp_path,
        "at: 0, bits: 8, name: Kind, type: uint",
        "at: 8, bits: 8, name: Value, type: uint, const: 9, when: {Kind: 1}",
        "at: 0, bits: 4, name: Low, type: uint, view: true",
        length=2,
    )
    low = members_of(text, "Low")
    assert low["view"] == "demo_status_selftest_low_view" and "offset" not in low
    assert (
        "const uint8_t seen = demo_status_low((const demo_status_t *)message);" in text
    )
    data = bytes(numbers(table(text, "demo_status_selftest_vectors")))
    rows = [data[start : start + 5] for start in range(0, len(data), 5)]
    kinds = {row[0] == 1 for row in rows}
    assert kinds == {True, False}
    for frame_kind, frame_value, kind, value, low_value in rows:
        assert kind == frame_kind and low_value == kind & 15
        assert value == (frame_value if kind == 1 else 9)
        assert kind == 1 or frame_value == 0


def test_a_text_is_set_from_strings_of_c_and_read_as_one(tmp_path):
    text = selftest_of(
        tmp_path,
        "at: 0, bits: 24, name: Word, type: text",
        "at: 24, bits: 64, name: Wide, type: uint",
        length=11,
    )
    word = members_of(text, "Word")
    stem = "demo_status_selftest_word"
    assert (word["type"], word["size"]) == ("ICDGEN_SELFTEST_BYTES", "3")
    assert (word["get_text"], word["set_text"]) == (
        f"{stem}_get_text",
        f"{stem}_set_text",
    )
    assert "return demo_status_set_word_text((demo_status_t *)message, text);" in text
    rows = table(text, f"{stem}_texts")
    assert word["text_count"] == str(len(rows))
    assert '{"", (const uint8_t[]){0x0, 0x0, 0x0}},' in rows
    assert any(row.endswith(", NULL},") for row in rows)
    # The getter of each frame, or NULL where a C string cannot have the bytes.
    read = table(text, "demo_status_selftest_texts")
    (count,) = re.findall(r"\.vector_count = (\d+),", text)
    assert len(read) == int(count) and '"",' in read
    assert all(row == "NULL," or row.startswith('"') for row in read)
    assert (members_of(text, "Wide")["size"], members_of(text, "Wide")["packed"]) == (
        "8",
        "8",
    )


def test_a_message_without_fields_has_vectors_of_its_bytes(tmp_path):
    text = selftest_of(tmp_path, length=3)
    assert re.findall(r"\.vector_size = (\d+),", text) == ["3"]
    data = numbers(table(text, "demo_status_selftest_vectors"))
    (count,) = re.findall(r"\.vector_count = (\d+),", text)
    assert len(data) == 3 * int(count)
    assert numbers(table(text, "demo_status_selftest_kept")) == [0, 0, 0]
    digest = icd_of(tmp_path, status(length=3)).nodes[0].digest[:16]
    assert f" from node demo, ICD {digest}. Do not edit. */" in text.splitlines()[0]


def test_an_id_of_several_messages_has_no_single_length(tmp_path):
    backend = backends.get("c-selftest")
    icd = icd_of(tmp_path, MESSAGES.format(length=2))
    files = backend.files(icd, Renderer.of_backend(backend))
    (text,) = (text for path, text in files if path.parent.name == "nodes")
    ids = "".join(table(text, "demo_telecommand_selftest_ids"))
    rows = [int(id) for id in re.findall(r"\{(\d+)u, ", ids)]
    assert rows == [id for id in range(256) if id != 5]


def test_raw_values_of_more_than_16_bits_are_literals_of_64():
    def is_short(value):
        return selftest_rows._unsigned_literal(value) == f"{value}u"

    assert_limits(is_short, least=0, most=0xFFFF)
    assert selftest_rows._unsigned_literal(-1) == "UINT64_C(0xFFFFFFFFFFFFFFFF)"
    assert selftest_rows._unsigned_literal(1 << 63) == "UINT64_C(0x8000000000000000)"


PASSES = """\
#include "icdgen_selftest.h"

int main(void)
{
    icdgen_selftest_totals_t totals = {0};
    icdgen_selftest(icdgen_selftest_nodes[0], &totals, NULL, NULL);
    return totals.failures == 0u && totals.checks > 0u ? 0 : 1;
}
"""


@pytest.mark.needs("gcc")
@pytest.mark.parametrize("options", [(), ("-DICDGEN_NO_DOUBLE",)])
def test_the_self_test_passes_with_and_without_physical_values(options, tmp_path):
    scaled = "at: 0, bits: 16, name: Angle, type: int, unit: deg, formula: raw*0.01"
    icd = loaded(tmp_path, status(scaled)).icd
    sources = [tmp_path / "main.c"]
    sources[0].write_text(PASSES)
    for name in ("c", "c-selftest"):
        backend = backends.get(name)
        renderer = Renderer.of_backend(backend)
        for file, text in backend.files(icd, renderer):
            (tmp_path / name / file).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name / file).write_text(text)
            if name == "c-selftest" and file.suffix == ".c":
                sources.append(tmp_path / name / file)
    includes = (f"-I{tmp_path / 'c'}", f"-I{tmp_path / 'c-selftest'}")
    flags = ("-std=c99", *harness.WARNINGS, *options, *includes)
    program = harness.compile(*sources, *flags, "-lm", output=tmp_path / "program")
    subprocess.run([program], check=True)
