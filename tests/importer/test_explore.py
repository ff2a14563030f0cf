"""A manual that is new: what its tables look like, and a profile to begin with."""

from __future__ import annotations

import json

import pytest

from icdgen.importer import explore, profile, run
from tests.importer.manuals import zephyr
from tests.importer.manuals.wild import WILD
from tests.importer.test_command import icdgen


def test_the_kinds_of_tables_are_named_with_headings_count_and_pages(tmp_path):
    zephyr.draw(tmp_path / "zephyr.pdf")
    shown = icdgen("import", "zephyr.pdf", "--explore", cwd=tmp_path)
    assert (shown.returncode, shown.stderr) == (0, "")
    assert "# 2 times (not understood), page 1:\n#   First bit | Bit count | Quantity | Kind" in shown.stdout
    assert not (tmp_path / "icd").exists()
    data = json.loads(icdgen("import", "zephyr.pdf", "--explore", "--format", "json", cwd=tmp_path).stdout)
    assert data["kinds"][0]["count"] == 2


def test_a_register_map_is_named_by_its_headings(tmp_path):
    WILD["registers"].draw(tmp_path / "motor.pdf")
    shown = icdgen("import", "motor.pdf", "--explore", cwd=tmp_path).stdout
    assert ": 1 kind of tables." in shown and "#   Addr | Register | R/W | 7 | 6 | 5 | 4 | 3 | 2 | 1 | 0\n" in shown


def test_the_proposed_profile_reads_the_fields_of_a_manual_with_words_of_its_own(tmp_path):
    zephyr.draw(tmp_path / "zephyr.pdf")
    (tmp_path / "words.yaml").write_text(
        icdgen("import", "zephyr.pdf", "--explore", cwd=tmp_path).stdout, encoding="utf-8"
    )
    words = profile.load(tmp_path / "words.yaml")
    words.data["defaults"]["kind"] = "telemetry"
    words.data["variables"] = {"raw": ["N"], "physical": ["y"]}
    _, trees = run.run(tmp_path / "zephyr.pdf", words, jobs=1)
    tank = next(m for m in trees["zephyr"]["messages"] if m["name"] == "Report Tank")
    assert [(f["at"], f["bits"], f["name"]) for f in tank["fields"]] == [
        (0, 3, "Valve state"), (3, 1, "Heater on"), (8, 16, "Pressure"), (24, 16, "Temperature"),
    ]  # fmt: skip
    assert tank["fields"][2]["formula"] == "raw*0.1"


@pytest.mark.parametrize("layout", ["sections", "registers", "bit tables", "two heads"])
def test_every_proposed_profile_loads(layout, tmp_path):
    WILD[layout].draw(tmp_path / "motor.pdf")
    words = profile.load()
    result, _ = run.run(tmp_path / "motor.pdf", words, jobs=1)
    (tmp_path / "words.yaml").write_text(explore.report(result, words), encoding="utf-8")
    profile.load(tmp_path / "words.yaml")


def test_some_pages_are_read_as_they_are_in_the_whole(tmp_path):
    WILD["sections"].draw(tmp_path / "motor.pdf")
    run_ = icdgen("import", "motor.pdf", "--pages", "1-1", "--dry-run", cwd=tmp_path)
    assert "1 pages, " in run_.stdout
    assert "page 1" in run_.stdout
    refused = icdgen("import", "motor.pdf", "--pages", "7", cwd=tmp_path)
    assert (refused.returncode, "none from 7 to 7" in refused.stderr) == (2, True)
    for wrong in ("0", "5-3", "x", "-1"):
        assert icdgen("import", "motor.pdf", f"--pages={wrong}", cwd=tmp_path).returncode == 2


def test_the_report_is_a_work_list_with_what_is_left_out_on_top(tmp_path):
    zephyr.draw(tmp_path / "zephyr.pdf")
    (tmp_path / "words.yaml").write_text(
        icdgen("import", "zephyr.pdf", "--explore", cwd=tmp_path).stdout, encoding="utf-8"
    )
    run_ = icdgen("import", "zephyr.pdf", "--profile", "words.yaml", "--report", "report.html", cwd=tmp_path)
    assert run_.returncode == 1
    assert not (tmp_path / "icd").exists()  # a file without a message would be none
    page = (tmp_path / "report.html").read_text("utf-8")
    assert page.index("To do first") < page.index("defaults: {kind: telemetry}") < page.index("data:image/png")
