"""The number that a client compares is the raw value of the field, in all orders."""

from __future__ import annotations

import random
from types import SimpleNamespace

import pytest

from icdgen import codec
from icdgen.icd import responses
from icdgen.icd.enumeration import Enum, Member
from icdgen.icd.layout import Layout, Scalar, StructRef
from icdgen.icd.model import Message
from icdgen.icd.responses import NumberRun, number_run
from tests.conformance.icds import read_unchecked

LENGTH = 6  # bytes; clients compare numbers of up to 4
PLACES = [
    (at, bits)
    for at in (0, 3, 4, 8, 9)
    for bits in (1, 4, 5, 7, 8, 11, 12, 16, 20, 24, 29, 32, 33, 40)
    if at + bits <= 8 * LENGTH
]
HEAD = "icdgen: 1\nnode: {{name: demo, title: Demo, byte_order: {}, bit_order: {}}}\nmessages:\n"
MESSAGE = (
    "  - {{name: At {at} {bits}, id: {id}, kind: telemetry, length: 6, "
    "fields: [{{at: {at}, bits: {bits}, name: Number, type: uint}}]}}\n"
)
RUNS = [
    NumberRun(byte, size, shift, little)
    for size in range(1, 5)
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


ROW = {"message": "Ack", "echo": "Command"}


@pytest.mark.parametrize(
    ("own", "expected"),
    [
        (None, {"ack": ROW, "nak": {"message": "Nak"}}),
        ("none", {}),
        ({"reply": "State"}, {"ack": ROW, "reply": {"message": "State"}, "nak": {"message": "Nak"}}),
        ({"ack": "none", "nak": ROW}, {"nak": ROW}),
    ],
)  # fmt: skip
def test_a_telecommand_overrides_the_responses_to_all_telecommands(own, expected):
    message = SimpleNamespace(response=own)
    commands = {"nak": "Nak", "ack": ROW, "progress": "none", "timeout_ms": 100}
    declared = responses.declared_responses(commands, message)
    assert declared == expected
    assert [*declared] == [kind for kind in responses.KINDS if kind in expected]


@pytest.mark.parametrize(
    ("kind", "row", "status", "reason"),
    [
        ("ack", {"status": "Code"}, "Code", "Code"),
        ("ack", {}, None, None),
        ("nak", {"reason": "Why"}, None, "Why"),
        ("nak", {"reason": "Why", "busy": [3]}, "Why", "Why"),
        ("nak", {"reason": "Why", "status": "Code", "busy": [3]}, "Why", "Why"),
    ],
)
def test_the_status_of_a_refusal_is_its_reason_if_it_can_mean_busy(
    kind, row, status, reason
):
    assert (responses.status_of(kind, row), responses.reason_of(row)) == (
        status,
        reason,
    )


@pytest.mark.parametrize(
    ("id_bits", "places"),
    [(8, [3, None]), (11, [2, 3, None]), (16, [2, 3, None]), (32, [0, 1, 2, 3, None])],
)
def test_a_byte_of_an_id_counts_from_its_most_significant_one(id_bits, places):
    node = SimpleNamespace(id_bits=id_bits)
    names = [f"id[{index}]" for index in range(len(places))]
    assert [responses.id_byte_of(node, name) for name in names] == places
    assert responses.id_byte_of(node, "id") is None


def test_a_response_repeats_the_id_or_several_numbers():
    assert responses.echoes_of({"echo": "Command"}) == {"Command": "id"}
    echo = {"Command": "id[0]", "Count": "header.sequence"}
    assert responses.echoes_of({"echo": echo}) == echo
    assert responses.echoes_of({}) == {}


def test_values_are_numbers_or_names_of_members():
    enum = Enum("Kind", (Member(0, "None", "No"), Member(3, "Some")))
    values = [0, 7, True, "None", "Some", "No", None]
    assert [responses.number_of(each, enum) for each in values] == [0, 7, 1, 0, 3, None, None]  # fmt: skip
    assert responses.number_of("Some", None) is None


def test_a_scalar_is_found_by_its_name_in_the_frame():
    cell = Layout("Cell", 1, (Scalar(name="State", type="uint", bits=8),))
    use = StructRef(name="Main", layout=cell, at=8)
    mode = Scalar(name="Mode", type="uint", bits=8)
    message = Message("Ack", "telemetry", Layout("Ack", 2, (mode, use)))
    names = ("Mode", "Main.State", "State", "Main", None)
    places = [responses.field_of(message, name) for name in names]
    assert [place and place.at for place in places] == [0, 8, None, None, None]
