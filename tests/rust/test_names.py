"""Keywords of Rust in names of fields become raw identifiers wherever code has them."""

from __future__ import annotations

import pytest

from icdgen.backends.rust.names import (
    constant_name,
    field_name,
    has,
    memory_constant,
    own_name,
    raw_words,
    reader,
    scale_name,
    setter,
    variant,
    writer,
)
from tests.describe.small import message_of


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


def test_names_of_functions_and_constants_begin_with_their_purpose(tmp_path):
    message = message_of(
        tmp_path, "at: 0, bits: 8, name: Type, type: uint, count: 2", length=2
    )
    (member,), element = message.members, message.members[0].elements[1]
    assert (field_name(member), own_name(member)) == ("r#type", "r#type")
    assert (field_name(element), has(member), scale_name(member)) == (
        "r#type[1]",
        "has_type",
        "TYPE",
    )
    assert (
        variant("unknown_id"),
        constant_name("timeout_no_timeout"),
        memory_constant("download"),
        setter("rate_rpm"),
        reader("wheels"),
        writer("wheels"),
    ) == (
        "UnknownId",
        "TIMEOUT_NO_TIMEOUT",
        "DOWNLOAD_MEMORY",
        "set_rate_rpm",
        "read_wheels",
        "write_wheels",
    )
