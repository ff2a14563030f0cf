"""Sentences of the comments in generated code: place, values, limits and conditions of a
field; facts of a message; tables of the manual.
"""

from __future__ import annotations

import pytest

from icdgen.describe.comments import (
    accepted_values_text,
    condition_text,
    part_comment,
    physical_comment,
    presence_comment,
    sentence,
    text_comment,
    words,
)
from tests.describe.small import message_of, node_of
from tests.icd.files import status

HEAD = """\
enums:
  - name: Mode
    summary: How it runs
    source: {table: 3}
    members:
      - {value: 0, name: Idle, summary: Nothing runs}
      - {value: 2, to: 5, name: Run}
structs:
  - name: Cell
    length: 1
    summary: One `cell`!
    source: {table: 4}
    fields: [{at: 0, bits: 8, name: Kind, type: uint}]
"""
BYTE = "at: 0, bits: 8, name: A, type: uint"
SIZE = "at: 0, bits: 8, name: Size, type: uint"
ORDER = "bit 0 of a byte is the most significant"


@pytest.mark.parametrize(
    ("field", "paragraphs"),
    [
        (
            "at: 0, bits: 1, name: A, type: bool, summary: Whether it runs",
            ["A: bit 0.", "Whether it runs."],
        ),
        (
            "at: 0, bits: 8, name: A, type: int, unit: V",
            ["A: bits 0 to 7, raw -128 to 127, in V."],
        ),
        (
            f"{BYTE}, formula: raw*0.5 - 1, unit: V, min: 0, below: 100",
            [
                "A: bits 0 to 7, raw 0 to 255; physical `raw*0.5 - 1`, -1 to 126.5 V.",
                "Must be at least 0 and below 100 V, which setters do not check.",
            ],
        ),
        (
            f"{BYTE}, formula: raw*-0.5",
            ["A: bits 0 to 7, raw 0 to 255; physical `raw*-0.5`, -127.5 to 0."],
        ),
        (
            f"{BYTE}, formula: raw*raw*0.5",
            [
                "A: bits 0 to 7, raw 0 to 255; physical `raw*raw*0.5`, in doubles, 0.0 to 32512.5."
            ],
        ),
        (
            f"{BYTE}, points: [[0, -40], [200, 20]], outside: clamp, unit: V",
            [
                "A: bits 0 to 7, raw 0 to 255; physical by points 0: -40, 200: 20, clamped outside, -40.0 to 20.0 V."
            ],
        ),
        (
            "at: 0, bits: 32, name: A, type: float, unit: m/s, above: 0",
            [
                "A: bits 0 to 31, 32-bit float, in m/s.",
                "Must be above 0 m/s, which setters do not check.",
            ],
        ),
        (f"{BYTE}, const: 0", ["A: bits 0 to 7, raw 0 to 255.", "Always 0."]),
        (f"{BYTE}, const: 90", ["A: bits 0 to 7, raw 0 to 255.", "Always 90 (0x5A)."]),
        (
            "at: 0, bits: 16, name: A, type: uint, byte_order: big, special: [{value: 65535, meaning: a}, {value: 0, meaning: b!}]",
            [
                "A: bits 0 to 15, big-endian, raw 0 to 65535.",
                "65535 (0xFFFF): a. 0: b!",
            ],
        ),
        (
            "at: 0, bits: 16, name: A, type: uint, bit_order: msb0",
            [f"A: bits 0 to 15, {ORDER}, raw 0 to 65535."],
        ),
        ("at: 0, bits: 24, name: A, type: bytes", ["A: bytes 0 to 2."]),
        (
            "at: 0, bits: 16, name: A, type: text, count: 2",
            ["A: bytes 0 to 3, 2 elements of 2 bytes, text filled with NUL."],
        ),
        ("at: 0, name: A, struct: Cell", ["A: byte 0, Cell."]),
        ("at: 0, name: A, struct: Cell, count: 2", ["A: bytes 0 to 1, 2 Cell."]),
        (
            f"{BYTE}, count: 3",
            ["A: bits 0 to 23, 3 elements of 8 bits, raw 0 to 255."],
        ),
        ("at: 0, bits: 8, name: A, type: enum, enum: Mode", ["A: bits 0 to 7."]),
        (
            "at: 4, bits: 4, name: A, type: uint, view: true",
            [
                "A: bits 4 to 7, raw 0 to 15.",
                "Overlay field: reads bits of other fields and has no setter.",
            ],
        ),
    ],
)  # fmt: skip
def test_a_field_has_its_place_its_values_and_its_limits(tmp_path, field, paragraphs):
    message = message_of(tmp_path, field, length=4, head=HEAD)
    (member,) = (*message.members, *message.read_only_members)
    assert list(member.comment.paragraphs) == paragraphs


@pytest.mark.parametrize(
    ("field", "counter", "place"),
    [
        (
            "bits: 8, type: uint, count: Size, up_to: 4",
            "Counts B: at most 4.",
            "from byte 1 on, up to 4 elements of 8 bits, as many as Size says, raw 0 to 255",
        ),
        (
            "bits: 16, type: uint, count: {field: Size, plus: 2}, up_to: 4, byte_order: big",
            "Counts B, of which there are 2 more: at most 4.",
            "from byte 1 on, up to 4 elements of 16 bits, as many as Size says, big-endian, raw 0 to 65535",
        ),
        (
            "type: bytes, size: {field: Size, plus: -2}, up_to: 9",
            "Counts B, of which there are 2 less: at most 9.",
            "from byte 1 on, up to 9 bytes, as many as Size says",
        ),
        (
            "type: text, size: Size, up_to: 1",
            "Counts B: at most 1.",
            "from byte 1 on, text of up to 1 character, as many as Size says",
        ),
        (
            "type: text, size: rest, up_to: 2",
            None,
            "from byte 1 on, text of up to 2 characters",
        ),
    ],
)
def test_a_variable_length_field_names_its_counter(tmp_path, field, counter, place):
    message = message_of(tmp_path, SIZE, f"at: 8, name: B, {field}", length=1)
    comments = {member.model.name: member.comment for member in message.members}
    assert list(comments["Size"].details) == ([counter] if counter else [])
    if counter is None:
        assert comments["B Size"].paragraphs == (
            "B Size: how much of B the frame has, up to 2; identified by its length.",
        )
    assert comments["B"].paragraphs == (f"B: {place}.",)


def test_conditions_name_members_of_enumerations_and_flags(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Mode, type: enum, enum: Mode",
        "at: 8, bits: 1, name: Flag, type: bool",
        "at: 16, bits: 8, name: B, type: uint, when: {Mode: [0, 2], Flag: false}",
        length=3,
        head=HEAD,
    )
    member = message.members[-1]
    # The value 2 begins a range, whose name would mean its other values, too.
    condition = "Mode is Idle or 2 and Flag is false"
    assert member.comment.details == (f"Present only if {condition}.",)
    assert presence_comment(member.model, message.model) == (
        f"Return whether B is present: if {condition}."
    )
    assert condition_text(member.model.conditions[0]) == "Mode is 0 or 2"


@pytest.mark.parametrize(
    ("keys", "head", "facts"),
    [
        (
            "kind: telemetry\n    id: 130\n    period_ms: 100\n    hazard: It burns",
            "telemetry 130, 1 byte. Table 7.",
            ["Dangerous: It burns. Sent every 100 ms."],
        ),
        (
            "kind: telecommand\n    id: 0\n    acknowledge: false",
            "telecommand 0, 1 byte. Table 7.",
            ["The node does not send an acknowledge."],
        ),
        (
            "kind: telecommand\n    id: 1\n    acknowledge: reset",
            "telecommand 1, 1 byte. Table 7.",
            ["The node restarts instead of sending an acknowledge."],
        ),
        (
            "kind: configuration\n    set_id: 0\n    get_id: 130",
            "configuration, set by telecommand 0, read by telemetry 130, 1 byte. Table 7.",
            [],
        ),
        (
            "kind: telemetry\n    id: 130\n    may_end_early: zeros",
            "telemetry 130, 1 byte. Table 7.",
            ["Trailing zeros of a frame may be omitted."],
        ),
    ],
)
def test_a_message_has_its_ids_and_its_facts(tmp_path, keys, head, facts):
    text = status(BYTE, length=1).replace(
        "    id: 130\n    kind: telemetry", f"    {keys}"
    )
    text = text.replace("kind:", "summary: Of `all`\n    source: {table: 7}\n    kind:")
    (message,) = node_of(tmp_path, text).messages
    assert list(message.comment.paragraphs) == [f"Status: {head}", "Of 'all'.", *facts]


def test_enumerations_members_and_structs_have_a_table_and_a_summary(tmp_path):
    node = node_of(tmp_path, HEAD + status(BYTE, length=1))
    (enum,), (struct,) = node.enums, node.structs
    assert enum.comment.paragraphs == ("Mode: an enumeration. Table 3.", "How it runs.")
    assert enum.members[0].comment.paragraphs == (
        "Idle (0).",
        "Nothing runs.",
    )
    assert struct.comment.paragraphs == (
        "Cell: a struct of 1 byte. Table 4.",
        "One 'cell'!",
    )


def test_a_contained_message_is_at_bytes_or_bits(tmp_path):
    message = message_of(tmp_path, BYTE, length=1).model
    assert part_comment(message, [0]) == "Status, repeated from byte 0."
    assert part_comment(message, [8, 20]) == (
        "Status, repeated from byte 1 and from bit 20."
    )


@pytest.mark.parametrize(
    ("keys", "is_narrow", "text"),
    [
        ("bits: 8, type: uint", False, "0 to 255"),
        ("bits: 7, type: uint, unit: V", True, "0 to 127 V"),
        ("bits: 8, type: uint, formula: raw*2, unit: V", False, "0 to 510 V"),
        ("bits: 7, type: uint, formula: raw*2, unit: V", True, "0 to 254 V, raw 0 to 127"),
        ("bits: 4, type: enum, enum: Mode", True, "Mode, 0 to 15"),
        ("bits: 64, type: float, unit: V", False, "what 64 bits of a float hold"),
    ],
)  # fmt: skip
def test_accepted_values_have_the_raw_range_if_the_type_can_store_more(
    tmp_path, keys, is_narrow, text
):
    field = f"at: 0, name: A, {keys}"
    (member,) = message_of(tmp_path, field, length=8, head=HEAD).members
    assert accepted_values_text(member.model, is_narrow) == text


def test_physical_values_and_texts_have_their_titles(tmp_path):
    first, second, third = (
        message_of(tmp_path, f"at: 0, name: A, {keys}", length=8).members[0].model
        for keys in (
            "bits: 8, type: uint, formula: raw*2, unit: V, max: 9",
            "bits: 8, type: uint, formula: raw*2",
            "bits: 24, type: text",
        )
    )
    assert physical_comment(first) == (
        "A in V: 0 to 510. Must be at most 9 V, which setters do not check."
    )
    assert physical_comment(second) == "A, as a physical value: 0 to 510."
    assert text_comment(third) == (
        "A as text: up to 3 ASCII characters, ending at the first NUL."
    )


def test_text_becomes_one_line_with_a_full_stop():
    assert [sentence(text) for text in ("a", "a.", "a?", "a!", "a:", "", " ")] == [
        "a.", "a.", "a?", "a!", "a:", "", "",
    ]  # fmt: skip
    assert words(" a\n `b`  c\t") == "a 'b' c"
