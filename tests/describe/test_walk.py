"""The walk over the fields of messages and structs reaches every scalar that code
accesses directly.
"""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.describe.description import Into
from icdgen.icd.places import raw_fields_in
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT


@pytest.mark.parametrize("into", Into)
@pytest.mark.parametrize(
    "path", ["icd", "examples/devices/ublox", "tests/conformance/odd_icds"]
)
def test_code_reaches_every_scalar_once_in_order_however_far_it_goes_into_arrays(
    path, into
):
    for node in describe(read_unchecked(ROOT / path)).nodes:
        for message in node.messages:
            scalars = [
                scalar for field in message.walk(into) for scalar in field.scalars
            ]
            wanted = [
                (place.name, place.at) for place in raw_fields_in(message.model.layout)
            ]
            assert [
                (scalar.model.name, scalar.model.at) for scalar in scalars
            ] == wanted, message.name


def test_a_walk_stops_at_arrays_that_code_reads_in_loops():
    messages = [
        m
        for node in describe(read_unchecked(ROOT / "tests/conformance/odd_icds")).nodes
        for m in node.messages
    ]
    for message in messages:
        assert not any(
            field.struct and not field.count for field in message.walk(Into.STRUCTS)
        )
        assert not any(field.struct for field in message.walk(Into.ARRAYS_OF_STRUCTS))
        assert not any(
            field.struct or field.count for field in message.walk(Into.ALL_ARRAYS)
        )
    assert any(
        field.struct for message in messages for field in message.walk(Into.STRUCTS)
    )
    assert any(
        field.count
        for message in messages
        for field in message.walk(Into.ARRAYS_OF_STRUCTS)
    )
