"""Files of an import: all are prepared and checked before the first is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.errors import UserError
from icdgen.icd import schema
from icdgen.import_results.targets import Target, check, prepare, write


def icd(name: str = "pump", length: int = 1) -> dict:
    node = {"name": name, "title": name, "byte_order": "little", "bit_order": "lsb0"}
    message = {"name": "Stop", "id": 1, "kind": "telecommand", "length": length}
    return {"icdgen": 1, "node": node, "messages": [message]}


def states(targets: list[Target]) -> list[tuple]:
    return [(t.path.name, t.changes, t.same, t.refused) for t in targets]


def test_new_files_have_no_changes(tmp_path):
    targets = prepare({"a": icd("a"), "b": icd("b")}, tmp_path / "out", over=False)
    assert states(targets) == [
        ("a.yaml", None, False, False),
        ("b.yaml", None, False, False),
    ]
    assert [target.path.parent for target in targets] == [tmp_path / "out"] * 2
    assert targets[0].text.startswith(schema.LINE) and targets[0].tree == icd("a")
    assert not (tmp_path / "out").exists()


def test_existing_files_are_refused_together(tmp_path):
    (tmp_path / "a.yaml").write_text("")
    (tmp_path / "c.yaml").symlink_to(tmp_path / "nowhere")
    trees = {name: icd(name) for name in "abc"}
    with pytest.raises(UserError) as caught:
        prepare(trees, tmp_path, over=False)
    assert str(caught.value) == (
        f"{tmp_path / 'a.yaml'}, {tmp_path / 'c.yaml'} already there"
    )
    assert not (tmp_path / "b.yaml").exists()


def test_an_existing_file_is_updated_and_an_equal_one_stays(tmp_path):
    write(prepare({"pump": icd()}, tmp_path, over=False))
    assert states(prepare({"pump": icd()}, tmp_path, over=True)) == [
        ("pump.yaml", [], True, False)
    ]
    (target,) = prepare({"pump": icd(length=0)}, tmp_path, over=True)
    assert (target.same, target.refused, len(target.changes or ())) == (False, False, 1)
    assert "length: 0" in target.text
    # A dry run shows the changes to a file that it may not update.
    (dry,) = prepare({"pump": icd(length=0)}, tmp_path, over=False, dry=True)
    assert (dry.changes, dry.same, dry.refused) == (target.changes, False, True)


@pytest.mark.parametrize(
    ("prepared", "message"),
    [
        (lambda path: path.write_bytes(b"\xff"), "{path} is not UTF-8"),
        (lambda path: path.mkdir(), "cannot read {path}: Is a directory"),
    ],
)
def test_an_existing_file_that_cannot_be_read_is_an_error(tmp_path, prepared, message):
    path = tmp_path / "pump.yaml"
    prepared(path)
    with pytest.raises(UserError) as caught:
        prepare({"pump": icd()}, tmp_path, over=True)
    assert str(caught.value) == message.format(path=path)


def test_files_are_checked_before_they_are_written(tmp_path):
    assert check([]) == []
    trees = {"a": icd("a", length=0), "b": icd("b", length=2)}
    targets = prepare(trees, tmp_path, over=False)
    findings = check(targets)
    assert findings and {Path(f.place.file).name for f in findings} == {"b.yaml"}
    assert list(tmp_path.iterdir()) == []


def test_files_are_written_with_their_schema(tmp_path):
    folder = tmp_path / "out"
    targets = prepare({"pump": icd()}, folder, over=False)
    write(targets)
    assert sorted(path.name for path in folder.iterdir()) == sorted(
        ["pump.yaml", schema.COPY]
    )
    assert (folder / "pump.yaml").read_text(encoding="utf-8") == targets[0].text
    assert (folder / schema.COPY).read_bytes() == schema.PATH.read_bytes()
    (folder / schema.COPY).write_text("{}")
    write(targets)
    assert (folder / schema.COPY).read_text() == "{}"


def test_a_file_without_changes_is_not_written(tmp_path):
    path = tmp_path / "pump.yaml"
    target = Target(path, f"{schema.LINE}\nnew", icd(), [], same=True)
    write([target])
    assert list(tmp_path.iterdir()) == []
    # A file that does not refer to the schema needs no copy of it.
    write([Target(path, "new", icd())])
    assert [entry.name for entry in tmp_path.iterdir()] == ["pump.yaml"]


def test_a_symbolic_link_stays_one(tmp_path):
    (tmp_path / "real.yaml").write_text("old")
    link = tmp_path / "pump.yaml"
    link.symlink_to(tmp_path / "real.yaml")
    write([Target(link, "new", icd())])
    assert link.is_symlink() and (tmp_path / "real.yaml").read_text() == "new"


def test_a_file_that_cannot_be_written_is_an_error(tmp_path):
    path = tmp_path / "pump.yaml"
    path.mkdir()
    with pytest.raises(UserError) as caught:
        write([Target(path, "new", icd())])
    assert str(caught.value).startswith(f"cannot write {path}: ")
