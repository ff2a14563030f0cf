"""A run is only skipped if it would change nothing: every input is compared with its
state when it was read.
"""

from __future__ import annotations

import os

import pytest

from icdgen import __main__, cache, fingerprints, loading, model_cache
from tests.conftest import DEMO


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Run the command with its cache; return its status and output."""
    monkeypatch.chdir(tmp_path)

    def go(*arguments: object) -> str:
        monkeypatch.setattr("sys.argv", ["icdgen", *map(str, arguments)])
        with pytest.raises(SystemExit) as exit:
            __main__.main()
        assert not exit.value.code
        return capsys.readouterr().out

    return go


def test_a_changed_template_behind_a_link_is_noticed(run, demo, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "c").symlink_to("../elsewhere")
    template = tmp_path / "elsewhere" / "node.h.j2"
    for text in ("one\n", "two\n"):
        template.write_text(text)
        run("--lang", "c", "--out", "out", "--templates", "own", demo)
        assert (tmp_path / "out" / "demo.h").read_text() == text
    template.unlink()
    run("--lang", "c", "--out", "out", "--templates", "own", demo)
    assert (tmp_path / "out" / "demo.h").read_text() != "two\n"


def test_an_included_file_whose_link_changes_is_noticed(run, tmp_path):
    head = (
        "icdgen: 1\nnode: {name: %s, title: T, byte_order: little, bit_order: lsb0}\n"
    )
    (tmp_path / "a.yaml").write_text(head % "aaa")
    (tmp_path / "b.yaml").write_text(head % "bbb")
    (tmp_path / "top.yaml").write_text(head % "top" + "include: [a.yaml, link.yaml]\n")
    link = tmp_path / "link.yaml"
    for target, outputs in (("a.yaml", {"aaa.h"}), ("b.yaml", {"aaa.h", "bbb.h"})):
        link.unlink(missing_ok=True)
        link.symlink_to(target)
        run("--lang", "c", "--out", "out", "top.yaml")
        assert {p.name for p in (tmp_path / "out").glob("*.h")} == outputs | {
            "top.h",
            "icdgen.h",
        }


def test_an_icd_that_changes_during_a_run_is_read_again(
    run, demo, tmp_path, monkeypatch
):
    """The record contains the state that was read, not the state after the run."""
    real = loading.load

    def slow(paths, **options):
        loaded = real(paths, **options)
        demo.write_text(DEMO.replace("Roll Angle", "Changed Meanwhile"))
        return loaded

    monkeypatch.setattr(loading, "load", slow)
    run("--lang", "c", "--out", "out", demo)
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    assert (
        model_cache.load_checked([demo], languages=("c",))
        .icd.nodes[0]
        .messages[0]
        .fields[0]
        .name
        == "Changed Meanwhile"
    )


def test_an_erratum_of_a_renamed_node_counts(run, demo, tmp_path):
    overlay = demo.parent / "errata" / "demo.yaml"
    overlay.parent.mkdir()
    entry = (
        "errata: 1\nnode: demo\nentries:\n  - id: X-1\n    title: %s\n    where: {section: node}\n    printed: {name: demo}\n"
        "    held: {name: other}\n    why: w\n    evidence: e\n    confidence: certain\n"
    )
    overlay.write_text(entry % "one")
    run("--lang", "c", "--out", "out", demo)
    first = (tmp_path / "out" / "other.h").read_text()
    overlay.write_text(entry % "two")
    run("--lang", "c", "--out", "out", demo)
    assert (tmp_path / "out" / "other.h").read_text() != first


def test_any_flipped_byte_of_the_cache_is_noticed(run, demo, tmp_path):
    run("--lang", "c", "--out", "out", demo)
    good = {p: p.read_bytes() for p in (tmp_path / "out").rglob("*") if p.is_file()}
    stored = [
        path
        for top, _, names in os.walk(cache.folder())
        for path in (os.path.join(top, name) for name in names)
    ]
    assert {os.path.basename(os.path.dirname(path)) for path in stored} == {
        "models",
        "runs",
    }
    for path in stored:
        with open(path, "r+b") as file:
            data = bytearray(file.read())
            data[len(data) * 2 // 3] ^= 0x55
            file.seek(0)
            file.write(data)
    for path in good:
        path.unlink()
    run("--lang", "c", "--out", "out", demo)
    assert {p: p.read_bytes() for p in good} == good


def test_an_input_that_cannot_be_read_twice_is_not_cached(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    assert fingerprints.of_path(str(tmp_path / "fifo")) == fingerprints.UNKNOWN
    cache.remember("runs", "k", b"done", {str(tmp_path / "fifo"): fingerprints.UNKNOWN})
    assert cache.recall("runs", "k") is None


def test_the_cache_does_not_grow_for_ever(monkeypatch):
    monkeypatch.setattr(cache, "MOST", 3)
    for number in range(9):
        cache.remember("runs", str(number), b"done", {})
    assert len(os.listdir(os.path.join(cache.folder(), "runs"))) == 3
    assert cache.recall("runs", "8") == b"done"
