"""Examples in the documentation of generated code show what compiles: a number, and no
struct.
"""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.describe.examples import example_of_message
from tests.conformance.icds import read
from tests.conftest import ROOT


@pytest.mark.parametrize(
    "path",
    ["examples/devices/p31u", "examples/devices/ublox", "tests/conformance/odd_icds"],
)
def test_the_value_that_an_example_shows_is_a_number_that_its_frame_holds(path):
    icd = read(ROOT / path)
    shown = [
        (message, example_of_message(message))
        for node in describe(icd).nodes
        for message in node.messages
        if message.fields
    ]
    for message, found in shown:
        if found.shown is not None:
            field = found.shown.field
            assert field.struct is None and not field.count, (
                f"{message.name}: {field.name}"
            )
            if found.shown.raw and field.model.type != "float":
                assert any(found.frame), (
                    f"{message.name}: the frame does not hold {field.name}"
                )
