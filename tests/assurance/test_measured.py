"""Measurements: what is read from their files, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path, PurePosixPath

import pytest

from icdgen.backends.assurance.measured import (
    code_digest,
    icd_digest,
    read_measurements,
)
from icdgen.errors import UserError
from tests.icd.files import HEAD, loaded

MEASURED = {
    "icdgen_measurement": 1, "title": "Sizes", "says": ["Bytes.", 2], "code": {"c": "1a"},
    "made_by": ["gcc"], "facts": [["All", 12]], "columns": ["a", "b"], "rows": [["x", 0], [1, 2]],
}  # fmt: skip


def read(folder: Path, **files: dict) -> list:
    """Return the measurements of files with these names and changed contents."""
    icd = loaded(folder, "messages: []\n").icd
    measured = folder / "measured"
    measured.mkdir()
    for name, changes in files.items():
        data = {**MEASURED, "icd": icd_digest(icd), "name": name, **changes}
        (measured / f"{name}.json").write_text(json.dumps(data))
    (measured / ".hidden.json").write_text("{}")
    (measured / "notes.txt").write_text("{}")
    return read_measurements(measured, icd, lambda language: {"c": "1a"}[language])


def test_measurements_are_sorted_by_their_names_and_have_texts(tmp_path):
    first, second = read(tmp_path, a={"name": "z-1"}, b={"name": "B"})
    assert (first.name, second.name) == ("B", "z-1")
    assert (first.says, first.made_by) == (("Bytes.", "2"), ("gcc",))
    assert (first.facts, first.columns) == ((("All", "12"),), ("a", "b"))
    assert (first.rows, first.code) == ([["x", "0"], ["1", "2"]], {"c": "1a"})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"icdgen_measurement": 2}, "not a measurement (no `icdgen_measurement: 1`)"),
        ({"made_by": "gcc"}, "`made_by` is missing or not of its kind"),
        ({"title": None}, "`title` is missing or not of its kind"),
        ({"facts": [["All", 1, 2]]}, "`facts` is missing or not of its kind"),
        ({"facts": ["ab"]}, "`facts` is missing or not of its kind"),
        ({"rows": [["x"]]}, "a row has not as many cells as there are columns"),
        ({"rows": [["x", 1, 2]]}, "a row has not as many cells as there are columns"),
        ({"name": "a/b"}, "`name` is no name for a file"),
        ({"name": "größe"}, "`name` is no name for a file"),
        ({"name": "-"}, "`name` is no name for a file"),
        ({"icd": "0" * 64}, "it measures other ICDs: the digest is 0000000000000000 there"),
        ({"code": {"c": "2b"}},
         "it measures other code: the digest of `c` is 2b there and 1a here"),
    ],
)  # fmt: skip
def test_another_file_is_refused_with_its_reason(tmp_path, changes, message):
    with pytest.raises(UserError) as error:
        read(tmp_path, a=changes)
    path = tmp_path / "measured" / "a.json"
    assert str(error.value).startswith(f"{path}: {message}")


def test_a_digest_depends_on_names_and_contents_but_not_on_the_order(tmp_path):
    files = [(PurePosixPath("a"), "1"), (PurePosixPath("b"), b"2")]
    digest = code_digest(files)
    assert digest == code_digest([(files[1][0], "2"), (files[0][0], b"1")])
    assert digest != code_digest([(files[0][0], "2"), (files[1][0], "1")])
    assert digest != code_digest(files[:1])
    named = loaded(tmp_path, f"{HEAD}messages: []\n").icd
    assert icd_digest(named) == icd_digest(loaded(tmp_path, "messages: []\n").icd)
