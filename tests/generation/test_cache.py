"""What is remembered must be gone as soon as anything it rests on differs."""

from __future__ import annotations

from icdgen import cache, fingerprints


def test_a_record_holds_while_its_files_are_unchanged(tmp_path):
    path = tmp_path / "a"
    path.write_text("x")
    cache.remember("runs", "k", "done", {str(path): fingerprints.of_path(str(path))})
    assert cache.holds("runs", "k") == "done"


def test_a_changed_a_removed_and_a_new_file_end_it(tmp_path):
    path, absent = tmp_path / "a", tmp_path / "errata"
    path.write_text("x")
    record = {str(p): fingerprints.of_path(str(p)) for p in (path, absent)}
    cache.remember("runs", "k", "done", record)
    path.write_text("y")
    assert cache.holds("runs", "k") is None
    path.write_text("x")
    assert cache.holds("runs", "k") == "done"
    absent.write_text("")
    assert cache.holds("runs", "k") is None
    absent.unlink()
    path.unlink()
    assert cache.holds("runs", "k") is None


def test_a_folder_counts_by_the_names_in_it(tmp_path):
    cache.remember("runs", "k", "done", {str(tmp_path): fingerprints.of_path(str(tmp_path))})
    (tmp_path / "new.yaml").write_text("")
    assert cache.holds("runs", "k") is None


def test_a_record_that_was_tampered_with_does_not_hold(tmp_path, monkeypatch):
    monkeypatch.setenv("ICDGEN_CACHE", str(tmp_path))
    cache.remember("runs", "k", "done", {})
    record = tmp_path / "runs" / "k"
    assert cache.holds("runs", "k") == "done"
    record.write_bytes(record.read_bytes().replace(b"done", b"gone"))
    assert cache.holds("runs", "k") is None


def test_the_cache_can_be_switched_off(monkeypatch):
    monkeypatch.setenv("ICDGEN_CACHE", "off")
    cache.remember("runs", "k", "done", {})
    assert cache.holds("runs", "k") is None


def test_the_tool_itself_is_part_of_every_key(monkeypatch):
    before = cache.key("run")
    monkeypatch.setattr(fingerprints, "of_tool", lambda: "another version")
    assert cache.key("run") != before


def test_a_cache_that_cannot_be_written_is_no_error(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("ICDGEN_CACHE", str(tmp_path / "file" / "below"))
    cache.remember("runs", "k", "done", {})
    assert cache.holds("runs", "k") is None
