"""The text report lists the first frames and words, and counts the remaining ones."""

from __future__ import annotations

import pytest

from icdgen.diff import inputs, reports
from icdgen.diff.report import DiffReport, make_report
from icdgen.diff.reports.markdown import escaped
from icdgen.diff.reports.text import COLOURS, MOST_FRAMES, MOST_WORDS, RESET, _wrapped
from tests.icd.files import HEAD


def report_of(tmp_path, monkeypatch, number: int, old: str, new: str) -> DiffReport:
    """Compare two ICDs with this number of telemetry messages."""
    for side, line in (("old", old), ("new", new)):
        rows = "".join(
            f"  - name: Part {chr(65 + n)}\n    id: {100 + n}\n    kind: telemetry\n"
            f"    length: 2\n    {line}\n"
            for n in range(number)
        )
        (tmp_path / side).mkdir()
        (tmp_path / side / "demo.yaml").write_text(f"{HEAD}messages:\n{rows}")
    monkeypatch.chdir(tmp_path)
    return make_report(*inputs.sides(["old", "new"], []))


def fields(at: int) -> str:
    return f"fields: [{{at: {at}, bits: 8, name: Count, type: uint}}, {{at: {8 - at}, bits: 8, name: Rate, type: uint}}]"


FIELDS = "fields: [{at: 0, bits: 16, name: Count, type: uint}]"


@pytest.mark.parametrize("excess", [-1, 0, 1, 3])
def test_at_most_twelve_frames_of_a_direction_are_listed(tmp_path, monkeypatch, excess):
    number = MOST_FRAMES + excess
    report = report_of(tmp_path, monkeypatch, number, fields(0), fields(8))
    lines = reports.get("text")(report).splitlines()
    starts = [
        index
        for index, line in enumerate(lines)
        if line.endswith(f"0 of {number} frames as before")
    ]
    assert starts and MOST_FRAMES == 12
    remaining = [f"  ... and {excess} more, which --all lists"] if excess > 0 else []
    for start in starts:
        frames = lines[start + 1 : lines.index("", start)]
        assert len(frames) == min(number, 12) + len(remaining)
        assert frames[min(number, 12) :] == remaining
    everything = reports.get("text")(report, everything=True)
    assert "which --all lists" not in everything


@pytest.mark.parametrize("excess", [-1, 0, 1, 3])
def test_at_most_ten_changes_of_words_are_listed(tmp_path, monkeypatch, excess):
    number = MOST_WORDS + excess
    old, new = (f"summary: {word} text.\n    {FIELDS}" for word in ("Some", "Other"))
    report = report_of(tmp_path, monkeypatch, number, old, new)
    assert report.counts()["text"] == number
    text = reports.get("text")(report)
    assert MOST_WORDS == 10
    assert text.count("note[DIF") == min(number, 10)
    remaining = f"  ... and {excess} more changes of words, which --all lists\n"
    assert ("which --all lists" in text) == (remaining in text) == (excess > 0)
    everything = reports.get("text")(report, everything=True)
    assert everything.count("note[DIF") == number
    assert "which --all lists" not in everything


def test_colours_change_nothing_else(tmp_path, monkeypatch):
    report = report_of(tmp_path, monkeypatch, 2, fields(0), fields(8))
    coloured = reports.get("text")(report, colour=True)
    assert f"{COLOURS['wire']}wire{RESET}: " in coloured
    for code in (*COLOURS.values(), RESET):
        coloured = coloured.replace(code, "")
    assert coloured == reports.get("text")(report)


def test_lines_are_wrapped_to_the_width(tmp_path, monkeypatch):
    report = report_of(tmp_path, monkeypatch, 2, fields(0), fields(8))
    narrow = reports.get("text")(report, width=60)
    assert narrow.split() == reports.get("text")(report).split()
    (reason,) = (
        n for n, line in enumerate(narrow.splitlines()) if line.startswith("version of")
    )
    assert all(len(line) <= 60 for line in narrow.splitlines()[reason : reason + 2])


def test_a_line_is_wrapped_beyond_the_width_with_its_indent():
    text = "aaaa " * 7 + "bbbb"  # 39 characters
    assert _wrapped(text, 41, "  ") == [f"  {text}"]
    assert _wrapped(text, 40, "  ") == [f"  {'aaaa ' * 6}aaaa", "  bbbb"]
    assert _wrapped(text, 40, "! ") == [f"! {'aaaa ' * 6}aaaa", "  bbbb"]
    assert _wrapped(text, None, "  ") == [f"  {text}"]
    # At least 30 characters remain beside the indent.
    assert _wrapped(text, 10, "  ") == [f"  {'aaaa ' * 5}aaaa", "  aaaa bbbb"]


def test_no_change_is_stated(tmp_path, monkeypatch):
    report = report_of(tmp_path, monkeypatch, 1, FIELDS, FIELDS)
    assert reports.get("text")(report) == "old -> new\nno change\n"
    assert reports.get("markdown")(report) == (
        "## ICD changes: old → new\n\nNo change.\n"
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a_b *c* <d> [e] #1 @f ~g {h}", r"a\_b \*c\* \<d\> \[e\] \#1 \@f \~g \{h\}"),
        ("`a_b` is *b*", r"`a_b` is \*b\*"),
        ("`a|b` | c", r"`a\|b` \| c"),
        ("`` empty", r"\`\` empty"),
        ("one ` only", r"one \` only"),
    ],
)
def test_markdown_outside_of_code_is_escaped(text, expected):
    assert escaped(text) == expected
