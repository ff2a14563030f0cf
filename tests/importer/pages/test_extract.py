"""Ruling lines, shaded areas and words from the objects of a page."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from icdgen.importer.pages import extract
from icdgen.importer.pages.extract import Fill, PageContents, RulingLine, Word

UPRIGHT = (1, 0, 0, 1, 0, 0)


def page() -> PageContents:
    return PageContents(1, 200, 100)


def char(text: str, size: float = 10.0, bottom: float = 50.0, **keys) -> dict[str, Any]:
    """Return a character of a word, as pdfplumber returns it."""
    colour = keys.pop("colour", 0)
    source = SimpleNamespace(
        fontname=keys.pop("font", "ABCDEF+Arial"),
        matrix=keys.pop("matrix", UPRIGHT),
        graphicstate=SimpleNamespace(ncolor=colour),
    )
    return {"text": text, "size": size, "bottom": bottom, "from": source, **keys}


def word_of(*chars: dict[str, Any], box=(10, 40, 30, 50), upright=True) -> PageContents:
    contents = page()
    text = "".join(each["text"] for each in chars)
    x0, top, x1, bottom = box
    word = {"text": text, "chars": list(chars), "upright": upright, "x0": x0, "top": top, "x1": x1, "bottom": bottom}  # fmt: skip
    extract._word(contents, word)
    return contents


@pytest.mark.parametrize(
    ("box", "across", "down"),
    [
        ((10, 20, 90, 20), [RulingLine(20, 10, 90)], []),
        ((10, 20, 90, 22.5), [RulingLine(21.25, 10, 90)], []),
        ((10, 20, 90, 22.6), [], []), ((10, 20, 10, 90), [], [RulingLine(10, 20, 90)]),
        ((10, 20, 12.5, 90), [], [RulingLine(11.25, 20, 90)]),
        ((10, 20, 12.6, 90), [], []),
        ((10, 20, 12, 21), [RulingLine(20.5, 10, 12)], []),
        ((10, 20, 11, 22), [], [RulingLine(10.5, 20, 22)]),
        # A dot is no rule.
        ((10, 20, 10, 20), [], []),
    ],
)  # fmt: skip
def test_a_thin_box_is_a_rule_in_its_longer_direction(box, across, down):
    contents = page()
    extract._line(contents, *box)
    assert (contents.across, contents.down) == (across, down)


SIDES = [RulingLine(20, 10, 90), RulingLine(60, 10, 90)]
EDGES = [RulingLine(10, 20, 60), RulingLine(90, 20, 60)]


@pytest.mark.parametrize(
    ("fill", "stroke", "colour", "fills", "across", "down"),
    [
        (True, False, 0.5, [Fill(10, 20, 90, 60)], [], []),
        (True, False, 1, [], [], []), (False, True, 0.5, [], SIDES, EDGES),
        (True, True, None, [Fill(10, 20, 90, 60)], SIDES, EDGES),
        (False, False, 0.5, [], [], []),
    ],
)  # fmt: skip
def test_a_rectangle_has_rules_where_it_is_stroked_and_a_shade(
    fill, stroke, colour, fills, across, down
):
    rectangle = SimpleNamespace(fill=fill, stroke=stroke, non_stroking_color=colour)
    contents = page()
    extract._rectangle(contents, rectangle, 10, 20, 90, 60)
    assert (contents.fills, contents.across, contents.down) == (fills, across, down)


@pytest.mark.parametrize("box", [(10, 20, 12.5, 60), (10, 20, 90, 22.5)])
def test_a_thin_rectangle_is_a_rule_whatever_its_paint(box):
    contents = page()
    extract._rectangle(contents, SimpleNamespace(), *box)
    assert len(contents.across) + len(contents.down) == 1 and not contents.fills


@pytest.mark.parametrize(
    ("colour", "is_white"),
    [
        (None, False), (0, False), (0.98, False), (0.99, True), ((1, 1, 1), True),
        ([1, 0.98, 1], False), ((0, 0, 0, 0), True), ((0, 0, 0, 0.01), True),
        ((0, 0, 0, 0.02), False), ((1, 1, 1, 1), False), (("P1",), False),
        ((1, "P1"), False),
    ],
)  # fmt: skip
def test_white_has_all_light_or_no_ink(colour, is_white):
    assert extract._white(colour) is is_white


def test_the_straight_pieces_of_a_path_are_rules_on_the_visible_page():
    curve = SimpleNamespace(pts=[(10, 90), (60, 90), (60, 40), (10, 35)])
    contents = page()
    extract._curve(contents, curve, extract._Shift(5, 100))
    assert contents.across == [RulingLine(10, 15, 65)]
    assert contents.down == [RulingLine(65, 10, 60)]
    box = SimpleNamespace(x0=1, y0=2, x1=3, y1=5)
    assert extract._Shift(5, 100).box(box) == (6, 95, 8, 98)


def test_a_word_has_the_size_of_its_largest_character():
    contents = word_of(char("m", 9), char("a", 10), char("x", 8.5))
    assert contents.words == [Word("max", 10, 40, 30, 50, 10, "Arial 0.00")]
    (word,) = contents.words
    assert (word.centre, word.middle) == (20, 45)


@pytest.mark.parametrize(
    ("size", "bottom", "text"),
    [
        (8, 46, "m²"), (8, 48.7, "m²"),
        # On the base line, or nearly as large as the word.
        (8, 48.8, "m2"), (8, 50, "m2"), (8.1, 40, "m2"),
    ],
)  # fmt: skip
def test_a_small_raised_figure_is_a_superscript(size, bottom, text):
    (word,) = word_of(char("m"), char("2", size, bottom)).words
    assert word.text == text


@pytest.mark.parametrize(
    ("box", "is_seen"),
    [
        ((-10, 40, 10, 50), True), ((-10, 40, 9.9, 50), False),
        ((190, 40, 210, 50), True), ((190, 40, 210.1, 50), False),
        ((10, -5, 30, 5), True), ((10, -5, 30, 4.9), False), ((10, 95, 30, 105), True),
        ((10, 95, 30, 105.1), False),
    ],
)  # fmt: skip
def test_words_whose_middle_is_outside_the_page_are_counted(box, is_seen):
    contents = word_of(char("a"), box=box)
    assert (len(contents.words), contents.unseen) == ((1, 0) if is_seen else (0, 1))


def test_turned_blank_and_unmapped_words_are_counted():
    turned = word_of(char("a"), upright=False, box=(-99, 0, -90, 9))
    assert (turned.words, turned.turned, turned.unseen) == ([], 1, 0)
    blank = word_of(char("\u200b"), upright=False)
    assert (blank.words, blank.turned) == ([], 0)
    unmapped = word_of(char("(cid:7)"), char("(cid:12)"), char("\ufffd"))
    assert (len(unmapped.words), unmapped.unmapped) == (1, 3)
