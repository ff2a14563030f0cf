"""The number that a client compares is the raw value of the field, in all orders."""

from __future__ import annotations

import random

import pytest

from icdgen import codec
from icdgen.icd.responses import MOST_BYTES, NumberRun, number_run
from tests.conformance.icds import read_unchecked

LENGTH = 6
PLACES = [
    (at, bits)
    for at in (0, 3, 4, 8, 9)
    for bits in (1, 4, 5, 7, 8, 11, 12, 16, 20, 24, 29, 32)
    if at + bits <= 8 * LENGTH
]
HEAD = "icdgen: 1\nnode: {{name: demo, title: Demo, byte_order: {}, bit_order: {}}}\nmessages:\n"
MESSAGE = (
    "  - {{name: At {at} {bits}, id: {id}, kind: telemetry, length: 6, "
    "fields: [{{at: {at}, bits: {bits}, name: Number, type: uint}}]}}\n"
)
RUNS = [
    NumberRun(byte, size, shift, little)
    for size in range(1, MOST_BYTES + 1)
    for byte in range(LENGTH + 1 - size)
    for shift in range(8)
    for little in (False, True)
]


def number_in(run: NumberRun, bits: int, frame: bytes) -> int:
    """Return the number at a position of a frame."""
    data = frame[run.byte : run.byte + run.size]
    number = int.from_bytes(data, "little" if run.little else "big")
    return number >> run.shift & (1 << bits) - 1


@pytest.mark.parametrize("byte_order", ["little", "big"])
@pytest.mark.parametrize("bit_order", ["lsb0", "msb0"])
def test_the_number_of_a_field_is_its_raw_value_wherever_a_run_of_bytes_has_it(
    tmp_path, byte_order, bit_order
):
    rows = (
        MESSAGE.format(at=at, bits=bits, id=id) for id, (at, bits) in enumerate(PLACES)
    )
    file = tmp_path / "demo.yaml"
    file.write_text(HEAD.format(byte_order, bit_order) + "".join(rows))
    (node,) = read_unchecked(file).nodes
    source = random.Random(1)
    frames = [source.randbytes(LENGTH) for _ in range(12)]
    assert len(node.messages) == len(PLACES)
    for message in node.messages:
        (field,) = message.fields
        raw = {
            frame: codec.decode_frame(node, message, frame)["Number"]
            for frame in frames
        }
        right = [
            run
            for run in RUNS
            if all(number_in(run, field.bits, frame) == raw[frame] for frame in frames)
        ]
        run = number_run(field, node)
        assert run in right if right else run is None, message.name
