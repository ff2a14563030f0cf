"""Keywords of Rust in names of fields become raw identifiers wherever code has them."""

from __future__ import annotations

import pytest

from icdgen.backends.rust.names import raw_words


@pytest.mark.parametrize(
    ("member", "expression"),
    [
        ("rate", "rate"),
        ("types[3]", "types[3]"),
        ("type", "r#type"),
        ("type[3]", "r#type[3]"),
        ("type[i][0].match", "r#type[i][0].r#match"),
        ("points[2].move[1]", "points[2].r#move[1]"),
        ("union", "union"),  # a keyword in some places only
        ("self", "self"),  # cannot be a raw identifier
    ],
)
def test_a_keyword_is_a_raw_identifier_in_an_expression(member, expression):
    assert raw_words(member) == expression
