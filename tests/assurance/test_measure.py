"""The measurements of a small ICD have plausible numbers, report gaps, and are accepted
by the verification package.
"""

from __future__ import annotations

import json
import os
import re
import sys

import pytest

from icdgen.loading import load
from tests.assurance.measure import (
    c_only,
    coverage,
    misra,
    python_coverage,
    rust_coverage,
    rust_only,
    sizes,
)
from tests.assurance.measure.measurement import MeasurementFile, share
from tests.assurance.test_pack import make


def read_measurement(folder, name) -> dict:
    return json.loads((folder / f"{name}.json").read_text("utf-8"))


def test_the_vectors_execute_every_line_and_branch_of_the_c_of_an_icd(demo, tmp_path):
    assert coverage.main(["--out", str(tmp_path / "measured"), str(demo)]) == 0
    data = read_measurement(tmp_path / "measured", "coverage-c")
    rows = [row for row in data["rows"] if not row[0].startswith("icdgen")]
    assert {row[0] for row in rows} >= {
        "demo.h",
        "demo/estimated_roll.h",
        "demo/set_roll.h",
    }
    for _, functions, called, lines, executed, branches, taken in rows:
        assert (
            functions == called
            and lines == executed
            and branches == taken
            and int(lines) > 0
        )
    out = make(demo, tmp_path / "pack", "--measured", str(tmp_path / "measured"))
    assert {path.name for path in out.iterdir()} >= {
        "coverage-c.html",
        "coverage-c.csv",
        "coverage-c-gaps.csv",
    }


def test_code_that_is_not_executed_is_reported_and_fails(
    demo, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(c_only, "source", lambda icd: "int main(void) { return 0; }\n")
    assert coverage.main(["--out", str(tmp_path), str(demo)]) == 1
    errors = capsys.readouterr().err
    assert (
        "demo/estimated_roll.h" in errors
        and "line not executed without a known reason" in errors
    )
    assert any(
        row[3] == "branch" and not row[5]
        for row in read_measurement(tmp_path, "coverage-c-gaps")["rows"]
    )


def test_a_decision_that_mixes_and_with_or_is_detected(tmp_path):
    (tmp_path / "demo.h").write_text(
        "/* a && b || c; */ int f(int a) { if (a > 1 && a < 3) { return a == 1 || a == 2; } }\n"
    )
    assert coverage.mixed(tmp_path) == []
    (tmp_path / "other.h").write_text(
        "int g(int a) { return (a > 1 && a < 3) || a == 7; }\n"
    )
    assert coverage.mixed(tmp_path) == ["other.h: return (a > 1 && a < 3) || a == 7"]


def test_sizes_of_each_message_are_those_of_the_compiler(demo, tmp_path):
    assert sizes.main(["--out", str(tmp_path / "measured"), str(demo)]) == 0
    for name in ("sizes-cortex-m4", "sizes-avr"):
        rows = read_measurement(tmp_path / "measured", name)["rows"]
        assert [row[:3] for row in rows] == [
            ["demo", "Estimated Roll", "3"],
            ["demo", "Set Roll", "2"],
        ]
        assert all(
            int(row[3]) >= 2 and 10 < int(row[4]) < 200 and 10 < int(row[5]) < 200
            for row in rows
        )
    make(demo, tmp_path / "pack", "--measured", str(tmp_path / "measured"))


def test_the_record_of_misra_is_a_measurement():
    record = misra.measurement_file()
    assert isinstance(record, MeasurementFile) and len(record.rows) > 10
    assert all(len(row) == len(record.columns) and row[3] for row in record.rows)


@pytest.mark.parametrize(
    ("done", "total", "text"),
    [
        (3, 3, "3 of 3 (100.00 %)"),
        (99_999, 100_000, "99,999 of 100,000 (99.99 %)"),
        (0, 0, "0 of 0 (100.00 %)"),
        (1, 3, "1 of 3 (33.33 %)"),
    ],
)
def test_a_share_is_never_rounded_up_to_all(done, total, text):
    assert share(done, total) == text


def test_measurements_of_an_icd_that_changed_are_rejected(demo, tmp_path):
    sizes.main(["--out", str(tmp_path / "measured"), str(demo)])
    demo.write_text(demo.read_text("utf-8").replace("id: 146", "id: 147"), "utf-8")
    from icdgen.errors import UserError

    assert load([demo]).ok
    with pytest.raises(UserError, match="it measures other ICDs"):
        make(demo, tmp_path / "pack", "--measured", str(tmp_path / "measured"))


def test_the_vectors_execute_every_line_of_the_python_of_an_icd(demo, tmp_path):
    assert python_coverage.main(["--out", str(tmp_path / "measured"), str(demo)]) == 0
    rows = {
        name: (lines, executed)
        for name, lines, executed in read_measurement(
            tmp_path / "measured", "coverage-python"
        )["rows"]
    }
    generated = {name: pair for name, pair in rows.items() if "/demo/" in name}
    assert len(generated) > 3 and all(
        lines == executed for lines, executed in generated.values()
    )
    assert (
        0
        < int(rows["icdgen_messages/_compiled.py"][1])
        < int(rows["icdgen_messages/_compiled.py"][0])
    )
    make(demo, tmp_path / "pack", "--measured", str(tmp_path / "measured"))


def test_a_line_of_python_that_is_not_executed_is_reported_and_fails(
    demo, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(python_coverage, "by_id", lambda icd, built: [])
    assert python_coverage.main(["--out", str(tmp_path), str(demo)]) == 1
    assert re.search(
        r"icdgen_messages/demo/__init__\.py:\d+: not executed", capsys.readouterr().err
    )


def test_branches_of_python_are_found():
    assert python_coverage.branches(
        "if TYPE_CHECKING:\n    import a\nx = 1 if y else 2\nfor z in y:\n    pass\n"
    ) == [
        3,
        4,
    ]
    assert python_coverage.executable("if TYPE_CHECKING:\n    import a\nx = 1\n") == {
        1,
        3,
    }


COV = """\
#!{python}
import pathlib, sys
words = sys.argv
assert words[1:3] == ["show", "--object"] and words[4::2] == ["--instr-profile"] * len(words[4::2])
assert all(pathlib.Path(word).stat().st_size > 0 for word in (words[3], *words[5::2])) and words[5:]
source = next(folder / "source/rust/src" for folder in pathlib.Path(words[3]).parents if (folder / "source").is_dir())
for path in sorted(source.rglob("*.rs")):
    print(path)
    print("    1|       |// a comment")
    print("    2|      {count}|" + "code")
    print()
"""


@pytest.mark.parametrize(("count", "status"), [(3, 0), (0, 1)])
def test_lines_of_rust_that_were_not_executed_are_reported_and_fail(
    demo, tmp_path, monkeypatch, capsys, count, status
):
    """The programs are built and run as usual; only the tool that reads the counts is
    replaced.
    """
    if not rust_coverage.can_count():
        pytest.skip("this rustc was built without the profiler's runtime")
    cov = tmp_path / "bin" / "cov"
    cov.parent.mkdir()
    cov.write_text(
        COV.replace("{python}", sys.executable).replace("{count}", str(count))
    )
    cov.chmod(0o755)
    monkeypatch.setenv("PATH", str(cov.parent), prepend=os.pathsep)
    assert (
        rust_coverage.main(["--out", str(tmp_path / "measured"), str(demo)]) == status
    )
    rows = read_measurement(tmp_path / "measured", "coverage-rust")["rows"]
    assert ["demo/set_roll.rs", "1", "1" if count else "0"] in rows
    assert ("demo/set_roll.rs:2: not executed" in capsys.readouterr().err) == bool(
        status
    )
    if not status:
        out = make(demo, tmp_path / "pack", "--measured", str(tmp_path / "measured"))
        assert {path.name for path in out.iterdir()} >= {
            "coverage-rust.html",
            "coverage-rust.csv",
        }


def test_features_of_rust_only_are_used_for_every_message_enumeration_and_id(demo):
    text = rust_only.source(load([demo]).icd)
    assert (
        "message::<icd::demo::EstimatedRoll>(&[0, 0, 0])" in text
        and "icd::demo::Telemetry::from_bytes(255, &[])" in text
    )
