"""Enumerations are as wide as their fields, and list members, ranges and users."""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.describe.enums import enum_widths
from tests.icd.files import loaded, status

ENUM = """\
enums:
  - name: Mode
    members:
      - {value: 9, name: Idle}
      - {value: 1, to: 2, name: Two}
      - {value: 3, to: 5, name: Three Values}
"""


def node_of(folder, *fields, length, enum=ENUM):
    result = loaded(folder, enum + status(*fields, length=length))
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0]


@pytest.mark.parametrize(
    ("bits", "storage"), [(4, 8), (8, 8), (9, 16), (16, 16), (17, 32), (33, 64)]
)
def test_an_enumeration_stores_each_value_of_its_widest_field(tmp_path, bits, storage):
    rest = 64 - bits - 4
    fields = [
        f"at: 0, bits: {bits}, name: Wide, type: enum, enum: Mode",
        f"at: {bits}, bits: 4, name: Narrow, type: enum, enum: Mode",
        f"at: {bits + 4}, bits: {rest}, name: Other, type: uint",
    ]
    node = node_of(tmp_path, *fields, length=8)
    (enum,) = node.enums
    assert (enum.storage.bits, enum.storage.signed) == (storage, False)
    assert enum_widths(enum.icd) == {("demo", "Mode"): max(bits, 4)}


def test_the_members_of_a_range_are_its_ends(tmp_path):
    field = "at: 0, bits: 8, name: Mode, type: enum, enum: Mode"
    (enum,) = node_of(tmp_path, field, length=1).enums
    assert [member.model.value for member in enum.members] == [9, 1, 2, 3, 5]
    assert len({member.name for member in enum.members}) == 5
    (inner,) = enum.ranges  # one to two has no value between its ends
    assert (inner.value, inner.last) == (3, 5)
    assert enum.range_name(inner) == "three_values"
    assert enum.member(5) is enum.members[4]
    assert enum.member(4) is None


def test_users_are_the_fields_of_this_type_and_their_messages(tmp_path):
    fields = [
        "at: 0, bits: 8, name: First, type: enum, enum: Mode",
        "at: 8, bits: 8, name: Second, type: enum, enum: Mode",
        "at: 16, bits: 8, name: Third, type: uint",
    ]
    (enum,) = node_of(tmp_path, *fields, length=3).enums
    assert enum.users == {"First": ["Status"], "Second": ["Status"]}
