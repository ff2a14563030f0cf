"""The set of rules: their order, their explanations, and findings that an erratum
accepts.
"""

from __future__ import annotations

import pytest

from icdgen.describe import nodes
from icdgen.icd import rules
from icdgen.loading import load
from tests.icd.files import HEAD, codes, findings, loaded, status, write

ACCEPTED = """
# errata/demo.yaml
errata: 1
node: demo
entries:
  - id: DEMO-001
    title: Bytes that are not described
    where: {message: Status}
    accept: [ICD024]
    why: The manual describes 2 of 6 bytes.
    evidence: Table 7.
    confidence: open
"""
VOLTAGE = "at: 0, bits: 16, name: Voltage, type: uint"


def test_rules_are_listed_by_code():
    assert list(rules.ALL) == sorted(rules.ALL)
    assert all(code == rule.code for code, rule in rules.ALL.items())


def test_titles_have_one_line_and_are_unique():
    titles = [rule.title for rule in rules.ALL.values()]
    assert len(set(titles)) == len(titles)
    assert all(len(title) < 100 and not title.endswith(".") for title in titles)


def test_an_explanation_has_title_reason_and_both_examples():
    text = rules.explain("icd021")
    page = rules.ALL["ICD021"].page
    assert text.startswith("# ICD021: Fields overlap (error)\n")
    assert all(part in text for part in (page.why, page.wrong, page.right))


def test_an_unknown_code_is_refused_with_the_nearest():
    with pytest.raises(
        rules.UnknownRule, match="there is no rule ICD21; did you mean ICD021"
    ):
        rules.explain("ICD21")


def test_an_accepted_finding_is_not_reported(tmp_path):
    assert codes(tmp_path, status(VOLTAGE, length=6)) == ["ICD024"]
    assert codes(tmp_path, status(VOLTAGE, length=6) + ACCEPTED) == []


def test_accepting_at_one_place_leaves_the_others(tmp_path):
    other = (
        status(VOLTAGE, length=6)
        .replace("messages:\n", "")
        .replace("Status", "Other")
        .replace("130", "131")
    )
    (finding,) = findings(tmp_path, status(VOLTAGE, length=6) + other + ACCEPTED)
    assert finding.code == "ICD024"
    assert "`Other`" in finding.message


def test_the_name_of_a_field_with_an_accepted_finding_is_still_checked(tmp_path):
    overlap = ACCEPTED.replace(
        "{message: Status}", "{message: Status, field: int}"
    ).replace("ICD024", "ICD021")
    icd = status(VOLTAGE, "at: 8, bits: 16, name: int, type: uint", length=3)
    assert codes(tmp_path, icd) == ["ICD021"]
    assert codes(tmp_path, icd + overlap)[:1] == ["ICD070"]


def test_the_rules_about_names_use_the_description_for_code(
    tmp_path,
):
    icd = status(VOLTAGE, "at: 8, bits: 16, name: Current, type: uint", length=3)
    accepted = ACCEPTED.replace(
        "{message: Status}", "{message: Status, field: Current}"
    ).replace("ICD024", "ICD021")
    model = loaded(tmp_path, icd + accepted).icd
    assert any(description.icd is model for description in nodes._recent)


def test_findings_stand_in_the_order_of_the_file(tmp_path):
    fields = [
        f"at: {16 * n}, bits: 24, name: F{n}, type: float, unit: furlong, formula: 1/raw"
        for n in range(9)
    ]
    reported = findings(tmp_path, status(*fields, length=3))
    assert {f.code for f in reported} == {
        "ICD020",
        "ICD021",
        "ICD022",
        "ICD042",
        "ICD060",
    }
    assert [f.place for f in reported] == sorted(f.place for f in reported)


def test_a_finding_is_reported_once_for_an_icd_that_two_others_include(tmp_path):
    for name in ("one", "two"):
        text = HEAD.replace("demo", name) + "include: [common.yaml]\n"
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    common = HEAD.replace("demo", "common") + status(VOLTAGE, length=6)
    (tmp_path / "common.yaml").write_text(common, encoding="utf-8")
    assert [f.code for f in load([tmp_path]).findings] == ["ICD024"]


def test_a_warning_does_not_make_the_icd_unusable(tmp_path):
    unused = "enums:\n  - name: Mode\n    members: [{value: 0, name: Idle}]\n"
    result = loaded(tmp_path, unused)
    assert [f.severity for f in result.findings] == ["warning"]
    assert result.ok


def test_the_model_contains_the_valid_parts_of_an_invalid_icd(tmp_path):
    result = loaded(tmp_path, status(VOLTAGE, "at: 0, bits: x, name: Bad, type: uint"))
    assert not result.ok
    assert [f.name for f in result.icd.node("demo").messages[0].fields] == ["Voltage"]


def test_shipped_icds_have_no_finding():
    from icdgen import shipped

    assert load([shipped.icds()]).findings == []


def test_an_icd_that_cannot_be_read_is_not_checked_further(tmp_path):
    path = write(tmp_path, status(VOLTAGE, length=6) + "    - [\n")
    assert [f.code for f in load([path]).findings] == ["ICD001"]
