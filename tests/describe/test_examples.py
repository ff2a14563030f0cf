"""Examples in the comments of generated code compile: the value is a number and no
struct.
"""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.describe.examples import example_of_message
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT


@pytest.mark.parametrize(
    "path",
    ["examples/devices/p31u", "examples/devices/ublox", "tests/conformance/odd_icds"],
)
def test_the_value_of_an_example_is_a_number_in_its_frame(path):
    icd = read_unchecked(ROOT / path)
    shown = [
        (message, example_of_message(message))
        for node in describe(icd).nodes
        for message in node.messages
        if message.fields
    ]
    for message, field_example in shown:
        if field_example.shown is not None:
            field = field_example.shown.field
            assert field.struct is None and not field.count, (
                f"{message.name}: {field.name}"
            )
            if field_example.shown.raw and field.model.type != "float":
                assert any(field_example.frame), (
                    f"{message.name}: the frame does not hold {field.name}"
                )
