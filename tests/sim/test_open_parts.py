"""Options of the simulator set variable-length fields and their counters."""

from __future__ import annotations

import pytest

from icdgen.errors import UserError
from icdgen.loading import load
from icdgen.sim.run import Options, build_device

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
protocol:
  link: {framing: {by: slip}, header: [{at: 0, bits: 8, role: id}]}
structs:
  - {name: Key, length: 2, fields: [{at: 0, bits: 8, name: Week, type: uint}, {at: 8, bits: 8, name: Hour, type: uint}]}
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 8, name: Points, type: uint, count: Points Count, up_to: 3}
      - {at: 8, after: Points, bits: 8, name: Last, type: uint}
messages:
  - name: Curves
    id: 3
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Points Count, type: uint}
      - {at: 8, bits: 8, name: Curves Count, type: uint}
      - {at: 16, name: Curves, struct: Curve, count: Curves Count, up_to: 2}
  - name: Keys
    id: 1
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Keys Count, type: uint}
      - {at: 8, bits: 8, name: Levels Last, type: uint}
      - {at: 16, bits: 8, name: Age, type: uint}
      - {at: 24, name: Keys, struct: Key, count: Keys Count, up_to: 3}
      - {at: 24, after: Keys, bits: 8, name: Levels, type: uint, count: {field: Levels Last, plus: 1}, up_to: 4}
      - {at: 24, after: Levels, name: Words, type: text, size: rest, up_to: 5}
  - name: Checked
    id: 4
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Size, type: uint}
      - {at: 8, name: Payload, type: bytes, size: Size, up_to: 4}
      - {at: 8, after: Payload, name: Sums, bits: 8, count: 2, type: uint}
      - {at: 8, after: Sums, bits: 16, name: CRC, type: uint}
  - name: Data
    id: 2
    kind: telemetry
    length: 0
    fields: [{at: 0, name: Data, type: bytes, size: rest, up_to: 6}]
"""


@pytest.fixture(scope="module")
def icd(tmp_path_factory):
    file = tmp_path_factory.mktemp("icd") / "demo.yaml"
    file.write_text(ICD, encoding="utf-8")
    return load([file]).icd


def frame(icd, message: str, *assigned: str) -> str:
    """Return the frame of a message after setting these values, in hexadecimal; equal
    after a restart.
    """
    line, _ = build_device(
        icd, None, Options(values=[(message, value) for value in assigned])
    )
    frames = [bytes(line.computer.program.values.frames[message])]
    line.computer.restart(0)
    frames.append(bytes(line.computer.program.values.frames[message]))
    assert frames[0] == frames[1]
    return frames[0].hex()


@pytest.mark.parametrize(
    ("message", "assigned", "expected"),
    [
        ("Keys", (), "00 00 00 00"),  # one level is always there
        ("Keys", ("levels=[7, 8]", "words=hi"), "00 01 00 0708 6869"),
        ("Keys", ("levels[2]=9",), "00 02 00 000009"),
        ("Keys", ("keys[1].hour=3", "keys[0].week=1"), "02 00 00 0100 0003 00"),
        ("Keys", ("keys[1].hour=3", "keys=[]"), "00 00 00 00"),
        ("Keys", ("levels=[7, 8]", "levels=[6]"), "00 00 00 06"),
        ("Keys", ("keys[0].hour=3", "keys count=2"), "02 00 00 0003 0000 00"),
        ("Keys", ("words=hello", "words="), "00 00 00 00"),
        ("Curves", ("curves[1].last=9",), "00 02 0000 0009"),
        ("Curves", ("curves[0].points[1]=7", "curves[0].last=9"), "02 01 00000709"),
        (
            "Curves",
            ("curves[0].points=[5, 6]", "curves[1].points=[7]"),
            "01 02 000500 000700",
        ),
        (
            "Curves",
            ("curves[1].kind=1", "points count=3"),
            "03 02 0000000000 0100000000",
        ),
        ("Checked", ("crc=0x1234",), "00 0000 3412"),
        ("Checked", ("payload=01 02", "sums=[3, 4]", "crc=5"), "02 0102 0304 0500"),
        ("Checked", ("crc=5", "payload=01 02", "payload=03"), "01 03 0000 0500"),
        ("Data", ("data=01 02 03",), "010203"),
        ("Data", ("data=01 02 03", "data=04"), "04"),
    ],
)
def test_set_elements_are_sent_and_counted(icd, message, assigned, expected):
    assert frame(icd, message, *assigned) == expected.replace(" ", "")


@pytest.mark.parametrize(
    "assigned",
    ["levels=[1, 2, 3, 4, 5]", "levels=[]", "keys count=4", "words=longer", "data=1"],
)
def test_impossible_elements_are_refused(icd, assigned):
    with pytest.raises(UserError):
        frame(icd, "Keys", assigned)
