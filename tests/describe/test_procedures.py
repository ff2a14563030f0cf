"""Comments on procedures name the range of inputs and the place in the manual."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.describe.procedures import input_text, procedure_text, source_text
from icdgen.protocol.procedures import Input


@pytest.mark.parametrize(
    ("source", "text"),
    [
        ({"section": "3.1", "table": 67}, "Table 67, section 3.1."),
        ({"section": "3.1"}, "Section 3.1."),
        ({"page": 4}, ""),
        ({}, ""),
    ],
)
def test_a_place_in_the_manual_is_a_sentence(source, text):
    assert source_text(source) == text


def test_a_procedure_has_its_summary_and_its_place():
    def text(summary, source):
        return procedure_text(SimpleNamespace(summary=summary, source=source))

    assert text("Erase it", {"table": 3}) == "Erase it. Table 3."
    assert text("", {"table": 3}) == "Table 3."
    assert text("Erase it!", {}) == "Erase it!"


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, "0 to 9."),
        ({"summary": "Page"}, "Page. 0 to 9."),
        ({"is_bytes": True}, "At most 9 bytes."),
        ({"values": (1, 4)}, "One of 1, 4."),
        ({"is_flag": True}, ""),
        ({"is_flag": True, "summary": "Verify"}, "Verify."),
    ],
)
def test_an_input_has_its_range(changes, text):
    plain = {
        "name": "page", "is_bytes": False, "is_flag": False, "enum": None, "most": 9,
        "values": (), "is_optional": False, "summary": "",
    }  # fmt: skip
    assert input_text(Input(**{**plain, **changes})) == text
