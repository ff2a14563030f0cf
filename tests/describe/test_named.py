"""Names of parts in code follow from their identifier and the words of the node."""

from __future__ import annotations

import pytest

from tests.describe.small import node_of

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
vocabulary: [CubeACP]
enums:
  - name: TcErrorReason
    members:
      - {value: 1, name: "N/A", identifier: Not Available}
structs:
  - name: 2nd Point
    identifier: SecondPoint
    length: 1
    fields: [{at: 0, bits: 8, name: X, type: uint}]
messages:
  - name: CubeACP State 2
    id: 130
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: "Rate (raw)", type: enum, enum: TcErrorReason}
      - {at: 8, name: Point, struct: 2nd Point}
"""


@pytest.fixture
def node(tmp_path):
    return node_of(tmp_path, ICD)


def test_names_are_the_words_of_the_identifier_or_else_of_the_name(node):
    (message,) = node.messages
    (enum,) = node.enums
    (struct,) = node.structs
    parts = (message, enum, enum.members[0], struct, *message.members)
    assert [(part.words, part.name, part.camel_name) for part in parts] == [
        (("cubeacp", "state", "2"), "cubeacp_state_2", "CubeacpState2"),
        (("tc", "error", "reason"), "tc_error_reason", "TcErrorReason"),
        (("not", "available"), "not_available", "NotAvailable"),
        (("second", "point"), "second_point", "SecondPoint"),
        (("rate", "raw"), "rate_raw", "RateRaw"),
        (("point",), "point", "Point"),
    ]


def test_a_declared_name_is_reported_with_its_owner_and_its_line(node):
    (message,) = node.messages
    rate = message.members[0]
    identifier = rate.identifier("demo_t", "rate_raw", "member")
    assert (identifier.scope, identifier.text, identifier.owner) == (
        "demo_t",
        "rate_raw",
        "field `Rate (raw)` of `CubeACP State 2`",
    )
    assert identifier.role == "member"
    assert identifier.part is rate.part is rate.model.node
    assert identifier.source is rate.part.source
    assert message.identifier("", "demo").role == ""
    assert message.owner == "message `CubeACP State 2`"
    assert node.structs[0].owner == "struct `2nd Point`"
    assert node.enums[0].owner == "enumeration `TcErrorReason`"
