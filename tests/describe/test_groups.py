"""Groups of members that are read and written together, and the bytes of a frame that
they cover.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.describe import FieldDescription, MessageDescription, describe
from icdgen.describe.arrays import StructArray, loop_of, struct_arrays_in
from icdgen.describe.groups import (
    Flags,
    FrameBytes,
    Group,
    LoopElements,
    Thresholds,
    WordRow,
    bytes_of_flags,
    group_fields,
    grouped_fields,
)
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT
from tests.icd.files import loaded, status

SETS = ["icd", "examples/devices/ublox", "tests/conformance/odd_icds", "tests/icd/fine"]
SMALL, LARGE = Thresholds(flags=(4,), row=3), Thresholds(flags=(8, 4), row=8)


def messages(path: str) -> list[MessageDescription]:
    return [
        message
        for node in describe(read_unchecked(ROOT / path)).nodes
        for message in node.messages
    ]


def message(folder, *fields: str, length: int) -> MessageDescription:
    result = loaded(folder, status(*fields, length=length))
    assert not result.findings
    return describe(result.icd).nodes[0].messages[0]


def scalars_of(group: Group) -> list[FieldDescription]:
    """Yield the fields of a group."""
    match group:
        case Flags() | WordRow():
            return list(group.fields)
        case LoopElements(array, _, loop):
            return list(array.elements[: loop.elements])
        case StructArray(array):
            return list(array.scalars)
    return list(group.elements)


@pytest.mark.parametrize("thresholds", [SMALL, LARGE], ids=["small", "large"])
@pytest.mark.parametrize("path", SETS)
def test_every_field_is_in_one_group_and_groups_keep_the_order_of_fields(
    path, thresholds
):
    for message in messages(path):
        grouped = [
            field.model.name
            for group in group_fields(message, thresholds)
            for field in scalars_of(group)
        ]
        in_structs = [
            field.model.name
            for array in struct_arrays_in(message)
            if message.last_part is None or array.field is not message.last_part.field
            for field in array.field.scalars
        ]
        alone = [field.model.name for field in grouped_fields(message)]
        assert grouped == alone + in_structs, message.name


@pytest.mark.parametrize("thresholds", [SMALL, LARGE], ids=["small", "large"])
@pytest.mark.parametrize("path", SETS)
def test_flags_of_a_group_are_neighbouring_bits_of_a_byte_and_words_of_a_row_follow_each_other(
    path, thresholds
):
    for message in messages(path):
        for group in group_fields(message, thresholds):
            if isinstance(group, Flags):
                bits = range(group.shift, group.shift + len(group.fields))
                wanted = [
                    (group.byte, bit)
                    for bit in (reversed(bits) if group.is_falling else bits)
                ]
                assert [field.pieces[0][:2] for field in group.fields] == wanted
                assert len(group.fields) in thresholds.flags
            elif isinstance(group, WordRow):
                step = group.fields[0].model.bits
                starts = [field.model.at for field in group.fields]
                assert starts == list(
                    range(8 * group.byte, 8 * (group.byte + group.length), step)
                )
                assert len({field.byte_order for field in group.fields}) == 1


def test_members_are_a_row_from_the_threshold_on_and_elements_of_an_array_always(
    tmp_path,
):
    fields = [f"name: W{n}, at: {16 * n}, bits: 16, type: uint" for n in range(3)]
    fields.append("name: Levels, at: 48, bits: 8, type: uint, count: 2")
    sample = message(tmp_path, *fields, length=8)
    kinds = [type(group) for group in group_fields(sample, SMALL)]
    assert kinds == [WordRow, WordRow]
    assert [type(group) for group in group_fields(sample, LARGE)] == [
        FieldDescription
    ] * 3 + [WordRow]


def test_a_loop_reads_all_elements_of_an_array_or_none(tmp_path):
    sample = message(
        tmp_path,
        "name: Halves, at: 0, bits: 4, type: uint, count: 8",
        "name: Odd, at: 32, bits: 4, type: uint, count: 9",
        "name: Words, at: 72, bits: 16, type: uint, count: 4",
        length=17,
    )
    halves, odd, words = map(loop_of, sample.members)
    assert halves is not None and (
        halves.per_iteration,
        halves.iterations,
        halves.begin,
        halves.step,
    ) == (2, 4, 0, 1)
    assert odd is None and words is None  # one element would remain; words are copied


def test_bytes_of_flags_are_those_with_enough_flags(tmp_path):
    fields = [f"name: F{n}, at: {n}, bits: 1, type: bool" for n in range(11)]
    sample = message(tmp_path, *fields, length=2)
    assert bytes_of_flags(sample, at_least=3) == {0, 1}
    assert bytes_of_flags(sample, at_least=4) == {0}


@given(
    st.lists(
        st.tuples(st.integers(0, 3), st.sampled_from(["whole", "part", "gap"])),
        max_size=12,
    ),
    st.randoms(),
)
def test_every_byte_of_a_frame_is_written_once_in_order(parts, random):
    frame_length = sum(length or 1 for length, _ in parts)
    frame, added, byte = FrameBytes(frame_length), [], 0
    for length, kind in parts:
        length = length or 1
        if kind == "whole":
            added.append((frame.add_whole, (byte, length, f"whole {byte}")))
        elif kind == "part":
            added += [
                (frame.add_part, (byte + n, shift, f"bit {shift}"))
                for n in range(length)
                for shift in (0, 5)
            ]
        byte += length
    random.shuffle(added)
    for add, arguments in added:
        add(*arguments)
    segments = list(frame.segments())
    assert [
        n
        for segment in segments
        for n in range(segment.byte, segment.byte + segment.length)
    ] == list(range(frame_length))
    assert all(segment.terms in ((), ("bit 0", "bit 5")) for segment in segments)
    assert [segment.statement for segment in segments if segment.statement] == sorted(
        (arguments[2] for add, arguments in added if add == frame.add_whole),
        key=lambda text: int(text.split()[1]),
    )
