"""Every description of a dangerous message contains its hazard."""

from __future__ import annotations

import json

import pytest

WORDS = "All files are gone."
DEVICE = f"""\
icdgen: 1
node: {{name: disk, title: Disk, byte_order: little, bit_order: lsb0}}
messages:
  - name: Erase
    id: 30
    kind: telecommand
    length: 1
    hazard: {WORDS}
    fields:
      - {{at: 0, bits: 8, name: Magic, type: uint, const: 0x5A}}
"""


@pytest.fixture
def disk(tmp_path):
    (tmp_path / "disk.yaml").write_text(DEVICE)


@pytest.mark.parametrize("language", ["c", "python", "rust", "html"])
def test_every_language_and_the_site_show_the_hazard(icdgen, tmp_path, disk, language):
    assert icdgen("--lang", language, "--out", "out", "disk.yaml").status == 0
    texts = [
        path.read_text()
        for path in (tmp_path / "out").rglob("*")
        if path.suffix in (".h", ".py", ".rs", ".html")
    ]
    assert any(WORDS in " ".join(text.split()) for text in texts)


def test_show_and_the_diff_contain_the_hazard(icdgen, tmp_path, disk):
    assert (
        f"Dangerous: {WORDS}"
        in icdgen("show", "--icd", "disk.yaml", "disk", "Erase").out
    )
    shown = icdgen("show", "--icd", "disk.yaml", "--format", "json").out
    assert json.loads(shown)["nodes"][0]["messages"][0]["hazard"] == WORDS
    (tmp_path / "shown.json").write_text(shown)
    assert "DIF" not in icdgen("diff", "shown.json", "disk.yaml").out
    (tmp_path / "disk.yaml").write_text(DEVICE.replace(f"    hazard: {WORDS}\n", ""))
    assert (
        "the hazard of `Erase` is gone" in icdgen("diff", "shown.json", "disk.yaml").out
    )


def test_the_cached_model_contains_the_hazard(icdgen, disk):
    """The second run reads the model from the cache."""
    for _ in range(2):
        assert (
            icdgen("show", "--icd", "disk.yaml", "disk", "Erase").out.count(WORDS) == 1
        )
