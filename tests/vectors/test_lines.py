"""Each line number of a vector file leads to the line of its vector."""

from __future__ import annotations

import json

from icdgen.vectors.lines import line_numbers
from icdgen.vectors.make import make_vectors
from icdgen.vectors.write import vector_file_text
from tests.icd.files import loaded

SMALL = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0, node_type: 7}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}]}
  - {name: messages, members: [{value: 0, name: Idle}, {value: 1, name: Run}]}
messages:
  - {name: Ping, id: 1, kind: telecommand, length: 0}
  - name: Status
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}
      - {at: 8, bits: 8, name: vectors, type: uint}
"""

SHARED = """\
messages:
  - name: A
    id: 5
    kind: telemetry
    shares_id: true
    length: 2
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint, const: 7}
      - {at: 8, bits: 8, name: Size, type: uint}
      - {at: 16, bits: 8, name: Data, type: uint, count: Size, up_to: 9}
  - name: B
    id: 5
    kind: telemetry
    shares_id: true
    length: 2
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint, const: 8}
      - {at: 8, bits: 8, name: Mode, type: uint}
"""


def of_line(lines, number):
    """Return the JSON in a line."""
    return json.loads(lines[number - 1].removesuffix(","))


def assert_numbers(vectors):
    """Assert that the numbers lead to the lines of their vectors."""
    text = vector_file_text(vectors)
    lines, numbers = text.split("\n"), line_numbers(vectors, text)
    for key, number in numbers.head.items():
        if key != "{":
            assert lines[number - 1].startswith(f'"{key}": ')
    assert numbers.ids.keys() == vectors.ids.keys()
    for direction, number in numbers.ids.items():
        assert lines[number - 1].startswith(f'"{direction}": {{')
    shared = [of_line(lines, number) for number in numbers.shared]
    assert [(row["id"], row["bytes"]) for row in shared] == [
        (row.id, row.frame.hex()) for row in vectors.shared
    ]
    assert {name: of_line(lines, at)["name"] for name, at in numbers.enums.items()} == {
        enum.name: enum.name for enum, _ in vectors.enums
    }
    assert list(numbers.messages) == [each.message.name for each in vectors.messages]
    for each in vectors.messages:
        own = numbers.messages[each.message.name]
        head = lines[own.head - 1]
        assert head.startswith(f'{{"name":{json.dumps(each.message.name)}')
        assert [of_line(lines, at)["name"] for at in own.fields.values()] == [
            field.name for field in each.fields
        ]
        assert list(own.fields) == [field.name for field in each.fields]
        assert lines[own.lengths - 1].startswith('"refused_lengths": ')
        frames = [of_line(lines, at)["bytes"] for at in own.rows]
        assert frames == [row.frame.hex() for row in each.rows]
    return numbers


def test_lines_of_a_small_node(tmp_path):
    icd = loaded(tmp_path, SMALL).icd
    numbers = assert_numbers(make_vectors(icd, icd.nodes[0]))
    keys = ["{", "icdgen_vectors", "generator", "node", "digest", "includes",
            "node_type", "never_set"]  # fmt: skip
    assert numbers.head == {key: at for at, key in enumerate(keys, 1)}
    assert (numbers.shared, len(numbers.enums)) == ([], 2)
    assert list(numbers.ids.values()) == [10, 11, 12]


def test_lines_of_shared_ids_and_fields_of_variable_length(tmp_path):
    icd = loaded(tmp_path, SHARED).icd
    vectors = make_vectors(icd, icd.nodes[0])
    numbers = assert_numbers(vectors)
    assert len(numbers.shared) == len(vectors.shared) > 10
    assert all(len(own.rows) > 5 for own in numbers.messages.values())
