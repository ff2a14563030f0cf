"""Files that are loaded with an ICD: includes, overlays, folders, unsaved texts."""

from __future__ import annotations

import hashlib
import os
from contextlib import chdir
from pathlib import Path

import pytest

from icdgen import fingerprints
from icdgen.icd import folders
from icdgen.icd.load import load

HEAD = "icdgen: 1\nnode: {{name: {}, title: Demo, byte_order: little, bit_order: lsb0}}\n"  # fmt: skip
PING = "messages: [{name: Ping, id: 1, kind: telecommand, length: 0}]\n"
OVERLAY = (
    "errata: 1\nnode: top\nentries: [{id: TOP-001, title: A title, why: It is wrong., evidence: e, "
    "confidence: certain, where: {message: Ping}, printed: {id: 1}, held: {id: 2}}]\n"
)


@pytest.fixture
def folder(tmp_path):
    with chdir(tmp_path):
        yield tmp_path


def write(**texts: str) -> None:
    for name, text in texts.items():
        path = Path(name.replace("__", "/")).with_suffix(".yaml")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def icd(name: str, *includes: str) -> str:
    return HEAD.format(name) + f"include: [{', '.join(includes)}]\n" * bool(includes)


def sha(*parts: bytes) -> str:
    return hashlib.sha256(b"".join(parts)).hexdigest()


def rows(loaded) -> list[tuple[str, str, str]]:
    return [(each.code, str(each.place), each.message) for each in loaded.findings]


def test_a_node_follows_its_includes_and_has_a_digest_over_all_files(folder):
    write(
        top=icd("top", "parts/low.yaml", "mid.yaml") + PING,
        mid=icd("mid", "parts/low.yaml"),
        parts__low=icd("low"),
        errata__top="errata: 1\nnode: top\nentries: []\n",
    )
    loaded = load([Path("top.yaml")])
    assert [node.name for node in loaded.icd.nodes] == ["low", "mid", "top"]
    low, mid, top = loaded.icd.nodes
    assert (low.includes, mid.includes, top.includes) == ((), ("low",), ("low", "mid"))
    data = {name: Path(name).read_bytes() for name in ("top.yaml", "mid.yaml", "parts/low.yaml", "errata/top.yaml")}  # fmt: skip
    low_digest = sha(data["parts/low.yaml"])
    mid_digest = sha(data["mid.yaml"], low_digest.encode())
    assert (low.digest, mid.digest) == (low_digest, mid_digest)
    assert top.digest == sha(
        data["top.yaml"], data["errata/top.yaml"], low_digest.encode(), mid_digest.encode()
    )  # fmt: skip
    assert loaded.inputs == {
        **{Path(name): sha(text) for name, text in data.items()},
        Path("errata/mid.yaml"): fingerprints.ABSENT,
        Path("parts/errata/low.yaml"): fingerprints.ABSENT,
    }
    assert loaded.texts == {name: text.decode() for name, text in data.items()}


@pytest.mark.parametrize(
    ("include", "message", "help"),
    [
        ("../a.yaml", "`../a.yaml` is outside the folder of this file",
         "move it to the folder of this file or below"),
        ("none.yaml", "there is no file `none.yaml` beside this one", "check the name"),
        ("parts", "there is no file `parts` beside this one", "check the name"),
        ("top.yaml", "files include each other in a circle: top.yaml -> top.yaml",
         "remove one `include`"),
        ("loop.yaml", None, None),
    ],
)  # fmt: skip
def test_an_include_is_another_file_of_the_folder(folder, include, message, help):
    Path("parts").mkdir()
    write(
        top=icd("top", "good.yaml", include),
        good=icd("good"),
        loop=icd("loop", "inner.yaml"),
        inner=icd("inner", "loop.yaml"),
    )
    loaded = load([Path("top.yaml")])
    (finding,) = loaded.findings
    if message is None:
        message, help = (
            "files include each other in a circle: loop.yaml -> inner.yaml -> loop.yaml",
            "remove one `include`",
        )
        assert str(finding.place) == "inner.yaml:3:11"
    else:
        assert str(finding.place) == "top.yaml:3:22"
    assert (finding.code, finding.message, finding.help) == ("ICD004", message, help)
    assert {"good", "top"} <= {node.name for node in loaded.icd.nodes}


def test_a_file_is_loaded_once_by_whatever_path(folder):
    write(top=icd("top", "low.yaml"), low=icd("low"))
    os.symlink("low.yaml", "link.yaml")
    paths = [Path("link.yaml"), Path("top.yaml"), folder / "low.yaml"]
    loaded = load(paths)
    assert [node.name for node in loaded.icd.nodes] == ["low", "top"]
    assert loaded.inputs[Path("link.yaml")] == loaded.inputs[folder / "low.yaml"]
    assert loaded.inputs[Path("low.yaml")] == sha(Path("low.yaml").read_bytes())


def test_unsaved_texts_replace_files_and_can_be_included(folder):
    write(top=icd("top") + PING)
    unsaved = {
        folder / "top.yaml": (icd("top", "new.yaml") + PING).encode(),
        folder / "new.yaml": icd("new").encode(),
    }
    loaded = load([Path("top.yaml")], unsaved=unsaved)
    assert [node.name for node in loaded.icd.nodes] == ["new", "top"]
    assert not loaded.findings
    assert loaded.inputs[Path("top.yaml")] == sha(unsaved[folder / "top.yaml"])


def test_an_overlay_changes_values_and_is_checked_against_the_schema(folder):
    write(top=icd("top") + PING, errata__top=OVERLAY)
    loaded = load([Path("top.yaml")])
    assert [message.id for message in loaded.icd.nodes[0].messages] == [2]
    write(errata__top=OVERLAY.replace("held: {id: 2}", "held: {id: two}"))
    loaded = load([Path("top.yaml")])
    assert [row[:2] for row in rows(loaded)] == [("ICD010", "errata/top.yaml:3:147")]
    assert loaded.icd.nodes[0].messages == ()


def test_an_overlay_that_is_named_as_an_icd_is_reported_alone(folder):
    write(top=OVERLAY)
    loaded = load([Path("top.yaml")])
    assert rows(loaded) == [
        ("ICD010", "top.yaml:1:1", "this is an errata overlay, not an ICD")
    ]
    assert loaded.icd.nodes == () and not loaded.ok


def test_rules_are_skipped_if_a_file_cannot_be_read(folder):
    wrong = "messages: [{name: Ping, id: 300, kind: telecommand, length: 0}]\n"
    write(top=icd("top", "low.yaml") + wrong, low="icdgen: [\n")
    loaded = load([Path("top.yaml")])
    assert {row[0] for row in rows(loaded)} == {"ICD001"}
    assert [node.name for node in loaded.icd.nodes] == ["top"]
    write(low=icd("low"))
    assert [row[1] for row in rows(load([Path("top.yaml")]))] == ["top.yaml:4:29"]
    assert rows(load([Path("top.yaml")], check=False)) == []
    assert load([Path("none.yaml")]).inputs == {Path("none.yaml"): fingerprints.UNKNOWN}


@pytest.mark.parametrize(
    ("files", "message", "help"),
    [
        ([], "the folder has no ICD: no file *.yaml in it, or in a folder below",
         "name another folder, or a file"),
        (["parts__a"], "the folder has no ICD: no file *.yaml has the key `icdgen`, `a.yaml` for instance",
         "name another folder or the file of an ICD, which begins with `icdgen: 1`"),
    ],
)  # fmt: skip
def test_a_folder_without_an_icd_is_reported(folder, files, message, help):
    Path("set").mkdir()
    write(**{f"set__{name}": "key: value\n" for name in files})
    loaded = load([Path("set")])
    (finding,) = loaded.findings
    assert (finding.code, str(finding.place)) == ("ICD001", "set:1:1")
    assert (finding.message, finding.help) == (message, help)
    assert not loaded.ok
    assert set(loaded.inputs) == {Path("set"), *(Path("set/parts"), Path("set/parts/a.yaml")) * len(files)}  # fmt: skip


def test_all_folders_and_files_that_were_examined_are_inputs(folder, monkeypatch):
    write(set__a=icd("a"), set__sub__b=icd("b"), set__errors=OVERLAY, set__sub__c="x: 1\n")  # fmt: skip
    loaded = load([Path("set")])
    assert [node.name for node in loaded.icd.nodes] == ["a", "b"]
    names = "set set/sub set/a.yaml set/sub/b.yaml set/errors.yaml set/sub/c.yaml set/errata/a.yaml set/sub/errata/b.yaml"
    assert set(loaded.inputs) == set(map(Path, names.split()))
    monkeypatch.setattr(folders, "MOST_FOLDERS", 1)
    (finding,) = load([Path("set")]).findings
    assert (finding.message, finding.help) == (
        "the folder has more than 1 folders below it",
        "name the folder of the ICDs",
    )


@pytest.mark.parametrize(
    ("title", "fix"),
    [("yes", '"yes"'), ("y", '"y"'), ("1_0", '"1_0"')],
)
def test_an_ambiguous_scalar_has_the_fix_for_its_type(folder, title, fix):
    write(top=icd("top").replace("Demo", title))
    (finding,) = load([Path("top.yaml")]).findings
    assert (finding.code, str(finding.place)) == ("ICD003", "top.yaml:2:26")
    assert (finding.fix.place, finding.fix.text) == (finding.place, fix)


def test_an_ambiguous_scalar_of_a_flag_is_reported_once_with_a_truth_value(folder):
    write(top=icd("top") + PING.replace("length", "repeat: yes, length"))
    (finding,) = load([Path("top.yaml")]).findings
    assert (finding.code, finding.fix.text) == ("ICD003", "true")


@pytest.mark.parametrize(
    ("keys", "overlay"),
    [("repeat: yes, ", "held: {id: 2}"), ("", "held: {id: 2, repeat: yes}")],
)
def test_an_ambiguous_scalar_is_reported_once_beside_changes_of_an_overlay(
    folder, keys, overlay
):
    text = OVERLAY.replace("held: {id: 2}", overlay)
    if "repeat" in overlay:
        text = text.replace("printed: {id: 1}", "printed: {id: 1, repeat: null}")
    write(top=icd("top") + PING.replace("length", f"{keys}length"), errata__top=text)
    (finding,) = load([Path("top.yaml")]).findings
    assert (finding.code, finding.fix.text) == ("ICD003", "true")
    assert finding.place.file == ("top.yaml" if keys else "errata/top.yaml")


def test_the_fix_of_a_value_of_an_overlay_has_the_spelling_of_the_overlay(folder):
    overlay = OVERLAY.replace("{id: 1}", "{length: 0}").replace("{id: 2}", '{length: "2"}')  # fmt: skip
    column = overlay.splitlines()[2].index('"2"')
    # The ICD has another number at the same line and column.
    write(top=icd("top") + f'{PING.rstrip():{column - 1}}#"7"\n', errata__top=overlay)
    (finding,) = load([Path("top.yaml")]).findings
    assert (finding.code, finding.fix.text) == ("ICD010", "2")
    assert finding.place == ("errata/top.yaml", 3, column + 1, 3)
