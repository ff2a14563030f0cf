"""Texts of the ICD in generated Python are the same texts again when Python reads them."""

from __future__ import annotations

import ast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.backends.python.text import docstring, documented, literal, paragraph, prose

LETTERS = st.sampled_from(
    "ab \"'\\\n\r\t\0\x7f\xa0\xff\u0100\u2028\uffff\U00010000\U0001f600"
)


@given(st.one_of(st.text(LETTERS), st.text()))
def test_a_literal_is_the_text_again_on_one_line_of_visible_characters(text):
    source = literal(text)
    assert ast.literal_eval(source) == text
    assert source.isprintable()


@pytest.mark.parametrize(
    ("text", "source"),
    [
        ("a b", '"a b"'),
        ('a"b', "'a\"b'"),
        ("a'b", '"a\'b"'),
        ("a\"'b", '"a\\"\'b"'),
        ('\'""', "'\\'\"\"'"),
        ("\xe9\u4f4d", '"\xe9\u4f4d"'),
        ("\0\n\t\\", '"\\x00\\n\\t\\\\"'),
        ("\xa0\xad\u0600\uffff", '"\\xa0\\xad\\u0600\\uffff"'),
        ("\U000e0001", '"\\U000e0001"'),
    ],
)
def test_a_literal_has_the_quotes_and_escapes_that_formatters_prefer(text, source):
    assert literal(text) == source


@pytest.mark.parametrize(
    ("text", "source"),
    [
        ("a  b\n c", "a b c"),
        ("*a* a*b 2 * 3", "\\\\*a* a*b 2 * 3"),
        ("a_ a_b", "a\\\\_ a_b"),
        ("|a| ``b``", "\\\\|a| \\\\`\\\\`b\\\\`\\\\`"),
        ("a < b <c> </d>", "a < b \\\\<c> \\\\</d>"),
        ("\\n", "\\\\\\\\n"),
        ('say "so"', 'say \\"so\\"'),
        ("- a", "\\\\- a"),
        ("12. a", "12\\\\. a"),
        ("(a) b", "(a\\\\) b"),
        ("12.5 a", "12.5 a"),
        (".. note", "\\\\.. note"),
        (">>> a", "\\\\>>> a"),
        (":a: b", "\\\\:a: b"),
        ("== a", "\\\\== a"),
        ("a - b", "a - b"),
    ],
)
def test_text_of_a_docstring_has_no_markup_of_its_own(text, source):
    assert prose(text) == source


def test_only_a_paragraph_of_a_description_has_code_in_backticks():
    assert paragraph("`a*b*` *c*") == "`a*b*` \\\\*c*"
    assert prose("`a`") == "\\\\`a\\\\`"
    assert documented(["Use `x_`.", "*So*."]) == docstring(
        4, ["Use `x_`.", "\\\\*So*."]
    )
