"""icdgen writes safely into a folder of the user."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path, PurePosixPath

import pytest

from icdgen.errors import UserError
from icdgen.generation import manifest, write


def files(**named: str):
    return [
        (PurePosixPath(name.replace("__", "/").replace("_", ".")), text)
        for name, text in named.items()
    ]


def generate(out, **named: str) -> write.WritePlan:
    plan = write.plan(out, "c", files(**named))
    write.apply(plan)
    return plan


def test_a_second_run_writes_no_file(tmp_path):
    generate(tmp_path, a_h="one\n", sub__b_h="two\n")
    before = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")}
    plan = generate(tmp_path, a_h="one\n", sub__b_h="two\n")
    assert not plan.changes
    assert {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*")} == before


def test_only_files_whose_content_changes_are_written(tmp_path):
    generate(tmp_path, a_h="one\n", b_h="two\n")
    old = (tmp_path / "a.h").stat().st_mtime_ns
    plan = generate(tmp_path, a_h="one\n", b_h="three\n")
    assert plan.write == ["b.h"] and plan.changes
    assert (tmp_path / "a.h").stat().st_mtime_ns == old
    assert (tmp_path / "b.h").read_text() == "three\n"


def test_a_file_that_is_no_longer_generated_is_removed_with_its_empty_folder(tmp_path):
    generate(tmp_path, a_h="one\n", sub__b_h="two\n")
    assert generate(tmp_path, a_h="one\n").changes
    assert not (tmp_path / "sub").exists()


def test_a_stale_file_that_was_edited_is_kept_and_named(tmp_path):
    generate(tmp_path, a_h="one\n", b_h="two\n")
    (tmp_path / "b.h").write_text("mine now\n")
    plan = generate(tmp_path, a_h="one\n")
    assert plan.edited == ["b.h"]
    assert (tmp_path / "b.h").read_text() == "mine now\n"


@pytest.mark.parametrize("content", ["by hand", ""])
def test_files_of_others_are_never_touched(tmp_path, content):
    (tmp_path / "notes.txt").write_text("keep")
    (tmp_path / "a.h").write_text(content)
    with pytest.raises(UserError, match=r"a\.h was not written by icdgen"):
        generate(tmp_path, a_h="one\n")
    assert (tmp_path / "a.h").read_text() == content
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.h", "notes.txt"]


def test_a_file_of_the_same_content_may_be_there_already(tmp_path):
    (tmp_path / "a.h").write_text("one\n")
    generate(tmp_path, a_h="one\n")
    assert manifest.read(tmp_path, "c").keys() == {"a.h"}


def test_two_languages_in_one_folder_do_not_remove_each_others_files(tmp_path):
    generate(tmp_path, a_h="one\n")
    write.apply(write.plan(tmp_path, "python", files(a_py="two\n")))
    generate(tmp_path, a_h="one\n")
    assert (tmp_path / "a.py").exists()


def test_outputs_that_differ_only_in_case_are_refused(tmp_path):
    with pytest.raises(UserError, match="would share the file name"):
        write.plan(tmp_path, "c", files(Foo_h="1", foo_h="2"))


def test_a_manifest_cannot_make_us_remove_files_outside(tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("x")
    out = tmp_path / "out"
    out.mkdir()
    manifest.path(out, "c").write_text(
        manifest.text({"../victim": manifest.digest(b"x")})
    )
    generate(out, a_h="one\n")
    assert victim.exists()


def test_a_broken_manifest_is_no_manifest(tmp_path):
    manifest.path(tmp_path, "c").write_text("{]")
    generate(tmp_path, a_h="one\n")
    assert (tmp_path / "a.h").exists()


def test_an_interrupted_run_leaves_complete_files_and_the_next_run_finishes(
    tmp_path, monkeypatch
):
    generate(tmp_path, a_h="old\n", b_h="old\n")
    real, count = os.replace, [0]

    def breaks(source, target):
        count[0] += 1
        if count[0] == 2:
            raise KeyboardInterrupt
        real(source, target)

    monkeypatch.setattr(os, "replace", breaks)
    with pytest.raises(KeyboardInterrupt):
        generate(tmp_path, a_h="new\n", b_h="new\n")
    monkeypatch.undo()
    assert {(tmp_path / n).read_text() for n in ("a.h", "b.h")} == {"old\n", "new\n"}
    assert not [
        p
        for p in tmp_path.iterdir()
        if p.name.startswith(".icdgen-") and p.suffix != ".json"
    ]
    generate(tmp_path, a_h="newer\n", b_h="newer\n")
    assert (tmp_path / "b.h").read_text() == "newer\n"


def test_a_first_run_that_is_interrupted_may_be_repeated_with_other_content(
    tmp_path, monkeypatch
):
    real, count = os.replace, [0]

    def breaks(source, target):
        count[0] += 1
        if count[0] == 3:
            raise KeyboardInterrupt
        real(source, target)

    monkeypatch.setattr(os, "replace", breaks)
    with pytest.raises(KeyboardInterrupt):
        generate(tmp_path, a_h="1\n", b_h="1\n")
    monkeypatch.undo()
    generate(tmp_path, a_h="2\n", b_h="2\n")
    assert (tmp_path / "a.h").read_text() == "2\n"


@pytest.mark.parametrize("step", range(8))
def test_a_run_repairs_the_output_of_a_killed_run(tmp_path, monkeypatch, step):
    generate(tmp_path, a_h="old\n", b_h="old\n", c_h="old\n")
    count = [0]

    def counted(function):
        def call(*arguments, **options):
            count[0] += 1
            if count[0] == step + 1:
                raise KeyboardInterrupt
            return function(*arguments, **options)

        return call

    monkeypatch.setattr(os, "replace", counted(os.replace))
    monkeypatch.setattr(Path, "unlink", counted(Path.unlink))
    with suppress(KeyboardInterrupt):
        generate(tmp_path, a_h="new\n", d_h="new\n")
    monkeypatch.undo()
    generate(tmp_path, a_h="new\n", d_h="new\n")
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"a.h", "d.h", manifest.path(tmp_path, "c").name}
    assert set(manifest.read(tmp_path, "c")) == {"a.h", "d.h"}


def test_a_folder_that_cannot_be_written_is_a_clear_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError):
        generate(tmp_path / "file", a_h="one\n")


def test_a_manifest_with_names_that_are_none_is_no_obstacle(tmp_path):
    (tmp_path / "folder").mkdir()
    manifest.path(tmp_path, "c").write_text(
        manifest.text({"a\0b": "", "folder": "", ".": ""})
    )
    generate(tmp_path, a_h="one\n")
    assert (tmp_path / "folder").is_dir() and (tmp_path / "a.h").exists()
    manifest.path(tmp_path, "c").write_text("[" * 100_000)
    generate(tmp_path, a_h="one\n")
