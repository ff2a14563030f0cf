"""Frames of shared ids have each constant right, each of its bits wrong, and the
neighbours of each length.
"""

from __future__ import annotations

from icdgen.icd.model import TELECOMMAND, TELEMETRY
from icdgen.vectors.shared import SharedRow, messages_by_id, shared_rows
from tests.icd.files import loaded

FIXED = """\
messages:
  - name: B
    id: 5
    kind: {kind}
    shares_id: true
    length: 2
    fields:
      - {{at: 0, bits: 8, name: Kind, type: uint, const: 0x21}}
      - {{at: 8, bits: 8, name: Value, type: uint}}
  - name: A
    id: 5
    kind: {kind}
    shares_id: true
    length: 3
    fields:
      - {{at: 0, bits: 8, name: Kind, type: int, const: -2}}
      - {{at: 8, bits: 8, name: Value, type: uint}}
  - {{name: Alone, id: 4, kind: {kind}, length: 1}}
  - {{name: Both, set_id: 5, get_id: 3, kind: configuration, length: 9, shares_id: true}}
"""


def model(folder, text=FIXED, kind=TELEMETRY):
    return loaded(folder, text.format(kind=kind)).icd


def test_messages_of_an_id_have_the_order_of_the_icd_and_ids_ascend(tmp_path):
    icd = model(tmp_path, kind=TELECOMMAND)
    (node,) = icd.nodes

    def names(direction):
        rows = messages_by_id(icd, node, direction)
        return [(id, [m.name for m in messages]) for id, messages in rows.items()]

    assert names(TELECOMMAND) == [(4, ["Alone"]), (5, ["B", "A", "Both"])]
    assert names(TELEMETRY) == [(3, ["Both"])]


PAIR = FIXED[: FIXED.index("  - {{name: Alone")]


def rows_of(folder, text=PAIR, kind=TELEMETRY):
    icd = model(folder, text, kind)
    rows = list(shared_rows(icd, icd.nodes[0]))
    assert len({row.frame for row in rows}) == len(rows), "each frame once"
    assert {(row.direction, row.id) for row in rows} == {(kind, 5)}
    return rows


def expected(frame):
    """Return the message of a frame of `PAIR`, by its length and first byte."""
    constants = {2: (0x21, "B"), 3: (0xFE, "A")}
    value, name = constants.get(len(frame), (None, None))
    return name if frame[:1] == bytes((value or 0,)) and name else None


def test_frames_belong_to_the_message_of_their_length_and_constant(tmp_path):
    for kind in (TELEMETRY, TELECOMMAND):
        for row in rows_of(tmp_path, kind=kind):
            assert (row.message, row.expected) == (expected(row.frame), None), row


def test_constants_stand_among_zeros_ones_and_random_bytes(tmp_path):
    frames = {row.frame for row in rows_of(tmp_path)}
    assert {b"\x21\x00", b"\x21\xff", b"\xfe\x00\x00", b"\xfe\xff\x00"} <= frames
    others = {f[1:] for f in frames if f[:1] == b"\xfe" and len(f) == 3}
    assert len(others) == 3  # a random one, too


def test_each_bit_of_a_constant_is_inverted_alone(tmp_path):
    frames = [row.frame for row in rows_of(tmp_path)]
    for constant, size in ((0x21, 2), (0xFE, 3)):
        for bit in range(8):
            wrong = constant ^ 1 << bit
            assert any(f[:1] == bytes((wrong,)) and len(f) == size for f in frames), (
                size,
                bit,
            )


def test_frames_have_each_length_and_its_neighbours(tmp_path):
    rows = rows_of(tmp_path)
    zeros = [row.frame for row in rows if not any(row.frame)]
    assert [len(frame) for frame in zeros] == [0, 1, 2, 3, 4]
    assert [row.frame for row in rows[:5]] == zeros
    assert [row.frame for row in rows[5:7]] == [b"\xff" * 2, b"\xff" * 3]


SAME_LENGTH = PAIR.replace("length: 3", "length: 2")


def test_frames_of_another_length_state_the_common_length(tmp_path):
    rows = rows_of(tmp_path, SAME_LENGTH)
    for row in rows:
        is_right = len(row.frame) == 2
        assert row.expected == (None if is_right else 2)
    assert SharedRow(TELEMETRY, 5, b"", None, 2) in rows
    zeros = [len(row.frame) for row in rows if not any(row.frame)]
    assert zeros == [0, 1, 2, 3]


NARROW = """\
messages:
  - name: A
    id: 5
    kind: {kind}
    shares_id: true
    length: 1
    fields:
      - {{at: 2, bits: 3, name: Kind, type: int, const: -3}}
  - name: B
    id: 5
    kind: {kind}
    shares_id: true
    length: 1
    fields:
      - {{at: 2, bits: 3, name: Kind, type: uint, const: 2}}
"""


def test_a_narrow_constant_leaves_the_bits_beside_it(tmp_path):
    rows = {row.frame[0]: row.message for row in rows_of(tmp_path, NARROW)
            if len(row.frame) == 1}  # fmt: skip
    for byte, name in rows.items():
        assert name == {0b101: "A", 0b010: "B"}.get(byte >> 2 & 7)
    kinds = {byte >> 2 & 7 for byte in rows}
    assert {0b101, 0b100, 0b111, 0b001, 0b010, 0b011, 0b000, 0b110} <= kinds


EARLY = """\
messages:
  - name: A
    id: 5
    kind: {kind}
    shares_id: true
    length: 5
    may_end_early: zeros
    fields:
      - {{at: 0, bits: 8, name: Kind, type: uint, const: 7}}
      - {{at: 8, bits: 32, name: Value, type: uint}}
  - name: B
    id: 5
    kind: {kind}
    shares_id: true
    length: 2
    fields:
      - {{at: 0, bits: 8, name: Kind, type: uint, const: 0}}
"""


def test_a_message_that_may_end_early_comes_without_its_zeros(tmp_path):
    rows = rows_of(tmp_path, EARLY)
    by_frame = {row.frame: row.message for row in rows}
    assert by_frame[b"\x07"] == "A" and by_frame[b"\x07\0\0\0\0"] == "A"
    assert by_frame[b"\0\0"] == "B"
    sizes = {len(frame) for frame, name in by_frame.items() if name is None}
    assert {1, 3} <= sizes  # the start, and half of the frames with wrong constants


COUNTED = """\
messages:
  - name: A
    id: 5
    kind: {kind}
    shares_id: true
    length: 2
    fields:
      - {{at: 0, bits: 8, name: Kind, type: uint, const: 7}}
      - {{at: 8, bits: 8, name: Size, type: uint}}
      - {{at: 16, bits: 8, name: Data, type: uint, count: Size, up_to: 9}}
  - name: B
    id: 5
    kind: {kind}
    shares_id: true
    length: 1
    fields:
      - {{at: 0, bits: 8, name: Kind, type: uint, const: 8}}
"""


def test_variable_messages_have_the_most_fewest_one_more_and_half_of_the_elements(
    tmp_path,
):
    rows = rows_of(tmp_path, COUNTED)
    frames = [row.frame for row in rows if row.message == "A"]
    assert {len(frame) - 2 for frame in frames} == {9, 0, 1, 5}
    # Frames whose counter contradicts their length are vectors of the message.
    assert all(frame[1] == len(frame) - 2 for frame in frames)
    assert [row.frame for row in rows if row.message == "B"] == [b"\x08"]
