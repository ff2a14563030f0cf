"""The manuals of the vendor give the shipped ICDs. Skipped where the manuals are not
available.
"""

from __future__ import annotations

import pytest
import yaml

from icdgen.icd.fmt import emit
from icdgen.importer import table_files
from icdgen.importer.model import BACKGROUND, UNKNOWN
from tests.conftest import ROOT
from tests.importer.compare import differences
from tests.importer.conftest import imported


def shipped(name: str) -> dict:
    return yaml.safe_load((ROOT / "icd" / f"{name}.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("form", ["pdf", "txt"])
def test_the_manual_gives_the_shipped_vendor_layer(vendor, form):
    result, trees = imported(
        vendor / f"firmware-reference-manual-7.2.{form}", "cubeadcs"
    )
    assert {n: differences(shipped(n), trees[n]) for n in trees} == {
        "common": [],
        "bootloader": [],
        "cubeacp": [],
    }
    assert (
        len([table for table in result.survey.results if table.table.label is not None])
        == 216
    )
    assert not [table for table in result.survey.results if table.what == UNKNOWN]
    assert (
        sum(
            table.what == BACKGROUND and table.table.label is not None
            for table in result.survey.results
        )
        == 8
    )
    assert [
        import_finding.message
        for import_finding in result.import_findings
        if import_finding.severity == "error"
    ] == []
    assert result.interpretation is not None  # the rules alone read the document


@pytest.mark.parametrize("form", ["pdf", "txt"])
def test_the_addendum_and_its_tables_as_files_give_the_shipped_vendor_layer(
    vendor, form, tmp_path
):
    result, trees = imported(vendor / f"cubemag-cubewheel-addendum.{form}", "addendum")
    assert {n: differences(shipped(n), trees[n]) for n in trees} == {
        "cubemag": [],
        "cubewheel": [],
    }
    table_files.write_tables(result.tables, tmp_path / "tables", result.document)
    _, second = imported(tmp_path / "tables", "addendum")
    assert {name: emit.canonical_yaml(tree) for name, tree in second.items()} == {
        name: emit.canonical_yaml(tree) for name, tree in trees.items()
    }
