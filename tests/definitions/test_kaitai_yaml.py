"""Scalars of a .ksy, and files that are no Kaitai Struct."""

from __future__ import annotations

import pytest

from icdgen.definitions.kaitai_yaml import integer, parse
from icdgen.diagnostics import Findings
from tests.limits import assert_limits


def value(text):
    return parse("a.ksy", f"meta:\n  id: a\nvalue: {text}\n".encode())["value"]


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("12", 12),
        ("-12", -12),
        ("+1_000", 1000),
        ("007", 7),
        ("0", 0),
        ("0x1F", 31),
        ("-0XfF_00", -0xFF00),
        ("0b1_01", 5),
        ("0B11", 3),
        ("0o17", 15),
        ("0O7_7", 63),
        ("0x_", None),
        ("0o8", None),
        ("0b2", None),
        ("0xG", None),
        ("_1", None),
        ("1.0", None),
        ("1 ", None),
        ("1\n", None),
        ("", None),
    ],
)
def test_integers_have_the_notations_of_kaitai_struct(text, number):
    assert integer(text) == number


def test_a_number_has_at_most_40_characters():
    assert_limits(lambda digits: integer("1" * digits) is not None, most=40)
    assert_limits(lambda width: type(value("1." + "0" * (width - 2))) is float, most=40)


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("true", True),
        ("false", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("True", "True"),
        ("0x10", 16),
        ("1.5", 1.5),
        ("-1.e3", -1000.0),
        ("1.5E-1", 0.15),
        ("1e3", "1e3"),
        (".5", ".5"),
        ("u4le", "u4le"),
        ("'12'", "12"),
        ('"true"', "true"),
        ("''", ""),
    ],
)
def test_only_a_plain_scalar_is_a_number_or_a_word(text, result):
    scalar = value(text)
    assert (type(scalar), scalar) == (type(result), result)


def test_texts_are_cut_after_20000_characters():
    for quote in ("", "'"):
        assert_limits(
            lambda length, quote=quote: (
                value(quote + "a" * length + quote) == "a" * length
            ),
            most=20_000,
        )


def fault(data):
    with pytest.raises(Findings) as raised:
        parse("a.ksy", data)
    (finding,) = raised.value.findings
    assert (finding.code, finding.place.file) == ("IMP005", "a.ksy")
    return finding.place.line, finding.message, finding.help


def test_a_file_that_is_not_utf_8_is_refused_with_its_line():
    assert fault(b"meta:\n  id: \xff\n") == (
        2,
        "byte 0xFF is not UTF-8",
        "save the file as UTF-8",
    )


def test_a_byte_order_mark_is_ignored():
    assert parse("a.ksy", b"\xef\xbb\xbfmeta:\n  id: a\n")["meta"]["id"] == "a"


@pytest.mark.parametrize("data", [b"a: 1\n", b"- meta\n", b"meta: 1\n", b""])
def test_a_file_without_meta_is_refused(data):
    assert fault(data) == (
        1,
        "not a Kaitai Struct definition: it has no `meta`",
        "a .ksy begins with `meta:` and `seq:`",
    )


def test_an_anchor_is_refused_with_its_line():
    line, message, _ = fault(b"meta:\n  id: a\nx: &one 1\ny: *one\n")
    assert line == 3 and "format" not in message
