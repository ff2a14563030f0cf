"""Revisions, ranges and paths of git, with prepared answers instead of a repository."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

import pytest

from icdgen.diff.inputs import git
from icdgen.diff.inputs.git import Git, Spec, _contents, _name
from icdgen.errors import UserError

COMMITS = {"v1": "a" * 40, "v2": "b" * 40, "HEAD": "c" * 40}
BASE = "0123456789abcdef0123456789abcdef01234567"
OBJECTS = {"v1:icd": "tree", "v1:icd/demo.yaml": "blob", "v1:": "tree"}


@pytest.fixture
def repository(tmp_path, monkeypatch) -> Path:
    """A folder for which git gives prepared answers; the current folder is in it."""
    folder = tmp_path / "repository"
    (folder / "sub").mkdir(parents=True)
    monkeypatch.chdir(folder)

    def run(*words: str, top: str = ".") -> str:
        match words:
            case ("rev-parse", "--show-toplevel"):
                return f"{folder}\n"
            case ("rev-parse", "--verify", "--quiet", "--end-of-options", revision):
                return COMMITS.get(revision.removesuffix("^{commit}"), "")
            case ("merge-base", "--end-of-options", "v1", "v2"):
                return f"{BASE}\n"
            case ("cat-file", "-t", name):
                return OBJECTS.get(name, "")
        return ""

    monkeypatch.setattr(git, "_run", run)
    return folder


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("v1..v2", ("v1", "v2")),
        ("v1..", ("v1", "HEAD")),
        ("..v2", ("HEAD", "v2")),
        ("..", ("HEAD", "HEAD")),
        ("v1...v2", (BASE[:12], "v2")),
        # Without a common ancestor, the first end remains.
        ("v2...v1", ("v2", "v1")),
        ("v1", None),
        ("icd", None),
        ("v1:../icd", None),
        ("v1..v2:icd", None),
    ],
)
def test_a_range_has_two_ends(repository, word, expected):
    assert Git().span(word) == expected


@pytest.mark.parametrize(
    ("word", "bad"),
    [("v1..v9", "v9"), ("v8..v9", "v8"), ("-x..v1", "-x"), ("../icd", "/icd")],
)
def test_the_first_unknown_end_of_a_range_is_named(repository, word, bad):
    with pytest.raises(UserError) as error:
        Git().span(word)
    assert str(error.value) == f"git knows no revision {bad}"
    assert error.value.help == "`git log --oneline` and `git tag` list them"


def test_a_revision_is_no_option_and_needs_a_repository(repository, monkeypatch):
    assert Git().commit("v1") == "a" * 40
    for revision in ("", "v9", "-v1"):
        assert Git().commit(revision) == ""
    monkeypatch.setattr(git, "_run", lambda *words, top=".": "")
    without = Git()
    assert (without.top, without.commit("v1"), without.span("v1..v2")) == ("", "", None)


@pytest.mark.parametrize(
    ("folder", "word", "path"),
    [
        (".", "v1:icd/demo.yaml", "icd/demo.yaml"),
        (".", "v1:./icd", "icd"),
        (".", "v1:", "."),
        ("icd", "v1:./demo.yaml", "icd/demo.yaml"),
        ("icd", "v1:icd/demo.yaml", "icd/demo.yaml"),
    ],
)
def test_a_path_of_a_revision_counts_from_the_top_or_with_a_dot_from_here(
    repository, monkeypatch, folder, word, path
):
    (repository / "icd").mkdir()
    monkeypatch.chdir(repository / folder)
    assert Git().spec(word, []) == Spec(
        "v1", [PurePosixPath(path)], word, str(repository)
    )


def test_a_revision_alone_has_the_usual_icds(repository):
    (repository / "icd").mkdir()
    usual = [repository / "sub" / "a.yaml", Path("b.yaml")]
    spec = Git().spec("v1", usual)
    assert spec.paths == [PurePosixPath("sub/a.yaml"), PurePosixPath("b.yaml")]
    assert (spec.revision, spec.label) == ("v1", "v1")
    assert Git().spec("v1", [Path("/elsewhere")]).paths == [PurePosixPath("icd")]
    assert Git().spec("icd", usual) is None
    (repository / "icd").rmdir()
    with pytest.raises(UserError, match="/elsewhere is not in this git repository"):
        Git().spec("v1", [Path("/elsewhere")])


@pytest.mark.parametrize(
    ("word", "text", "help"),
    [
        ("v1:none", "v1 has no none", "`git ls-tree -r v1` lists what it has"),
        (
            "v1:../icd",
            "v1:../icd: the path must lie in the repository",
            "as `git show` takes it: REVISION:icd/a.yaml",
        ),
        (
            "v1:/icd",
            "v1:/icd: the path must lie in the repository",
            "as `git show` takes it: REVISION:icd/a.yaml",
        ),
    ],
)
def test_a_path_that_a_revision_does_not_have_is_named(repository, word, text, help):
    with pytest.raises(UserError) as error:
        Git().spec(word, [])
    assert (str(error.value), error.value.help) == (text, help)


def test_paths_are_inside_or_outside_of_the_repository(repository):
    repo = Git()
    assert repo.inside([Path("."), repository / "sub"]) == [
        PurePosixPath("."),
        PurePosixPath("sub"),
    ]
    # A folder whose name begins like that of the repository is outside.
    beside = Path(f"{repository}-2")
    for path in (repository.parent, beside):
        with pytest.raises(UserError) as error:
            repo.inside([path])
        assert str(error.value) == f"{path} is not in this git repository"
        assert error.value.help == (
            "name the ICDs: REVISION:PATH, or `icds` in icdgen.toml"
        )
    assert repo.outside(PurePosixPath("icd/a.yaml")) == Path("icd/a.yaml")
    assert _name(PurePosixPath(".")) == "" and _name(PurePosixPath("a/b")) == "a/b"


BLOBS = {"1" * 40: b"one\n", "2" * 40: b"", "3" * 40: b"a\0\n\nb"}


@pytest.fixture
def objects(monkeypatch):
    """Answer `git cat-file --batch`, and return the requests."""
    requests: list[bytes] = []

    def run(words, input, capture_output, check):
        assert words == ["git", "-C", "top", "cat-file", "--batch"]
        requests.append(input)
        output = b""
        for blob in input.decode().split():
            data = BLOBS.get(blob)
            if data is None:
                output += f"{blob} missing\n".encode()
            else:
                output += f"{blob} blob {len(data)}\n".encode() + data + b"\n"
        return type("Completed", (), {"stdout": output, "stderr": b"no object\n"})

    monkeypatch.setattr(git.subprocess, "run", run)
    return requests


def test_contents_are_read_in_one_run_of_git(objects):
    blobs = [(blob, f"{blob[0]}.yaml") for blob in BLOBS]
    assert dict(_contents(blobs, "top")) == {
        f"{blob[0]}.yaml": data for blob, data in BLOBS.items()
    }
    assert len(objects) == 1
    assert list(_contents([], "top")) == [] and len(objects) == 1


def test_content_that_git_lacks_is_an_error(objects):
    with pytest.raises(UserError) as error:
        list(_contents([("9" * 40, "gone.yaml")], "top"))
    assert (str(error.value), error.value.help) == (
        "git cannot read gone.yaml",
        "no object",
    )


def test_the_yaml_files_of_the_folder_of_an_icd_are_extracted(
    objects, monkeypatch, tmp_path
):
    rows = [
        ("100644", "1", "icd/a.yaml"),
        ("100755", "2", "icd/deep/b.yaml"),
        ("120000", "3", "icd/link.yaml"),
        ("160000", "3", "icd/module.yaml"),
        ("100644", "3", "icd/notes.md"),
        ("100644", "3", "icd/with space.yaml"),
    ]
    listed = "".join(f"{mode} blob {n * 40}\t{path}\0" for mode, n, path in rows)
    calls: list[tuple[str, ...]] = []

    def run(*words: str, top: str = ".") -> str:
        calls.append(words)
        if words[0] == "cat-file":
            return {"v1:icd": "tree\n", "v1:icd/a.yaml": "blob\n"}.get(words[2], "")
        return listed

    monkeypatch.setattr(git, "_run", run)
    for path, home in (("icd/a.yaml", "icd"), ("icd", "icd")):
        folder = tmp_path / path.replace("/", "_")
        spec = Spec("v1", [PurePosixPath(path)], "", "top")
        assert spec.extract(folder) == [folder / path]
        files = {
            str(file.relative_to(folder)): file.read_bytes()
            for file in folder.rglob("*")
            if file.is_file()
        }
        assert files == {
            "icd/a.yaml": b"one\n",
            "icd/deep/b.yaml": b"",
            "icd/with space.yaml": b"a\0\n\nb",
        }
        assert calls[-1] == (
            "ls-tree",
            "-r",
            "-z",
            "--full-tree",
            "v1",
            "--",
            f"{home}/",
        )
    missing = Spec("v1", [PurePosixPath("none/x.yaml")], "", "top")
    assert missing.extract(tmp_path / "none") == []
