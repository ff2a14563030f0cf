"""Tables and names of files of the reports."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.backends.assurance.paper import Files, csv_text, lines_of
from icdgen.diagnostics import Place


def test_a_table_is_csv_with_a_header_and_crlf():
    rows = [["plain", ["one", "two"], []], ['a "b"', "c, d", ["e\nf"]]]
    assert csv_text(("Name", "List", "None"), rows) == (
        'Name,List,None\r\nplain,one; two,\r\n"a ""b""","c, d","e\nf"\r\n'
    )


@pytest.mark.parametrize(
    ("cell", "lines"), [("", [""]), ("text", ["text"]), (("a", "b"), ["a", "b"])]
)
def test_a_text_is_one_line_of_a_cell(cell, lines):
    assert lines_of(cell) == lines


def test_files_are_named_from_their_common_folder(tmp_path):
    files = Files(
        [str(tmp_path / "icd" / "demo.yaml"), str(tmp_path / "errata" / "demo.yaml")]
    )
    name = str(tmp_path / "icd" / "demo.yaml")
    assert files.relative_name(name) == "icd/demo.yaml"
    assert files.line(Place(name, 12, 3)) == "icd/demo.yaml:12"
    assert (files.relative_name(""), files.line(Place("", 12, 3))) == ("", "")


def test_a_single_file_is_named_without_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = Files(["icd/demo.yaml"])
    assert files.relative_name(str(tmp_path / "icd" / "demo.yaml")) == "demo.yaml"
    assert files.relative_name(str(Path("icd/demo.yaml"))) == "demo.yaml"
