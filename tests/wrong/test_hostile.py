"""Hostile files quickly give a finding. Files too large for the repository are
generated here.
"""

from __future__ import annotations

import gc
import time

import pytest

from icdgen import reports
from icdgen.icd.source import MAX_BYTES
from icdgen.loading import load

HEAD = (
    "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\n"
)


@pytest.fixture
def check(tmp_path, monkeypatch):
    """Yield a function that writes a file, loads it and returns ``(code, message)`` of
    each finding. Fails after two seconds of processor time, the limit for hostile
    files.

    Objects of other tests are frozen meanwhile: after hours of tests, walking them cost
    the garbage collector more time than the file.
    """
    monkeypatch.chdir(tmp_path)
    gc.collect()
    gc.freeze()

    def run(text: str, longest: int = 20_000) -> list[tuple[str, str]]:
        path = tmp_path / "demo.yaml"
        path.write_text(text, encoding="utf-8")
        started = time.process_time()
        loaded = load([path.relative_to(tmp_path)])
        printed = reports.get("text")(loaded.findings, loaded.texts)
        assert time.process_time() - started < 2
        assert len(printed) < longest
        return [(f.code, f.message) for f in loaded.findings]

    yield run
    gc.unfreeze()


def test_a_scalar_of_ten_megabytes(check):
    assert check(HEAD + "messages: " + "x" * 10_000_000) == [
        ("ICD001", f"the file has more than the {MAX_BYTES:,} bytes allowed")
    ]


def test_a_scalar_as_large_as_a_file_may_be(check):
    (finding,) = check(HEAD + 'vocabulary: ["' + "x" * (MAX_BYTES - 200) + '"]\n')
    assert finding == ("ICD001", f"a text of {MAX_BYTES - 200:,} characters")


@pytest.mark.parametrize("opening", ["[", "{a: ", "- "])
def test_nesting_ten_thousand_deep(check, opening):
    (finding,) = check("a:\n  " + opening * 10_000)
    assert finding == ("ICD001", "nested more than 40 deep")


def test_ten_thousand_levels_of_indentation(check):
    lines = "".join(" " * level + "a:\n" for level in range(1_000))
    (finding,) = check(lines)
    assert finding == ("ICD001", "nested more than 40 deep")


def test_a_formula_of_nothing_but_parentheses(check):
    field = "{at: 0, bits: 8, name: Angle, type: uint, formula: %s}"
    message = (
        HEAD
        + "messages: [{name: Status, id: 130, kind: telemetry, length: 1, fields: ["
        + field
        + "]}]\n"
    )
    (finding,) = check(message % ("(" * 900 + "raw" + ")" * 90))
    assert finding[0] == "ICD060"
    (finding,) = check(message % ("(" * 199 + "5"))
    assert finding[0] == "ICD060"


def test_names_of_ten_thousand_characters_are_cut_in_reports(check):
    message_line = (
        "  - {name: " + "X" * 9_000 + ", id: 1, kind: telecommand, length: 3}\n"
    )
    codes = {
        code for code, _ in check(HEAD + "messages:\n" + message_line + message_line)
    }
    assert {"ICD024", "ICD050", "ICD055"} <= codes


def test_a_name_that_is_one_vocabulary_word_thousands_of_times(check):
    message = (
        "messages: [{name: "
        + "Cube" * 2_000
        + ", id: 1, kind: telecommand, length: 3}]\n"
    )
    codes = {code for code, _ in check(HEAD + "vocabulary: [Cube]\n" + message)}
    assert codes == {"ICD024"}


def test_an_empty_vocabulary_word(check):
    message = "messages: [{name: Status, id: 1, kind: telecommand, length: 0}]\n"
    codes = {code for code, _ in check(HEAD + "vocabulary: ['']\n" + message)}
    assert codes == {"ICD010"}


def test_thousands_of_fields_over_one_another(check):
    fields = "".join(
        f"      - {{at: 0, bits: 8, name: F{n}, type: uint}}\n" for n in range(3_000)
    )
    head = "messages:\n  - name: Status\n    id: 130\n    kind: telemetry\n    length: 1\n    fields:\n"
    reported = check(HEAD + head + fields, longest=1_200_000)
    assert {code for code, _ in reported} == {"ICD021"}
    assert len(reported) == 2_999


def test_a_file_that_is_not_there(tmp_path):
    (finding,) = load([tmp_path / "nothing.yaml"]).findings
    assert (finding.code, finding.message) == (
        "ICD001",
        "cannot read the file: No such file or directory",
    )


def test_a_nul_written_as_an_escape(check):
    (finding,) = check(HEAD + 'include: ["a\\0b.yaml"]\n')[:1]
    assert finding == ("ICD001", "the text contains a NUL character")


def test_an_overlay_that_is_no_file_is_not_passed_over(tmp_path):
    (tmp_path / "demo.yaml").write_text(HEAD)
    (tmp_path / "errata").mkdir()
    overlay = tmp_path / "errata" / "demo.yaml"
    overlay.mkdir()
    assert [f.code for f in load([tmp_path / "demo.yaml"]).findings] == ["ICD001"]
    overlay.rmdir()
    overlay.symlink_to("nowhere.yaml")
    assert [f.code for f in load([tmp_path / "demo.yaml"]).findings] == ["ICD001"]


@pytest.mark.parametrize("name", ["other", "../../x", "null"])
def test_an_erratum_that_renames_its_node(tmp_path, name):
    (tmp_path / "demo.yaml").write_text(HEAD)
    (tmp_path / "errata").mkdir()
    (tmp_path / "errata" / "demo.yaml").write_text(
        "errata: 1\nnode: demo\nentries:\n  - id: X-1\n    title: t\n    where: {section: node}\n    printed: {name: demo}\n"
        f"    held: {{name: {name}}}\n    why: w\n    evidence: e\n    confidence: certain\n"
    )
    codes = {f.code for f in load([tmp_path / "demo.yaml"]).findings}
    assert codes == (set() if name == "other" else {"ICD010"})
