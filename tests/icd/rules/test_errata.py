"""Codes in the `accept` keys of errata."""

from __future__ import annotations

import pytest

from icdgen.icd.rules import errata  # noqa: F401
from tests.icd.files import codes, status
from tests.icd.rules.rows import rows

ENTRY = """\
# errata/demo.yaml
errata: 1
node: demo
entries:
  - {{id: D-001, title: A fault, where: {}, accept: [{}], why: Wrong., evidence: Table 1., confidence: likely}}
"""
MESSAGES = status("at: 0, bits: 16, name: Voltage, type: uint") + "".join(
    f"  - {{name: M{id}, id: {id}, kind: telemetry, length: 1}}\n" for id in range(4)
)


@pytest.mark.parametrize(
    ("names", "more"),
    [
        (["Status"], ""),
        (["Status", "M1"], ""),
        (["M1"], None),
        (["M1", "M2"], None),
    ],
)
def test_a_code_is_accepted_where_it_is_found(tmp_path, names, more):
    """Each message but `Status` has a byte without a field (ICD024)."""
    where = ", ".join(f"{{message: {name}}}" for name in names)
    text = MESSAGES + ENTRY.format(f"[{where}]", "ICD024")
    expected = f"there is no finding ICD024 to accept in demo.yaml:4{more}"
    column = 53 + len(where)
    assert rows(tmp_path, text, "ICD084") == (
        [] if more is None else [f"errata/demo.yaml:4:{column} {expected}"]
    )
    kept = {"M0", "M1", "M2", "M3"} - set(names)
    assert codes(tmp_path, text).count("ICD024") == len(kept)


@pytest.mark.parametrize(
    ("others", "more"),
    [(0, ""), (1, " and 1 other place"), (2, " and 2 other places")],
)
def test_a_code_that_is_found_nowhere_is_reported_once(tmp_path, others, more):
    names = ["Status", *(f"M{n}" for n in range(others))]
    where = ", ".join(f"{{message: {name}}}" for name in names)
    text = MESSAGES + ENTRY.format(f"[{where}]", "ICD020, ICD021")
    reported = [row.partition(" ")[2] for row in rows(tmp_path, text, "ICD084")]
    assert reported == [
        f"there is no finding {code} to accept in demo.yaml:4{more}"
        for code in ("ICD020", "ICD021")
    ]


def test_a_code_of_no_rule_is_reported_where_it_is(tmp_path):
    text = MESSAGES + ENTRY.format("{message: M1}", "ICD999, ICD024, E501")
    assert rows(tmp_path, text, "ICD085") == [
        "errata/demo.yaml:4:64 there is no rule ICD999",
        "errata/demo.yaml:4:80 there is no rule E501",
    ]
