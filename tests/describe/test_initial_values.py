"""A new message has the initial values of the reference codec in every language."""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.describe import MessageDescription, describe
from icdgen.icd.frames import frame_fields
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT

SETS = ["icd", "examples/devices/ublox", "tests/conformance/odd_icds", "tests/icd/fine"]


def messages(path: str) -> list[MessageDescription]:
    return [
        message
        for node in describe(read_unchecked(ROOT / path)).nodes
        for message in node.messages
    ]


@pytest.mark.parametrize("path", SETS)
def test_a_new_message_has_the_optional_fields_and_values_of_the_reference_codec(path):
    for message in messages(path):
        initial = codec.initial_values(message.node, message.model)
        present = [field for field in message.fields if field.is_initially_present]
        assert {
            field.model.name: field.model.initial_value for field in present
        } == initial, message.name
        for field in present:
            value = initial[field.model.name]
            assert field.initial_raw == (0 if isinstance(value, bytes) else value)
            if field.has_physical and not field.is_text and field.model.type != "float":
                assert repr(field.initial_physical) == repr(
                    codec.physical_double(field.model, field.initial_raw)
                )


@pytest.mark.parametrize("path", SETS)
def test_the_frame_of_a_new_message_has_as_many_elements_as_code_gives_them_initial_values(
    path,
):
    for message in messages(path):
        layout, frame = (
            message.model.layout,
            codec.encode(
                message.node,
                message.model,
                codec.initial_values(message.node, message.model),
            ),
        )
        sizes = codec.sizes_of_frame(message.node, message.model, frame)
        assert all(
            field.initial_count == field.count
            for field in message.members
            if not field.is_in_last_part
        )
        for part in message.variable_parts[-1:]:
            assert part.field.initial_count == sizes[part.model.name]
        assert all(sizes[part.name] == part.fewest for part in layout.parts)
        assert len(frame) == layout.size_of_frame(sizes)


@pytest.mark.parametrize("path", SETS)
def test_what_is_zero_in_a_new_message_has_no_other_value_in_any_element(path):
    some_differ = False
    for message in messages(path):
        initial = codec.initial_values(message.node, message.model)
        present = {
            field.name
            for field in frame_fields(
                message.model.layout, message.node.orders, _sizes(message)
            )
        }
        for member in message.members:
            names = [
                field.model.name
                for field in member.scalars
                if field.model.name in initial.keys() & present
            ]
            is_zero = not any(
                initial[name] for name in names if not isinstance(initial[name], bytes)
            )
            if member.struct is None or member.is_in_last_part:
                assert member.is_initially_zero <= is_zero, (
                    f"{message.name}: {member.name}"
                )
                some_differ |= not is_zero
    assert some_differ or path.startswith("examples")


def _sizes(message: MessageDescription) -> dict[str, int]:
    return {
        name: part.fewest for name, part in message.model.layout.parts_by_size.items()
    }
