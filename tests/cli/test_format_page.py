"""The complete ICDs in the documents can be used without changes."""

from __future__ import annotations

import re

import pytest

from icdgen.icd.fmt import format_text
from tests import documents

# Excerpts of manuals and links have tests of their own; the messages of these are
# checked, too.
EXAMPLES = [
    text
    for page in documents.pages()
    for text in documents.icds(page.read_text("utf-8"))
]
LANGUAGES = ("c", "python", "rust", "vectors", "c-selftest", "html")


@pytest.mark.parametrize(
    "text", EXAMPLES, ids=lambda text: re.search(r"name: (\w+)", text)[1]
)
def test_an_example_is_valid_formatted_and_generates_every_language(
    text, icdgen, tmp_path
):
    (tmp_path / "example.yaml").write_text(text, encoding="utf-8")
    checked = icdgen("check", "example.yaml")
    assert checked.status == 0, checked.out
    assert re.fullmatch(documents.layout(text), format_text(text, "example.yaml"))
    result = icdgen(
        *(word for name in LANGUAGES for word in ("--lang", name)),
        "--out",
        "out",
        "example.yaml",
    )
    assert result.status == 0, result.err
    assert all((tmp_path / "out" / name).is_dir() for name in LANGUAGES)


def test_the_documents_have_examples():
    assert len(EXAMPLES) > 25
