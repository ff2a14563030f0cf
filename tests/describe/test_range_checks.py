"""Encoders refuse raw values that fit their type but not the field."""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT


@pytest.mark.parametrize(
    "path", ["icd", "examples/devices/ublox", "tests/conformance/odd_icds"]
)
def test_an_encoder_checks_values_that_fit_the_type_but_not_the_field(path):
    for node in describe(read_unchecked(ROOT / path)).nodes:
        for message in node.composites:
            narrow = [
                field
                for field in message.fields
                if field.model.type in ("uint", "int", "enum")
                and field.model.bits < field.storage.bits
            ]
            checked = [
                field
                for member in message.members
                if member.needs_range_check
                for field in member.scalars
            ]
            assert {field.model.name for field in narrow} <= {
                field.model.name for field in checked
            }
            assert message.range_check_bits == max(
                (field.storage.bits for field in narrow), default=0
            ), message.name
