"""C functions for contained messages copy members and arrays, and describe where the
message is repeated from.
"""

from __future__ import annotations

import pytest

from icdgen.backends.c.parts import part_about, part_statements
from icdgen.describe.contained import contained_messages
from tests.describe.small import node_of

ICD = """\
messages:
  - name: Wheel
    id: 130
    kind: telemetry
    length: 10
    fields:
      - {at: 0, bits: 16, name: Speed, type: int}
      - {at: 16, bits: 8, name: Phase, type: uint, count: 2}
      - {at: 32, bits: 16, name: Name, type: text}
      - {at: 48, bits: 16, name: Tags, type: bytes, count: 2}
  - name: Everything
    id: 132
    kind: telemetry
    length: 24
    contains:
      - {message: Wheel, at: 8}
      - {message: Wheel, at: 100}
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, bits: 16, name: Left Speed, type: int}
      - {at: 24, bits: 8, name: Left Phase, type: uint, count: 2}
      - {at: 40, bits: 16, name: Left Name, type: text}
      - {at: 56, bits: 16, name: Left Tags, type: bytes, count: 2}
      - {at: 104, bits: 16, name: Right Speed, type: int}
      - {at: 120, bits: 8, name: First, type: uint}
      - {at: 128, bits: 8, name: Second, type: uint}
      - {at: 136, bits: 16, name: Right Name, type: text}
      - {at: 152, bits: 16, name: Tag 1, type: bytes}
      - {at: 168, bits: 16, name: Tag 2, type: bytes}
""".replace("at: 100}", "at: 104}")


@pytest.fixture
def everything(tmp_path):
    return node_of(tmp_path, ICD).messages[1]


def test_arrays_and_bytes_are_copied_as_c_cannot_assign_them(everything):
    (part,) = contained_messages(everything)
    assert part_statements(everything, part, 8) == [
        "part->speed = message->left_speed;",
        "(void)memcpy(part->phase, message->left_phase, sizeof part->phase);",
        "(void)memcpy(part->name, message->left_name, sizeof part->name);",
        "(void)memcpy(part->tags, message->left_tags, sizeof part->tags);",
    ]
    assert part_statements(everything, part, 104) == [
        "part->speed = message->right_speed;",
        "part->phase[0] = message->first;",
        "part->phase[1] = message->second;",
        "(void)memcpy(part->name, message->right_name, sizeof part->name);",
        "(void)memcpy(part->tags[0], message->tag_1, sizeof part->tags[0]);",
        "(void)memcpy(part->tags[1], message->tag_2, sizeof part->tags[1]);",
    ]


def test_the_comment_has_the_positions_and_the_largest_index(everything):
    (part,) = contained_messages(everything)
    text = " ".join(part_about(part).replace("*", " ").split())
    assert text == (
        "/ Wheel, repeated from byte 1 and from byte 13. "
        "ICD_ERROR_RANGE, and `part` as it was, if there is no such part: "
        "they are 0 to 1. /"
    ).replace("ICD_ERROR_RANGE", "ICD_ERROR_RANGE")
    single = part._replace(positions=(12,))
    assert part_about(single) == "/** Wheel, repeated from bit 12. */"
