"""ICDs that are drawn as manuals and imported are the same again in every layout."""

from __future__ import annotations

import os
import random

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from icdgen.importer.reading import pdf
from tests.importer.compare import differences
from tests.importer.conftest import imported
from tests.importer.manuals import content, random_icds
from tests.importer.manuals.layouts import LAYOUTS

TITLES = {
    "common": "Common",
    "bootloader": "BootLoader",
    "cubeacp": "CubeAcp",
    "cubewheel": "CubeWheel",
    "cubemag": "CubeMag",
}


def differences_after_import(manual: content.Manual, layout: str, path) -> list[str]:
    """Draw and import a manual and return the differences."""
    LAYOUTS[layout](manual, path)
    result, trees = imported(path)
    assert set(trees) == set(manual.trees)
    # A rule for tables that a layout does not have applies to none; random fields may
    # share a name. Nothing else is wrong.
    assert {
        import_finding.code
        for import_finding in result.import_findings
        if import_finding.severity == "error"
    } <= {
        "IMP101",
        "IMP107",
    }
    return [
        line
        for name, tree in manual.trees.items()
        for line in differences(tree, trees[name])
    ]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_shipped_icds_come_back_from_every_layout(layout, tmp_path):
    trees = (
        content.shipped("common", "bootloader")
        | content.shipped("cubemag")
        | content.shipped("cubewheel")
    )
    assert (
        differences_after_import(
            content.manual(trees, TITLES), layout, tmp_path / "manual.pdf"
        )
        == []
    )


@pytest.mark.parametrize(
    ("layout", "skip"),
    # Every second layout; `test_page_breaks` has large tables in others.
    [(name, 40 * index) for index, name in enumerate(list(LAYOUTS)[::2])],
)
def test_large_tables_come_back_from_every_layout(layout, skip, tmp_path):
    trees = content.shipped("cubeacp", most=14, skip=8 + skip % 100)
    assert (
        differences_after_import(
            content.manual(trees, TITLES), layout, tmp_path / "manual.pdf"
        )
        == []
    )


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_manual_of_one_page_without_lists_and_prose_comes_back(layout, tmp_path):
    trees = content.shipped("cubewheel")
    manual = content.manual(trees, TITLES, noise=False)
    manual.parts = [
        part for part in manual.parts if getattr(part, "kind", "") != "list"
    ]
    LAYOUTS[layout](manual, tmp_path / "cubewheel.pdf")
    _, got = imported(tmp_path / "cubewheel.pdf")
    assert differences(trees["cubewheel"], got["cubewheel"]) == []


@settings(
    max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True,
    # To draw and read a document for each step of shrinking takes minutes.
    phases=[Phase.explicit, Phase.generate],
)  # fmt: skip
@given(tree=random_icds.trees(), layout=st.sampled_from(sorted(LAYOUTS)))
def test_random_icds_come_back(tree, layout, tmp_path_factory):
    path = tmp_path_factory.mktemp("random") / "manual.pdf"
    assert (
        differences_after_import(
            content.manual({"device": tree}, {"device": "Device"}), layout, path
        )
        == []
    )


def test_the_rest_of_a_name_that_reads_like_headings_begins_no_table(tmp_path):
    names = [
        "Wheel SD-card Sun Panel Mode Value",
        "Wheel SD-card Sun Panel State Level",
        "Gain",
    ]
    fields = [
        {"at": 64 * index, "bits": 64, "name": name, "type": "float", "unit": "deg"}
        for index, name in enumerate(names)
    ]
    message = {
        "name": "Panels",
        "kind": "telecommand",
        "id": 1,
        "length": 24,
        "group": "Power",
        "fields": fields,
    }
    tree = {"icdgen": 1, "node": {"name": "device"}, "messages": [message]}
    assert (
        differences_after_import(
            content.manual({"device": tree}, {"device": "Device"}),
            "small",
            tmp_path / "manual.pdf",
        )
        == []
    )


def test_the_rest_of_a_name_with_a_word_between_headings_begins_no_table(tmp_path):
    field = {"at": 0, "bits": 1, "name": "Raw Temperature I2C Mode of Value"}
    message = {
        "name": "Panels",
        "kind": "telecommand",
        "id": 1,
        "length": 1,
        "group": "Power",
        "fields": [{**field, "type": "bool"}],
    }
    tree = {"icdgen": 1, "node": {"name": "device"}, "messages": [message]}
    manual = content.manual({"device": tree}, {"device": "Device"})
    assert differences_after_import(manual, "booktabs", tmp_path / "manual.pdf") == []


def test_the_same_manual_gives_the_same_icd_however_many_processes_read_it(tmp_path):
    manual = content.manual(content.shipped("common"), TITLES)
    LAYOUTS["ruled"](manual, tmp_path / "manual.pdf")
    first, two = (
        imported(tmp_path / "manual.pdf", jobs=1),
        imported(tmp_path / "manual.pdf", jobs=2),
    )
    assert first[1] == two[1]
    assert first[0].import_findings == two[0].import_findings


def test_one_job_starts_no_process_on_systems_that_do_not_count_usable_processors(
    tmp_path, monkeypatch
):
    manual = content.manual(content.shipped("common"), TITLES)
    LAYOUTS["ruled"](manual, tmp_path / "manual.pdf")
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    monkeypatch.setattr(pdf, "FEW", 0)
    monkeypatch.setattr(pdf, "get_context", lambda: pytest.fail("a process began"))
    assert imported(tmp_path / "manual.pdf", jobs=1)[1]


def test_pages_in_the_icd_are_those_on_which_the_tables_begin(tmp_path):
    import pdfplumber

    manual = content.manual(content.shipped("common"), TITLES)
    LAYOUTS["ruled"](manual, tmp_path / "manual.pdf")
    _, trees = imported(tmp_path / "manual.pdf")
    with pdfplumber.open(tmp_path / "manual.pdf") as file:
        for message in random.Random(7).sample(trees["common"]["messages"], 8):
            source = message["source"]
            assert (
                f"Table {source['table']}: {message['name']}"
                in file.pages[source["page"] - 1].extract_text()
            )
