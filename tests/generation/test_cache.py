"""A cached result is discarded as soon as any of its inputs differs."""

from __future__ import annotations

import os

import pytest

from icdgen import cache, fingerprints


def test_a_record_holds_while_its_files_are_unchanged(tmp_path):
    path = tmp_path / "a"
    path.write_text("x")
    cache.remember("runs", "k", b"done", {str(path): fingerprints.of_path(str(path))})
    assert cache.recall("runs", "k") == b"done"


def test_a_changed_a_removed_and_a_new_file_end_it(tmp_path):
    path, absent = tmp_path / "a", tmp_path / "errata"
    path.write_text("x")
    record = {str(p): fingerprints.of_path(str(p)) for p in (path, absent)}
    cache.remember("runs", "k", b"done", record)
    path.write_text("y")
    assert cache.recall("runs", "k") is None
    path.write_text("x")
    assert cache.recall("runs", "k") == b"done"
    absent.write_text("")
    assert cache.recall("runs", "k") is None
    absent.unlink()
    path.unlink()
    assert cache.recall("runs", "k") is None


def test_a_folder_counts_by_the_names_in_it(tmp_path):
    cache.remember(
        "runs", "k", b"done", {str(tmp_path): fingerprints.of_path(str(tmp_path))}
    )
    (tmp_path / "new.yaml").write_text("")
    assert cache.recall("runs", "k") is None


def test_a_record_that_was_tampered_with_does_not_hold(tmp_path, monkeypatch):
    monkeypatch.setenv("ICDGEN_CACHE", str(tmp_path))
    cache.remember("runs", "k", b"done", {})
    record = tmp_path / "runs" / "k"
    assert cache.recall("runs", "k") == b"done"
    record.write_bytes(record.read_bytes().replace(b"done", b"gone"))
    assert cache.recall("runs", "k") is None


def test_the_cache_can_be_switched_off(monkeypatch):
    monkeypatch.setenv("ICDGEN_CACHE", "off")
    cache.remember("runs", "k", b"done", {})
    assert cache.recall("runs", "k") is None


def test_the_tool_itself_is_part_of_every_key(monkeypatch):
    before = cache.key("run")
    monkeypatch.setattr(fingerprints, "of_tool", lambda: "another version")
    assert cache.key("run") != before


def test_a_cache_that_cannot_be_written_is_no_error(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("ICDGEN_CACHE", str(tmp_path / "file" / "below"))
    cache.remember("runs", "k", b"done", {})
    assert cache.recall("runs", "k") is None


@pytest.mark.parametrize(
    "name",
    [
        "templates/html/icon.svg",
        "templates/c/x.h",
        "runtime/c/deep/er.h",
        "codegen/icdgen/a.xyz",
    ],
)
def test_every_file_that_output_is_made_of_is_part_of_the_tool(
    tmp_path, monkeypatch, name
):
    monkeypatch.setattr(
        fingerprints,
        "__file__",
        str(tmp_path / "codegen" / "icdgen" / "fingerprints.py"),
    )
    (tmp_path / "codegen" / "icdgen").mkdir(parents=True)
    (tmp_path / "templates").mkdir()
    path = tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    seen = []
    for text in ("one", "two", "one"):
        path.write_text(text)
        monkeypatch.setattr(fingerprints, "_cached", [])
        seen.append(fingerprints.of_tool())
    assert seen[0] == seen[2] != seen[1]


def test_a_changed_module_of_icdgen_is_detected_as_python_does(tmp_path, monkeypatch):
    package = tmp_path / "codegen" / "icdgen"
    monkeypatch.setattr(fingerprints, "__file__", str(package / "fingerprints.py"))
    package.mkdir(parents=True)
    module = package / "module.py"
    module.write_text("one")
    (package / ".#lock.py").symlink_to("nobody@nowhere")
    digests = []
    for text, time in (("one", 1), ("two", 2), ("long", 2)):
        module.write_text(text)
        os.utime(module, ns=(time, time))
        digests.append(fingerprints._digest())
    assert len({*digests}) == 3


def test_bytecode_of_python_is_not_part_of_the_tool(tmp_path, monkeypatch):
    monkeypatch.setattr(
        fingerprints,
        "__file__",
        str(tmp_path / "codegen" / "icdgen" / "fingerprints.py"),
    )
    (tmp_path / "codegen" / "icdgen").mkdir(parents=True)
    before = fingerprints._digest()
    (tmp_path / "codegen" / "icdgen" / "__pycache__").mkdir()
    (tmp_path / "codegen" / "icdgen" / "__pycache__" / "a.pyc").write_text("")
    assert fingerprints._digest() == before
