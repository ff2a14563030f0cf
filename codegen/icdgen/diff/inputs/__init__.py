"""What a user names as old and new -> ICDs: files, folders, git revisions, output of ``icdgen show``."""

from __future__ import annotations

import os
from pathlib import Path

from icdgen.diff.inputs.git import Git, Spec
from icdgen.diff.inputs.side import Side
from icdgen.errors import UserError

STDIN = "-"


def sides(arguments: list[str], usual: list[Path], unchecked: bool = False) -> tuple[Side, Side]:
    """Old and new, loaded. ``usual`` are the ICDs that are meant where only a revision is given. Raises `UserError`."""
    old, new = _resolve(arguments, usual)
    return _load(old, unchecked), _load(new, unchecked)


def one_side(word: str, usual: list[Path]) -> Side:
    """A single side, loaded: a file, a folder, a git revision, or the output of ``icdgen show``. Raises `UserError`."""
    return _load(_one(Git(), word, usual), unchecked=False)


def _resolve(arguments: list[str], usual: list[Path]) -> tuple[object, object]:
    """Two of: paths, a git spec, ``-``."""
    git = Git()
    first = arguments[0] if arguments else ""
    span = None if not first or os.path.exists(first) else git.span(first)
    if span is not None:
        paths = git.inside(map(Path, arguments[1:])) if arguments[1:] else git.usual(usual)
        return tuple(Spec(revision, paths, revision, top=git.top) for revision in span)
    if len(arguments) == 1:
        old = _one(git, first, usual)
        if isinstance(old, Spec):
            return old, [git.outside(path) for path in old.paths]
        raise UserError("name what to compare with", "`icdgen diff OLD NEW`, or a git revision such as HEAD~1")
    if len(arguments) > 2:
        raise UserError(
            f"{len(arguments)} arguments are given, OLD and NEW are enough", "name folders for several files"
        )
    old, new = arguments
    paths = [[Path(word)] if os.path.exists(word) else None for word in (new, old)]
    return tuple(_one(git, word, other or usual) for word, other in zip((old, new), paths, strict=True))


def _one(git: Git, word: str, usual: list[Path]) -> object:
    if word == STDIN:
        return word
    if os.path.exists(word):
        return [Path(word)]
    spec = git.spec(word, usual)
    if spec is not None:
        return spec
    help = "name a file, a folder, a git revision, or REVISION:PATH"
    raise UserError(f"there is no {word}, neither as a file nor as a git revision", help)


def _load(what: object, unchecked: bool) -> Side:
    from icdgen.diff.inputs import shown, side

    if isinstance(what, Spec):
        return side.from_git(what, unchecked)
    if what == STDIN:
        return shown.from_stdin()
    paths = what
    if len(paths) == 1 and shown.is_shown(paths[0]):
        return shown.from_file(paths[0])
    return side.from_paths(paths, unchecked)
