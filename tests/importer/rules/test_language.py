"""Patterns, numbers and type names of the rule language."""

from __future__ import annotations

import pytest

from icdgen.importer.rules.language import (
    Taken,
    TypeName,
    decimal,
    normalised,
    take,
    type_of,
    whole_number,
)
from tests.importer.rules.small import pattern
from tests.limits import assert_limits


def test_the_roles_of_a_pattern_are_its_groups_in_their_order():
    compiled = pattern("{bit}(?:-{last_bit})? of {byte}")
    assert compiled.roles == {"byte", "bit", "last_bit"}
    assert compiled.order_of("byte", "last_bit", "bit") == ["bit", "last_bit", "byte"]
    assert compiled.order_of("byte", "name") == ["byte"]
    bare = pattern("name")
    assert (bare.roles, bare.regex, bare.order_of("name")) == ({"name"}, None, [])
    assert compiled.place.line == 1


@pytest.mark.parametrize(
    ("patterns", "text", "taken"),
    [
        # A bare role takes the whole text.
        (["name"], "Motor 7", Taken({"name": "Motor 7"}, "")),
        (["name"], "", Taken({}, "")),
        (["^{byte}$", "name"], "x", Taken({"name": "x"}, "")),
        (["^{byte}$", "^{bits} bits$"], "x", None), ([], "x", None),
        # The text beside the match is left.
        (["{byte}-{last_byte}"], "at 3-7 of it", Taken({"byte": "3", "last_byte": "7"}, "at of it")),
        (["{byte}(?:-{last_byte})?"], "3", Taken({"byte": "3"}, "")),
        (["BYTE {byte}"], "byte 0x1f", Taken({"byte": "0x1f"}, "")),
        (["{byte}"], "1Fh", Taken({"byte": "1Fh"}, "")),
        (["^{value}$"], "-5", Taken({"value": "-5"}, "")),
        (["^{value}$"], "0b101", Taken({"value": "0b101"}, "")),
        (["^{byte}$"], "-5", None),
        (["^{scale} {unit}$"], "-.5e-3 °C/s", Taken({"scale": "-.5e-3", "unit": "°C/s"}, "")),
        (["^{scale}$"], "1.", None), (["^{unit}$"], "m s", None),
        (["^{part}$"], "h", Taken({"part": "h"}, "")),
        (["^{part}$"], "15", Taken({"part": "15"}, "")), (["^{part}$"], "M", None),
        (["^{last_part}$"], "H", None),
        (["^{name:[A-Z]{2,3}}$"], "ABC", Taken({"name": "ABC"}, "")),
        (["^{name:[A-Z]{2,3}}$"], "ABCD", None), (["^{name: *}$"], "  ", Taken({}, "")),
        (["^{name:.*},"], " a ,", Taken({"name": "a"}, "")),
        # A minus sign of the pattern is a hyphen.
        (["{byte}\u2212{last_byte}"], "3-7", Taken({"byte": "3", "last_byte": "7"}, "")),
    ],
)  # fmt: skip
def test_the_first_pattern_that_matches_gives_roles(patterns, text, taken):
    assert take([pattern(each) for each in patterns], text) == taken


@pytest.mark.parametrize(
    ("text", "listed"),
    [
        ("0, 2", "0, 2"), ("byte 3 and 0x5 here", "3 and 0x5"), ("2, 0", "2, 0"),
        ("0, 1", ""), ("1/0", ""), ("0-2", ""), ("0 to 2", ""), ("2", ""),
    ],
)  # fmt: skip
@pytest.mark.parametrize("role", ["byte", "bit"])
def test_listed_numbers_that_are_apart_are_no_range(role, text, listed):
    between = r"(?:\s*(?:,|and|/|-|to)\s*{last_" + role + "})?"
    taken = take([pattern("{" + role + "}" + between)], text)
    assert taken is not None and taken.listed == listed


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("（ＩＤ：１２）　ａ～", "(ID:12) a~"), ("m² ½", "m² ½"), ("a \n b", "a b"),
    ],
)  # fmt: skip
def test_full_width_characters_become_ordinary_ones(text, result):
    assert normalised(text) == result


@pytest.mark.parametrize(
    ("text", "base", "number"),
    [
        ("16", 10, 16), ("-16", 10, -16), ("+16", 10, 16), ("− 16", 10, -16),
        ("–16", 10, -16), ("1 024", 10, 1024), ("0x1F", 10, 31), ("0X1f", 2, 31),
        ("1Fh", 10, 31), ("10H", 16, 16), ("0b101", 10, 5), ("0b101", 16, 5),
        ("0b101", 2, None), ("101", 2, 5), ("102", 2, None), ("1F", 16, 31),
        ("10", 16, 16), ("-1F", 16, None), ("1F", 10, None), ("", 10, None),
        ("1.0", 10, None), ("0b2", 10, None), ("0xg", 10, None), ("h", 10, None),
    ],
)  # fmt: skip
def test_a_whole_number_has_a_prefix_a_suffix_or_the_base(text, base, number):
    assert whole_number(text, base) == number


def test_a_whole_number_has_at_most_24_digits():
    assert_limits(lambda n: whole_number("1" * n) is not None, least=1, most=24)


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("1.50", "1.50"), ("+2", "2"), (".5", "0.5"), ("-.5", "-0.5"),
        ("− 0.1", "-0.1"), ("–3", "-3"), ("1 000.5", "1000.5"), ("1e-007", "1e-7"),
        ("1E+00", "1E+0"), ("1e10", "1e10"), ("1e99", "1e99"), ("1e100", None),
        ("1e-100", None), ("1e-0100", None), ("1.", None), ("1,5", None),
        ("0x10", None), ("", None), ("--1", None),
    ],
)  # fmt: skip
def test_a_decimal_keeps_its_digits(text, number):
    assert decimal(text) == number


@pytest.mark.parametrize(
    ("names", "kind", "bits"),
    [
        ("unsigned char|uchar|BYTE|octet|uint8_t|u8|U 8|uint_8|unsigned8", "uint", 8),
        ("char|signed char|int8_t|s8|i8|sint8|SIGNED 8", "int", 8),
        ("unsigned short|unsigned short int|uint16|u16", "uint", 16),
        ("short|short int|int16_t", "int", 16),
        ("unsigned long long|unsigned long long int|uint64_t", "uint", 64),
        ("long long|long long int|int64", "int", 64), ("uint|unsigned|u", "uint", 0),
        ("int|signed|sint|i|s", "int", 0),
        ("float|real|single|f32|float32|float 32|float32_t", "float", 32),
        ("double|f64|float_64", "float", 64), ("bool|Boolean|flag", "bool", 1),
        ("enum", "enum", 0), ("string|text|ASCII", "text", 0),
        ("bytes|array|raw|ｒａｗ", "bytes", 0),
    ],
)  # fmt: skip
def test_common_names_of_types_are_known(names, kind, bits):
    for name in names.split("|"):
        assert type_of(name) == TypeName(kind, bits), name


@pytest.mark.parametrize(
    "name", ["long", "unsigned long", "float16", "word", "uint8x", "xuint8", "", "f"]
)
def test_other_names_of_types_need_a_profile(name):
    assert type_of(name) is None
