"""Each step of the tutorial gives the result that it shows."""

from __future__ import annotations

import re
import shutil
import subprocess

from tests import documents
from tests.conftest import ROOT
from tests.importer.manuals import zephyr
from tests.importer.test_command import icdgen

PAGE = (ROOT / "docs" / "guides" / "tutorial-manual.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return documents.blocks(PAGE, language)


def test_every_step_of_the_tutorial_gives_what_it_shows(tmp_path):
    zephyr.draw(tmp_path / "zephyr.pdf")
    shutil.copy(ROOT / "docs" / "guides" / "tutorial-manual" / "zephyr.yaml", tmp_path)
    (tmp_path / "tank.c").write_text(blocks("c")[0], encoding="utf-8")
    for block in blocks("console"):
        for step in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, _, shown = step.partition("\n")
            program, *arguments = command.split()
            if program == "icdgen":
                result = icdgen(*arguments, cwd=tmp_path)
            else:
                result = subprocess.run(
                    [program, *arguments], cwd=tmp_path, capture_output=True, text=True
                )
            got = (result.stdout + result.stderr).strip()
            assert got == shown.strip() or not shown.strip(), command
            assert result.returncode in (0, 1), got


def test_the_profile_in_the_tutorial_is_the_one_beside_it():
    text = (ROOT / "docs" / "guides" / "tutorial-manual" / "zephyr.yaml").read_text(
        encoding="utf-8"
    )
    assert blocks("yaml")[0].strip() in text


def test_the_excerpt_of_the_icd_is_what_the_import_writes(tmp_path):
    zephyr.draw(tmp_path / "zephyr.pdf")
    profile = ROOT / "docs" / "guides" / "tutorial-manual" / "zephyr.yaml"
    assert (
        icdgen("import", "zephyr.pdf", "--profile", profile, cwd=tmp_path).returncode
        == 0
    )
    assert blocks("yaml")[1] in (tmp_path / "icd" / "zephyr.yaml").read_text(
        encoding="utf-8"
    )
