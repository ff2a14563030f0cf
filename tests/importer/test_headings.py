"""Which headings of a document belong to a section, and how a table is named."""

from __future__ import annotations

import pytest

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.document import Heading, SourceTable
from icdgen.importer.source_tables import name_of

CHAPTER, SECTION = Heading("4", "Motor", size=10), Heading("4.2", "State", size=12)
LARGE, SMALL = Heading("", "Motor", size=14), Heading("", "State", size=11)
ALIKE = Heading("", "Motor", size=11.3)


@pytest.mark.parametrize(
    ("outer", "inner", "is_within"),
    [
        (CHAPTER, SECTION, True),
        (SECTION, CHAPTER, False),
        (CHAPTER, Heading("5", "Wheel"), False),
        (CHAPTER, LARGE, True),
        (LARGE, CHAPTER, False),
        (LARGE, SMALL, True),
        (SMALL, LARGE, False),
        (ALIKE, SMALL, False),
    ],
)
def test_a_section_contains_longer_numbers_or_smaller_types(outer, inner, is_within):
    assert outer.contains(inner) == is_within


@pytest.mark.parametrize(
    ("label", "caption", "headings", "sheet", "name"),
    [
        (12, "Motor State", ["4.2 State"], "Sheet", "Table 12: Motor State"),
        (12, "", ["4.2 State"], "Sheet", "Table 12"),
        (None, "Motor State", ["4.2 State"], "Sheet", "Motor State"),
        (None, "", ["4 Motor", "4.2 State"], "Sheet", "4.2 State"),
        (None, "", [], "Sheet", "Sheet"),
    ],
)
def test_a_table_is_named_by_label_caption_heading_or_sheet(
    label, caption, headings, sheet, name
):
    table = SourceTable(label=label, caption=caption, headings=headings, sheet=sheet)
    assert name_of(table) == name


@pytest.mark.parametrize(
    ("place", "text"),
    [
        (SourcePlace(), ""),
        (SourcePlace(page=12), "page 12"),
        (SourcePlace(line=3), "line 3"),
        (SourcePlace(page=12, line=3), "page 12"),
        (SourcePlace(line=3, file="types.xml"), "types.xml, line 3"),
        (SourcePlace(file="types.xml"), "types.xml"),
    ],
)
def test_a_place_in_a_source_has_its_page_or_its_line(place, text):
    assert place.place == text
