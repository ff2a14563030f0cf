"""Rules of the table of loggable frames: bits, ids and names of its rows."""

from __future__ import annotations

import pytest

from tests.icd.files import codes, findings
from tests.icd.rules.reported import messages, reported
from tests.limits import assert_limits

MASK = "protocol: {{log_mask: {{bytes: {}, frame_bytes: {}}}}}\n"


def telemetry(name: str, id: object, length: int = 2) -> str:
    fields = f"{{at: 0, bits: {8 * length}, name: Data, type: bytes}}"
    return f"  - {{name: {name}, id: {id}, kind: telemetry, length: {length}, fields: [{fields}]}}\n"


def config(name: str, id: object) -> str:
    fields = "{at: 0, bits: 16, name: Data, type: bytes}"
    return f"  - {{name: {name}, set_id: 3, get_id: {id}, kind: configuration, length: 2, fields: [{fields}]}}\n"


def table(*rows: str, content: str = "", head: str = "") -> str:
    """Return an ICD whose table has these rows, the first of them in line 4 of an ICD
    without other content.
    """
    lines = "".join(f"  - {{{row}}}\n" for row in rows)
    return (
        f"{head}{f'messages:{chr(10)}{content}' if content else ''}loggable:\n{lines}"
    )


def test_telemetry_of_a_row_is_described_or_missing(tmp_path):
    missing = (
        "missing:\n  - {kind: telemetry, id: 7, name: Torque, why: It is only named.}\n"
        "  - {kind: telecommand, id: 8, name: Stop, why: It is only named.}\n"
    )
    content = telemetry("State", 5) + config("Setup", 6)
    ids = (3, 5, 6, 7, 8, "0x09")
    text = table(
        *(f"bit: {bit}, id: {id}" for bit, id in enumerate(ids)), content=content
    )
    assert reported(tmp_path, text + missing, "ICD043") == [
        (7 + bit, str(id), f"loggable bit {bit} points nowhere: there is no telemetry {id}", "correct `id`")
        for bit, id in enumerate(ids)
        if id in (3, 8, "0x09")
    ]  # fmt: skip


def test_the_help_of_a_row_has_the_id_of_the_message_with_a_similar_name(tmp_path):
    """In the spelling of the message, with the id by which it is sent."""
    content = telemetry("State", "0x05") + config("Setup", "0x86")
    rows = (
        "bit: 0, id: 1, name: Stat",
        "bit: 1, id: 2, name: Setupp",
        "bit: 2, id: 3, name: Other",
    )
    text = table(*rows, content=content)
    assert [(f.help, f.fix and f.fix.text) for f in findings(tmp_path, text)] == [
        ("`State` has id 0x05", "0x05"),
        ("`Setup` has id 0x86", "0x86"),
        ("correct `id`", None),
    ]  # fmt: skip


def test_tables_of_included_files_share_their_telemetry(tmp_path):
    base = "icdgen: 1\nnode: {name: base, title: Base, byte_order: little, bit_order: lsb0}\n"
    lost = "missing: [{kind: telemetry, id: 7, name: Torque, why: It is only named.}]\n"
    text = "include: [base.yaml]\n" + table("bit: 0, id: 5", "bit: 1, id: 7")
    content = f"messages:\n{telemetry('State', 5)}{lost}"
    assert codes(tmp_path, f"{text}# base.yaml\n{base}{content}") == []
    assert codes(tmp_path, text.partition("\n")[2]) == ["ICD043", "ICD043"]


def test_each_repetition_names_the_first_row(tmp_path):
    rows = "bit: 0x1, id: 5", "bit: 1, id: 0x06", "bit: 1, id: 6", "bit: 0, id: 0x05"
    found = reported(tmp_path, table(*rows), "ICD044")
    first_bit = " is in the table twice, first in line 4"
    assert [each[:3] for each in found] == [
        (5, "1", f"mask bit 1{first_bit}"),
        (6, "1", f"mask bit 1{first_bit}"),
        (6, "6", "frame 6 is in the table twice, first in line 5"),
        (7, "0x05", "frame 0x05 is in the table twice, first in line 4"),
    ]
    assert [each.help for each in found] == [
        f"correct one `{key}`" for key in ("bit", "bit", "id", "id")
    ]


@pytest.mark.parametrize("size", [1, 2, 4])
def test_bits_are_those_of_the_mask(size, tmp_path):
    def is_inside(bit: int) -> bool:
        text = table(f"bit: {bit}, id: 5", head=MASK.format(size, 2))
        return "ICD044" not in codes(tmp_path, text)

    assert_limits(is_inside, most=8 * size - 1)
    text = table(f"bit: {8 * size}, id: 5", head=MASK.format(size, 2))
    assert reported(tmp_path, text, "ICD044") == [
        (
            5,
            str(8 * size),
            f"bit {8 * size} is outside the mask of {size} byte{'s' * (size > 1)}",
            f"its bits are 0 to {8 * size - 1}",
        )
    ]


def test_bits_of_a_mask_of_unknown_size_are_not_limited(tmp_path):
    assert messages(tmp_path, table("bit: 31, id: 5"), "ICD044") == []


@pytest.mark.parametrize("length", [1, 2, 3])
def test_frames_have_the_length_of_the_log(length, tmp_path):
    content = telemetry("State", "0x05", length)
    text = table("bit: 0, id: 5", content=content, head=MASK.format(1, 2))
    size = f"{length} byte{'s' * (length > 1)}"
    assert reported(tmp_path, text, "ICD045") == [
        (
            7,
            "5",
            f"`State` has {size}, a frame in the log has 2",
            "correct `id`, or the `length` of the frame",
        )
    ] * (length != 2)
    assert messages(tmp_path, table("bit: 0, id: 5", content=content), "ICD045") == []


def test_a_row_has_the_name_of_its_frame_or_none(tmp_path):
    content = telemetry("State", 5) + config("Setup", 6)
    rows = (
        "bit: 0, id: 5",
        "bit: 1, id: 0x06, name: State",
        "bit: 2, id: 9, name: Other",
    )
    assert reported(tmp_path, table(*rows, content=content), "ICD045") == [
        (
            8,
            "State",
            "telemetry 0x06 is called `Setup` (line 5), not `State`",
            "correct `name` or `id`",
        )
    ]
    rows = ("bit: 0, id: 5, name: State", "bit: 1, id: 6, name: Setup")
    assert codes(tmp_path, table(*rows, content=content)) == []
