"""Manifest of the files that icdgen wrote: its name, its text, and damaged manifests."""

from __future__ import annotations

import pytest

from icdgen.generation import manifest


def test_a_manifest_is_read_back_and_lists_its_files_in_order(tmp_path):
    files = {"b.h": manifest.digest(b"two"), "a/c.h": manifest.digest(b"")}
    path = manifest.path(tmp_path, "c")
    assert path == tmp_path / ".icdgen-c.json"
    path.write_text(manifest.text(files))
    empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
    assert path.read_text() == (
        '{\n "generator": "icdgen",\n "files": {\n'
        f'  "a/c.h": "{empty}",\n'
        f'  "b.h": "{files["b.h"]}"\n }}\n}}\n'
    )
    assert manifest.read(tmp_path, "c") == files
    assert manifest.read(tmp_path, "rust") == {}, "each language has its own"


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "null", '{"generator": "icdgen"}', '{"files": ["a.h"]}', '{"files": null}', "[" * 100_000],
)  # fmt: skip
def test_a_damaged_manifest_lists_no_file(tmp_path, text):
    manifest.path(tmp_path, "c").write_text(text)
    assert manifest.read(tmp_path, "c") == {}


def test_a_manifest_that_is_not_utf8_lists_no_file(tmp_path):
    manifest.path(tmp_path, "c").write_bytes(b'{"files": {"\xff": "0"}}')
    assert manifest.read(tmp_path, "c") == {}


def test_only_files_in_the_folder_are_read(tmp_path):
    inside = ["a.h", "a/b.h", "..a/b..h", "a/./b.h"]
    outside = ["", ".", "..", "../a.h", "a/../b.h", "a/..", "/a.h", "a\0b.h"]
    text = manifest.text(dict.fromkeys(inside + outside, "0"))
    manifest.path(tmp_path, "c").write_text(text)
    assert sorted(manifest.read(tmp_path, "c")) == sorted(inside)
