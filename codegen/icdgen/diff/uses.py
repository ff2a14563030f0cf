"""Uses of changed names in the user's sources, for ``icdgen diff --uses``.

`uses` splits C, Python and Rust sources into tokens, without a parser for the language,
and compares the identifiers with the old generated names of the changes.
"""

from __future__ import annotations

import os
import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from pathlib import Path

from icdgen.diff.change import Change
from icdgen.diff.compare import Comparison
from icdgen.diff.generated import Generated, Name
from icdgen.diff.pairs import EnumPair, MessagePair, Pair
from icdgen.errors import UserError
from icdgen.frozen import NamedTuple

SUFFIXES = {
    **dict.fromkeys(
        (".c", ".h", ".cc", ".cpp", ".cxx", ".hh", ".hpp", ".hxx", ".inc", ".ino"), "c"
    ),
    **dict.fromkeys((".py", ".pyi"), "python"),
    ".rs": "rust",
}
# At the beginning of a generated file, which is not searched
MARK = "enerated by icdgen"
_HEAD = 400
_MOST = 8_000_000  # bytes of a source file that are searched
_SKIPPED = frozenset(
    (".git", ".hg", ".svn", "node_modules", "__pycache__", ".venv", "target")
)

_NAME = r"(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
# A character such as '"' begins no string. A lifetime of Rust, such as 'a, is none.
_C_LIKE = re.compile(
    rf"""//[^\n]*|/\*.*?(?:\*/|\Z)|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])'|{_NAME}""",
    re.DOTALL,
)
_TEXT = r"""(?:\"{3}(?:\\.|[^\\])*?(?:\"{3}|\Z)|'{3}(?:\\.|[^\\])*?(?:'{3}|\Z)|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')"""
_PYTHON = re.compile(
    rf"#[^\n]*|(?P<format>[rR]?[fF][rR]?{_TEXT})|[rbuRBU]{{0,2}}{_TEXT}|{_NAME}",
    re.DOTALL,
)
_FORMATTED = re.compile(r"(?<!\{)\{(?!\{)[^{}]*")  # expressions of an f-string
_INNER = re.compile(_NAME)
_LEXERS = {"c": _C_LIKE, "rust": _C_LIKE, "python": _PYTHON}


class NameUse(NamedTuple):
    """Use of a generated name in a source of the user, with the changes of that name."""

    file: str
    line: int
    column: int
    name: str
    text: str  # source line
    changes: tuple[Change, ...]

    @property
    def codes(self) -> list[str]:
        """Codes of the changes, without duplicates."""
        return list(dict.fromkeys(change.code for change in self.changes))

    @property
    def messages(self) -> list[str]:
        """Messages of the changes, without duplicates."""
        return list(dict.fromkeys(change.message for change in self.changes))


# Name -> stem that must be mentioned too -> changes
_ChangesByName = dict[str, dict[str, list[Change]]]


def uses(
    comparison: Comparison, changes: Iterable[Change], paths: Iterable[Path]
) -> list[NameUse]:
    """Return all uses of changed names, by file and line.

    Comments and strings are ignored. Raises `UserError`.
    """
    changed_names = _changed_names(comparison, changes)
    results: list[NameUse] = []
    for path in dict.fromkeys(file for top in paths for file in _sources(top)):
        language = SUFFIXES[path.suffix.lower()]
        if changed_names[language]:
            results += _in_file(path, language, changed_names[language])
    return results


def _changed_names(
    comparison: Comparison, changes: Iterable[Change]
) -> dict[str, _ChangesByName]:
    """Return the changed names by language.

    Changes of the text layer affect no sources.
    """
    result: dict[str, _ChangesByName] = {language: {} for language in _LEXERS}
    for change in changes:
        if not change.breaks:
            continue
        for name in _names(change, comparison.context.generated):
            result[name.language].setdefault(name.text, {}).setdefault(
                name.stem, []
            ).append(change)
    return result


def _names(change: Change, generated: Generated) -> Iterator[Name]:
    pair: Pair = change.pair
    yield from generated.old(pair)
    if isinstance(pair, EnumPair | MessagePair) and change.code in (
        "DIF101",
        "DIF301",
        "DIF303",
        "DIF306",
        "DIF310",
    ):
        for part in pair.parts:
            yield from (name for name in generated.old(part) if not name.stem)


def _sources(top: Path) -> Iterator[Path]:
    if os.path.isfile(top):
        if top.suffix.lower() not in SUFFIXES:
            raise UserError(
                f"{top} is no C, Python or Rust source",
                f"known are {', '.join(SUFFIXES)}",
            )
        yield top
        return
    if not os.path.isdir(top):
        raise UserError(f"there is no {top}", "give --uses a folder, or a source file")
    for folder, folders, files in os.walk(top):
        # Assignment to the slice makes `os.walk` skip the other folders.
        folders[:] = sorted(name for name in folders if name not in _SKIPPED)
        yield from (
            Path(folder, name)
            for name in sorted(files)
            if Path(name).suffix.lower() in SUFFIXES
        )


def _in_file(
    path: Path, language: str, changed_names: _ChangesByName
) -> Iterator[NameUse]:
    try:
        with open(path, "rb") as file:
            text = file.read(_MOST).decode("utf-8", "replace")
    except OSError as error:
        raise UserError(
            f"cannot read {path}: {error.strerror}", "make it readable, or leave it out"
        ) from None
    # Generated code is regenerated, so its uses are not the user's concern.
    if MARK in text[:_HEAD]:
        return
    tokens = list(_tokens(text, _LEXERS[language]))
    mentioned = {name for name, _ in tokens}
    starts = [0, *(match.end() for match in re.finditer("\n", text))]
    for name, start in tokens:
        changes: list[Change] = []
        for stem, changes_of_name in changed_names.get(name, {}).items():
            if not stem or _mentions(language, mentioned, stem):
                changes += changes_of_name
        if changes:
            number = bisect_right(starts, start)
            line = text[starts[number - 1] :].split("\n", 1)[0].rstrip("\r")
            yield NameUse(
                str(path),
                number,
                start - starts[number - 1] + 1,
                name,
                line,
                tuple(dict.fromkeys(changes)),
            )


def _tokens(text: str, lexer: re.Pattern[str]) -> Iterator[tuple[str, int]]:
    """Yield each name in the code with its position."""
    for match in lexer.finditer(text):
        if match["name"]:
            yield match["name"], match.start("name")
        elif match.groupdict().get("format"):
            for part in _FORMATTED.finditer(text, match.start(), match.end()):
                yield from (
                    (m["name"], m.start())
                    for m in _INNER.finditer(text, part.start(), part.end())
                )


def _mentions(language: str, mentioned: set[str], stem: str) -> bool:
    """Return whether the source mentions the type of a member."""
    # C names have the type as prefix, in any case (`demo_status_t`,
    # `DEMO_STATUS_LENGTH`).
    if language != "c":
        return stem in mentioned
    return any(
        name == stem or name.lower().startswith(f"{stem}_") for name in mentioned
    )
