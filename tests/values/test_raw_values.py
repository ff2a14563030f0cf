"""Raw values that the reference codec accepts and refuses."""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.loading import load
from icdgen.values import numbers
from tests.icd.files import HEAD
from tests.limits import assert_limits

FIELDS = {
    "unsigned": "bits: 5, type: uint",
    "signed": "bits: 5, type: int",
    "single": "bits: 1, type: uint",
    "wide": "bits: 64, type: uint",
    "wide and signed": "bits: 64, type: int",
    "bytes": "bits: 24, type: bytes",
}


@pytest.fixture
def fields(tmp_path):
    rows = "".join(
        f"      - {{at: {64 * place}, name: {name}, {keys}}}\n"
        for place, (name, keys) in enumerate(FIELDS.items())
    )
    message = f"  - name: All\n    id: 1\n    kind: telemetry\n    length: {8 * len(FIELDS)}\n    fields:\n{rows}"
    (tmp_path / "demo.yaml").write_text(f"{HEAD}messages:\n{message}")
    (message,) = load([tmp_path / "demo.yaml"]).icd.nodes[0].messages
    return {field.name: field for field in message.fields}


def is_accepted(field, value) -> bool:
    try:
        codec.check_raw(field, value)
    except codec.CodecError:
        return False
    return True


@pytest.mark.parametrize(
    ("name", "least", "most"),
    [
        ("unsigned", 0, 31),
        ("signed", -16, 15),
        ("single", 0, 1),
        ("wide", 0, (1 << 64) - 1),
        ("wide and signed", -(1 << 63), (1 << 63) - 1),
    ],
)
def test_a_raw_value_has_the_range_of_its_bits(fields, name, least, most):
    assert_limits(
        lambda value: is_accepted(fields[name], value), least=least, most=most
    )


def test_a_raw_value_is_an_integer(fields):
    field = fields["unsigned"]
    assert is_accepted(field, 1) and is_accepted(field, 1.0)
    for value in (1.5, 0.25, "1", b"\1"):
        assert not is_accepted(field, value), repr(value)


def test_bytes_have_the_length_of_their_field(fields):
    assert_limits(
        lambda size: is_accepted(fields["bytes"], bytes(size)), least=3, most=3
    )
    assert not is_accepted(fields["bytes"], 3) and not is_accepted(
        fields["bytes"], "abc"
    )


def test_a_typed_number_has_at_most_400_characters():
    assert_limits(lambda size: numbers.integer("1" * size) is not None, most=400)
    assert_limits(lambda size: numbers.rational("1" * size) is not None, most=400)
