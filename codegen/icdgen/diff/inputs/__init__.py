"""Inputs of a comparison: files, folders, git revisions, and output of ``icdgen show``.

`sides` decides what each argument of ``icdgen diff`` names and loads both sides:
``git`` extracts revisions, ``side`` loads files, ``shown`` reads JSON.
"""

from __future__ import annotations

import os
from pathlib import Path

from icdgen.diff.inputs.git import Git, Spec
from icdgen.diff.inputs.side import ComparisonSide
from icdgen.errors import UserError

STDIN = "-"
Input = Spec | list[Path] | str  # a git revision, paths, or `STDIN`


def sides(
    arguments: list[str], usual: list[Path], unchecked: bool = False
) -> tuple[ComparisonSide, ComparisonSide]:
    """Return the loaded old and new side.

    ``usual``: default ICDs for an argument that is only a revision. Raises `UserError`.
    """
    old, new = _resolve(arguments, usual)
    return _load(old, unchecked), _load(new, unchecked)


def one_side(word: str, usual: list[Path]) -> ComparisonSide:
    """Return a single loaded side: a file, a folder, a git revision, or output of
    ``icdgen show``.

    Raises `UserError`.
    """
    return _load(_input_of(Git(), word, usual), unchecked=False)


def _resolve(arguments: list[str], usual: list[Path]) -> tuple[Input, Input]:
    git = Git()
    first = arguments[0] if arguments else ""
    # An existing file has precedence over a git range of the same name.
    span = None if not first or os.path.exists(first) else git.span(first)
    if span is not None:
        paths = (
            git.inside(map(Path, arguments[1:])) if arguments[1:] else git.usual(usual)
        )
        old, new = (Spec(revision, paths, revision, top=git.top) for revision in span)
        return old, new
    if len(arguments) == 1:
        single_input = _input_of(git, first, usual)
        if isinstance(single_input, Spec):
            return single_input, [git.outside(path) for path in single_input.paths]
        raise UserError(
            "name what to compare with",
            "`icdgen diff OLD NEW`, or a git revision such as HEAD~1",
        )
    if len(arguments) > 2:
        text = f"{len(arguments)} arguments are given, OLD and NEW are enough"
        raise UserError(text, "name folders for several files")
    first, second = arguments
    return _input_of(git, first, _default_paths(second, usual)), _input_of(
        git, second, _default_paths(first, usual)
    )


def _default_paths(other: str, usual: list[Path]) -> list[Path]:
    """Return the ICDs to read from a revision: the paths of the other side, if it names
    paths.
    """
    return [Path(other)] if os.path.exists(other) else usual


def _input_of(git: Git, word: str, usual: list[Path]) -> Input:
    if word == STDIN:
        return word
    if os.path.exists(word):
        return [Path(word)]
    spec = git.spec(word, usual)
    if spec is not None:
        return spec
    help = "name a file, a folder, a git revision, or REVISION:PATH"
    raise UserError(
        f"there is no {word}, neither as a file nor as a git revision", help
    )


def _load(what: Input, unchecked: bool) -> ComparisonSide:
    from icdgen.diff.inputs import shown, side

    if isinstance(what, Spec):
        return side.from_git(what, unchecked)
    if isinstance(what, str):
        return shown.from_stdin()
    if len(what) == 1 and shown.is_shown(what[0]):
        return shown.from_file(what[0])
    return side.from_paths(what, unchecked)
