"""Literals of generated Rust have their values, and lines are laid out as by rustfmt."""

from __future__ import annotations

import json
import math
import random
import re

import pytest

from icdgen.backends.rust.text import (
    arm,
    assigned,
    code,
    doc,
    double,
    integer,
    mask,
    prose,
    signature,
    string,
    whole_double,
)
from tests.limits import assert_limits


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.48828125, "0.488_281_25"),
        (1e-9, "1.0e-9"),
        (1e22, "1.0e22"),
        (-0.0, "-0.0"),
        (-0.5, "-0.5"),
        (1234567.0, "1_234_567.0"),
        (0.125, "0.125"),
        (0.1251, "0.125_1"),
        (1.5e300, "1.5e300"),
    ],
)
def test_a_double_is_its_shortest_literal_with_grouped_digits(value, text):
    assert double(value) == text


def test_literals_of_doubles_keep_each_bit():
    source = random.Random(1)
    for _ in range(300):
        value = math.ldexp(source.uniform(-1, 1), source.randint(-300, 300))
        text = double(value)
        assert float(text) == value and "." in text


@pytest.mark.parametrize(
    ("value", "bits", "text"),
    [
        (0, 4, "0x0"),
        (15, 8, "0x0f"),
        (0xFFF, 16, "0x0fff"),
        (0xFFFFF, 32, "0x000f_ffff"),
        (1, 64, "0x0000_0000_0000_0001"),
        (0xABCDE, 20, "0xa_bcde"),
    ],
)
def test_a_mask_has_a_digit_for_four_bits(value, bits, text):
    assert mask(value, bits) == text
    assert int(text, 16) == value


def test_whole_numbers_have_groups_of_three_digits():
    assert [integer(value) for value in (999, -32768)] == ["999", "-32_768"]
    assert [whole_double(value) for value in (0, -32768)] == ["0.0", "-32_768.0"]


@pytest.mark.parametrize(
    "text", ["plain", 'a "b" \\ c', "\n\t\r\x00\x7f", "°C 位 \U0001f600", "", "~ "]
)
def test_a_string_literal_is_ascii_and_has_its_text(text):
    literal = string(text)
    assert literal.isascii() and literal.isprintable()
    # JSON has the escapes of Rust, but writes characters as pairs of UTF-16.
    inner = re.sub(r"\\u\{([0-9a-f]+)\}", lambda m: chr(int(m[1], 16)), literal)
    assert json.loads(inner, strict=False) == text


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a_b", "a_b"),
        ("_a b_", "\\_a b\\_"),
        ("a & b", "a & b"),
        ("a &amp; &#38;", "a \\&amp; \\&#38;"),
        ("a*b [c] <d> ~e| $f$", "a\\*b \\[c\\] \\<d> \\~e\\| \\$f\\$"),
        ("at: http://a https://b", "at: http\\://a https\\://b"),
        ("`a*b` c*d", "`a*b` c\\*d"),
        ("a*b `c*d` `", "a\\*b \\`c\\*d\\` \\`"),
    ],
)
def test_markup_is_escaped_except_in_backticks(text, shown):
    assert prose(text) == shown


def test_comments_are_at_most_100_columns_wide():
    text = doc(["word " * 60, "Next."], "    ")
    lines = text.splitlines()
    assert max(map(len, lines)) <= 100 and len(lines[0]) > 95
    assert lines[-2:] == ["    ///", "    /// Next."]
    assert code(["a  b", ""], "  ", "//!") == "  //!\n  //! a  b\n  //!"


def test_a_line_of_more_than_100_columns_is_broken():
    def fits(write, columns, width):
        return "\n" not in write("x" * (columns - width))

    # Indentation, spaces and punctuation around the expression.
    assert_limits(
        lambda n: fits(lambda text: assigned("a =", text, ";"), n, 9), most=100
    )
    assert_limits(lambda n: fits(lambda text: arm("1", text), n, 18), most=100)
    long = "x" * 91
    assert assigned("a =", f"{long}y", ";") == f"    a =\n        {long}y;"
    assert arm("1", long, "") == f"1 => {long},"
    assert arm("1", "x" * 99, "") == f"1 => {{\n    {'x' * 99}\n}}"


def test_the_head_of_a_method_is_broken_at_its_parameters():
    assert signature("fn a", ("&self", "b: u8"), "u8") == (
        "    fn a(&self, b: u8) -> u8 {"
    )
    names = tuple(f"parameter_{n}: u8" for n in range(6))
    lines = signature("fn a", names, "u8").splitlines()
    assert lines == ["    fn a(", *(f"        {n}," for n in names), "    ) -> u8 {"]
