"""Keys of requests have exactly their type and range; everything else is refused."""

from __future__ import annotations

from typing import Any

import pytest
from icdgen_runtime._errors import LengthError, RangeError, UnknownIdError
from icdgen_runtime.wire.errors import (
    BusyError,
    ChecksumError,
    TooLongError,
    UnsupportedError,
)

from icdgen.runtime_objects import request_keys as keys
from icdgen.runtime_objects.refusals import Refusal, details_of, naming_the_field
from tests.limits import assert_limits


def detail(read: Any, *arguments: Any) -> str:
    """Return the detail of the refusal."""
    with pytest.raises(Refusal) as refusal:
        read(*arguments)
    assert refusal.value.details["error"] == "request"
    return refusal.value.details["detail"]


def is_accepted(*arguments: Any) -> bool:
    try:
        keys.number(*arguments)
    except Refusal:
        return False
    return True


def test_a_number_has_limits_and_by_default_32_bits():
    assert_limits(lambda n: is_accepted({"a": n}, "a"), least=0, most=0xFFFFFFFF)
    assert_limits(lambda n: is_accepted({"a": n}, "a", 3, 7), least=3, most=7)
    assert not is_accepted({"a": True}, "a")  # JSON distinguishes true from 1
    text = "`a` is missing or is no number from 3 to 7"
    for request in ({}, {"a": 8}, {"a": "5"}, {"a": 5.0}, {"a": True}, {"a": None}):
        assert detail(keys.number, request, "a", 3, 7) == text


def test_a_default_is_used_only_without_the_key():
    assert keys.number({}, "a", default=5) == 5
    assert keys.number({"a": 6}, "a", default=5) == 6
    assert not is_accepted({"a": None}, "a", 0, 9, 5)


def test_texts_flags_lists_and_objects_have_their_type():
    assert keys.text({"a": ""}, "a") == ""
    assert detail(keys.text, {"a": 1}, "a") == "`a` is missing or is no text"
    assert detail(keys.text, {}, "a") == "`a` is missing or is no text"
    assert (keys.flag({"a": True}, "a"), keys.flag({}, "a")) == (True, False)
    for value in (1, 0, None, "true"):
        assert detail(keys.flag, {"a": value}, "a") == "`a` is neither true nor false"
    assert keys.rows({"a": [1, "x"]}, "a") == [1, "x"]
    for request in ({}, {"a": {}}, {"a": "x"}):
        assert detail(keys.rows, request, "a") == "`a` is missing or is no list"
    assert keys.mappings({"a": [{}, {"b": 1}]}, "a") == [{}, {"b": 1}]
    text = "`a` has an entry that is no object"
    assert detail(keys.mappings, {"a": [{}, 1]}, "a") == text


def test_a_choice_is_one_of_the_values():
    assert keys.choice({"a": "can"}, "a", ("uart", "can")) == "can"
    assert detail(keys.choice, {"a": "CAN"}, "a", ("can",)) == "there is no such a"
    assert detail(keys.choice, {}, "a", ("can",)) == "`a` is missing or is no text"


def test_bytes_are_pairs_of_hexadecimal_digits():
    assert keys.octets({"bytes": "00fFA0"}) == b"\x00\xff\xa0"
    assert keys.octets({"x": ""}, "x") == b""
    for value in (None, "0", "0g", "00 ff", "00\n", 0, ["00"]):
        assert detail(keys.hex_bytes, value) == "not hex digits, two a byte"


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (LengthError("M", 4, 3), {"error": "length", "expected": 4, "actual": 3}),
        (TooLongError(4, 5), {"error": "too-long", "expected": 4, "actual": 5}),
        (ChecksumError(1, 2), {"error": "checksum", "expected": 1, "actual": 2}),
        (BusyError("x"), {"error": "busy"}),
        (UnsupportedError("x"), {"error": "unsupported"}),
        (UnknownIdError("n", "telemetry", 1), {"error": "unknown-id"}),
        (RangeError("f", "x", 9), {"error": "range"}),
    ],
)
def test_each_error_of_the_runtime_has_a_code_with_its_numbers(error, expected):
    assert details_of(error) == expected


def test_a_value_out_of_range_names_the_field_where_it_is_one_of_the_message():
    with pytest.raises(Refusal) as refusal, naming_the_field():
        raise RangeError("mode", "too large", 9)
    assert refusal.value.details == {"error": "range", "field": "mode"}
    with pytest.raises(BusyError), naming_the_field():
        raise BusyError("x")
