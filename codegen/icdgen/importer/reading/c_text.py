"""Preparation of a C file for the parser.

It extracts comments by line, constants, packing, and the declarations of types.
"""

from __future__ import annotations

import re
from typing import Any

from icdgen.importer.words import plain

_PACKED = r"(?:__attribute__\s*\(\(\s*(?:__)?packed(?:__)?\s*\)\)|\b__packed\b|\b__PACKED\b|\bPACKED\b)"
_BEGINS = re.compile(
    rf"\b(?:typedef\s+)?(?:{_PACKED}\s*)?(?:struct|enum|union)\b[^;{{}}()=]*(?:{_PACKED})?[^;{{}}()=]*\{{"
)
_TYPEDEF = re.compile(r"\btypedef\s+[\w\s]+?\s\w+\s*;")
# Strings and characters match, too, so that `//` in them begins no comment.
_COMMENT = re.compile(
    r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S
)
_DEFINE = re.compile(
    r"^[ \t]*#[ \t]*define[ \t]+(\w+)[ \t]+\(?[ \t]*(0[xX][0-9a-fA-F]+|[0-9]+)[uUlL]*[ \t]*\)?[ \t]*$",
    re.M,
)
_DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\.|\\\n)*", re.M)
_PRAGMA = re.compile(
    r"#\s*pragma\s+pack\s*\(\s*(?:(push)\s*,?\s*)?([0-9]+)?\s*(pop)?\s*\)"
)


class CText:
    """A text in C with its comments, constants and packing taken out; the lines keep
    their numbers.
    """

    def __init__(self, text: str) -> None:
        self.comments: dict[int, str] = {}  # line on which a comment ends -> its text
        self.alone: set[int] = set()  # of these, those without code in front of them
        code = _COMMENT.sub(self._comment(text), text)
        constants = {match[1]: match[2] for match in _DEFINE.finditer(code)}
        self.packed: set[int] = set()  # lines of structs that are packed
        pragmas = [
            (code.count("\n", 0, m.start()) + 1, m) for m in _PRAGMA.finditer(code)
        ]
        code = _DIRECTIVE.sub(lambda m: "\n" * m[0].count("\n"), code)
        if constants:
            words = "|".join(map(re.escape, constants))
            code = re.sub(rf"\b(?:{words})\b", lambda m: constants[m[0]], code)
        self.code = self._declarations(code, pragmas)

    def _comment(self, text: str) -> Any:
        def take(match: re.Match[str]) -> str:
            if match[0][0] in "\"'":
                return match[0]
            line = text.count("\n", 0, match.end()) + 1
            words = re.sub(r"^[/*!<\s]+|[*/\s]+$", "", match[0])
            words = plain(re.sub(r"\n\s*\*+", "\n", words))
            first = text.count("\n", 0, match.start()) + 1
            begin = text.rfind("\n", 0, match.start()) + 1
            is_alone = not text[begin : match.start()].strip()
            if is_alone and line - 1 in self.alone and match[0].startswith("//"):
                words = f"{self.comments[line - 1]} {words}"
            self.comments[line if is_alone else first] = words
            if is_alone:
                self.alone.add(line)
            # C99 5.1.1.2: a comment is one space. Its line ends stay, so that all lines
            # keep their numbers.
            return " " + "\n" * match[0].count("\n")

        return take

    def _declarations(self, code: str, pragmas: list[tuple[int, re.Match[str]]]) -> str:
        """Return the struct, enum and typedef declarations, with everything else blank."""
        ranges = [(match.start(), match.end()) for match in _TYPEDEF.finditer(code)]
        at = 0
        while (match := _BEGINS.search(code, at)) is not None:
            depth, end = 1, match.end()
            while end < len(code) and depth:
                depth += {"{": 1, "}": -1}.get(code[end], 0)
                end += 1
            semicolon = code.find(";", end)
            end = semicolon + 1 if semicolon >= 0 else len(code)
            line = code.count("\n", 0, match.start()) + 1
            pack = next((m for number, m in reversed(pragmas) if number < line), None)
            if re.search(_PACKED, code[match.start() : end]) or (
                pack is not None and pack[2] == "1" and not pack[3]
            ):
                self.packed |= set(range(line, code.count("\n", 0, end) + 2))
            ranges.append((match.start(), end))
            at = end
        texts, last = [], 0
        # Line of each declaration, and the code up to its end.
        self.beginnings: list[tuple[int, str]] = []
        for start, end in sorted(ranges):
            if start < last:
                continue
            texts += [
                "\n" * code.count("\n", last, start),
                " " + re.sub(_PACKED, " ", code[start:end]),
            ]
            last = end
            self.beginnings.append((code.count("\n", 0, start) + 1, "".join(texts)))
        return "".join(texts) + "\n"

    def above(self, line: int) -> str:
        """Return the comment that ends on the line above."""
        return self.comments.get(line - 1, "") if line - 1 in self.alone else ""

    def beside(self, line: int | None) -> str:
        """Return the comment after a member, or the one above it."""
        if line is None:
            return ""
        return (
            self.comments.get(line, "") if line not in self.alone else ""
        ) or self.above(line)
