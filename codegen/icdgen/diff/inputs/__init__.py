"""What a user names as old and new -> ICDs: files, folders, git revisions, output of ``icdgen show``."""

from __future__ import annotations

import os
from pathlib import Path

from icdgen.diff.inputs.git import Git, Spec
from icdgen.diff.inputs.side import Side
from icdgen.errors import UserError

STDIN = "-"
Input = Spec | list[Path] | str  # a git revision, paths, or `STDIN`


def sides(arguments: list[str], usual: list[Path], unchecked: bool = False) -> tuple[Side, Side]:
    """Old and new, loaded. ``usual`` are the ICDs that are meant where only a revision is given. Raises `UserError`."""
    old, new = _resolve(arguments, usual)
    return _load(old, unchecked), _load(new, unchecked)


def one_side(word: str, usual: list[Path]) -> Side:
    """A single side, loaded: a file, a folder, a git revision, or the output of ``icdgen show``. Raises `UserError`."""
    return _load(_one(Git(), word, usual), unchecked=False)


def _resolve(arguments: list[str], usual: list[Path]) -> tuple[Input, Input]:
    git = Git()
    first = arguments[0] if arguments else ""
    span = None if not first or os.path.exists(first) else git.span(first)
    if span is not None:
        paths = git.inside(map(Path, arguments[1:])) if arguments[1:] else git.usual(usual)
        old, new = (Spec(revision, paths, revision, top=git.top) for revision in span)
        return old, new
    if len(arguments) == 1:
        one = _one(git, first, usual)
        if isinstance(one, Spec):
            return one, [git.outside(path) for path in one.paths]
        raise UserError("name what to compare with", "`icdgen diff OLD NEW`, or a git revision such as HEAD~1")
    if len(arguments) > 2:
        text = f"{len(arguments)} arguments are given, OLD and NEW are enough"
        raise UserError(text, "name folders for several files")
    first, second = arguments
    return _one(git, first, _beside(second, usual)), _one(git, second, _beside(first, usual))


def _beside(other: str, usual: list[Path]) -> list[Path]:
    """The ICDs that a revision is asked for: those of the other side, if these are paths."""
    return [Path(other)] if os.path.exists(other) else usual


def _one(git: Git, word: str, usual: list[Path]) -> Input:
    if word == STDIN:
        return word
    if os.path.exists(word):
        return [Path(word)]
    spec = git.spec(word, usual)
    if spec is not None:
        return spec
    help = "name a file, a folder, a git revision, or REVISION:PATH"
    raise UserError(f"there is no {word}, neither as a file nor as a git revision", help)


def _load(what: Input, unchecked: bool) -> Side:
    from icdgen.diff.inputs import shown, side

    if isinstance(what, Spec):
        return side.from_git(what, unchecked)
    if isinstance(what, str):
        return shown.from_stdin()
    if len(what) == 1 and shown.is_shown(what[0]):
        return shown.from_file(what[0])
    return side.from_paths(what, unchecked)
