"""Elements of arrays on the command line: by index, and as many as the array has."""

from __future__ import annotations

import pytest

from icdgen.loading import load
from icdgen.values.encode import encode
from icdgen.values.errors import BadValue

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Two
    id: 1
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: Last, type: uint}
      - {at: 8, bits: 8, name: Size, type: uint}
      - {at: 16, bits: 8, name: A, type: uint, count: {field: Last, plus: 1}, up_to: 4}
      - {at: 16, after: A, name: B, type: bytes, size: Size, up_to: 4}
    derived: [{name: Number, formula: Last + 1}]
  - name: One
    id: 2
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Last, type: uint}
      - {at: 8, bits: 8, name: A, type: uint, count: {field: Last, plus: 2}, up_to: 4}
  - name: Gains
    id: 3
    kind: telecommand
    length: 3
    fields: [{at: 0, bits: 8, name: Gain, type: int, count: 3}]
"""


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    file = tmp_path_factory.mktemp("icd") / "demo.yaml"
    file.write_text(ICD, encoding="utf-8")
    return load([file]).icd


@pytest.mark.parametrize("raw", [False, True])
@pytest.mark.parametrize(
    ("message", "assignments"),
    [
        ("One", ["a=[]"]),
        ("One", ["a=[1]"]),
        ("One", ["a[0]=1"]),
        ("Two", ["a=[]", "b=00"]),
        ("Two", ["b=00", "last=0"]),
    ],
)
def test_fewer_elements_than_there_always_are_are_refused(
    icd, message, assignments, raw
):
    with pytest.raises(
        BadValue, match=r"`A` has at least (1 element|2 elements), [01] given"
    ):
        encode(icd, "demo", message, assignments, raw)


@pytest.mark.parametrize(
    "name",
    ["gain[-1]", "gain[+1]", "gain[1.]", "gain[0x1]", "gain[01]", "gain[]", "gain[3]"],
)
def test_an_index_is_taken_as_it_is_written(icd, name):
    with pytest.raises(BadValue, match="Gains has no field"):
        encode(icd, "demo", "Gains", ["gain[0]=1", f"{name}=2", "gain[2]=3"])


def test_what_is_derived_is_not_set(icd):
    with pytest.raises(BadValue, match="Number: it is derived from `Last`"):
        encode(icd, "demo", "Two", ["a=[1]", "b=00", "number=1"])
