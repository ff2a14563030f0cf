"""The crate of odd ICDs decodes and encodes exactly as the reference codec does.

The ICDs have ids beyond a byte, enumerations of every kind, and integers of every width
and position. `tests/conformance` tests the shipped ICDs and golden vectors.
"""

from __future__ import annotations

import json
import struct
from math import lcm

import pytest

from icdgen import codec
from icdgen.icd.formula import Scale
from icdgen.icd.places import NodePlace
from tests.rust import harness


@pytest.fixture(scope="module")
def testee(strange) -> list[str]:
    """Command that starts the testee of the crate."""
    return harness.build_testee(strange.icd)


def test_frames_are_decoded_and_encoded_like_the_reference_codec(strange, testee):
    requests = harness.frame_requests(strange.icd, count=10)
    assert harness.differences(strange.icd, testee, requests)[:3] == []


def test_constants_and_values_are_those_of_the_reference_codec(strange, testee):
    requests = harness.value_requests(strange.icd, largest=30)
    assert len(requests) > 5000
    assert harness.differences(strange.icd, testee, requests)[:3] == []


def test_every_physical_value_of_every_scale_is_exact(strange, testee):
    """The test covers all raw values of one field of each scale, width and sign.

    It skips fields of more than 12 bits.
    """
    fields = {}
    for node, message, kind, id in harness.routes(strange.icd):
        for field in message.fields:
            if field.scale is not None and field.bits <= 12:
                fields.setdefault(
                    (field.scale, field.bits, field.type), (node, kind, id, field)
                )
    assert fields
    requests = [
        {
            "op": "sweep", "node": node.name, "kind": kind, "id": id, "field": field.name,
            "from": field.raw_min, "to": field.raw_max,
        }
        for node, kind, id, field in fields.values()
    ]  # fmt: skip
    answers = harness.ask(
        testee, [json.dumps(request).encode() for request in requests]
    )
    for (scale, _, _), (*_, field), answer in zip(
        fields, fields.values(), answers, strict=True
    ):
        assert answer["failures"] == (
            _count_of_changed_values(field) if answer["failures"] else 0
        ), field.name
        assert answer["physical"] == _all_doubles(scale, field), field.name


def _count_of_changed_values(field: NodePlace) -> int:
    """Count the raw values that a round trip through a double changes.

    This happens only for scales with more digits than a double has.
    """
    assert abs(field.scale.offset) > 1 << 53
    raws = range(field.raw_min, field.raw_max + 1)
    return sum(
        _raw_from_physical(field, codec.physical_double(field, raw)) != raw
        for raw in raws
    )


def _raw_from_physical(field: NodePlace, value: float) -> int | None:
    try:
        return codec.raw_from_physical(field, value)
    except codec.CodecError:
        return None


def _all_doubles(scale: Scale, field: NodePlace) -> str:
    divisor = lcm(scale.factor.denominator, scale.offset.denominator)
    factor, offset = int(scale.factor * divisor), int(scale.offset * divisor)
    values = [
        (raw * factor + offset) / divisor
        for raw in range(field.raw_min, field.raw_max + 1)
    ]
    return struct.pack(f">{len(values)}d", *values).hex()
