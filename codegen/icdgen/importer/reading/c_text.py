"""Preparation of a C file for the parser.

It extracts comments by line, constants, packing, and the declarations of types.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from icdgen.importer.words import plain

_PACKED = r"(?:__attribute__\s*\(\(\s*(?:__)?packed(?:__)?\s*\)\)|\b__packed\b|\b__PACKED\b|\bPACKED\b)"
_BEGINS = re.compile(
    rf"\b(?:typedef\s+)?(?:{_PACKED}\s*)?(?:struct|enum|union)\b[^;{{}}()=]*(?:{_PACKED})?[^;{{}}()=]*\{{"
)
_TYPEDEF = re.compile(r"\btypedef\s+[\w\s]+?\s\w+\s*(?:\[[^][;{}]*\]\s*)*;")
# Strings and characters match, too, so that `//` in them begins no comment.
_COMMENT = re.compile(
    r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.S
)
_DEFINE = re.compile(
    r"#[ \t]*define[ \t]+(\w+)[ \t]+\(?[ \t]*(0[xX][0-9a-fA-F]+|[0-9]+)[uUlL]*[ \t]*\)?[ \t]*"
)
_DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\.|\\\n)*", re.M)
_CONDITION = re.compile(
    r"#[ \t]*(if|ifdef|ifndef|elif|elifdef|elifndef|else|endif)\b(.*)", re.S
)
_PRAGMA = re.compile(
    r"#\s*pragma\s+pack\s*\(([^()]*)\)|"
    r"\b_Pragma\s*\(\s*\"\s*pack\s*\(([^()]*)\)\s*\"\s*\)"
)
_TOKEN = re.compile(
    rf"(?P<packed>{_PACKED})|(?P<kind>\b(?:struct|union|enum)\b)|\w+|[^\w\s]"
)


@dataclass
class Definition:
    """A struct, union or enumeration with a body.

    ``most`` is the alignment in bytes that its members have at most, or None.
    """

    most: int | None
    is_packed: bool = False  # by an attribute of its own
    has_packed_member: bool = False  # by an attribute of the member
    is_conditional: bool = False  # the preprocessor decides about parts of it


class CText:
    """A text in C with its comments, constants and packing taken out; the lines keep
    their numbers.
    """

    def __init__(self, text: str) -> None:
        self.comments: dict[int, str] = {}  # line on which a comment ends -> its text
        self.alone: set[int] = set()  # of these, those on lines without code
        code = self._without_comments(text)
        code, conditions = _without_inactive(code)
        directives = [(m.start(), m[0].strip()) for m in _DIRECTIVE.finditer(code)]
        constants = _constants([text for _, text in directives])
        packs = list(_packs(code, constants))
        # Everything that is taken out leaves blanks, so that positions stay the same.
        code = _DIRECTIVE.sub(_blank, _PRAGMA.sub(_blank, code))
        # Braces in strings and characters are none of the code.
        code = _COMMENT.sub(lambda m: re.sub(r"[{};]", " ", m[0]), code)
        self.definitions: list[Definition] = []  # in the order of their opening braces
        ranges = _declarations(code)
        for start, end in ranges:
            self._define(code, start, end, packs, conditions)
        code = re.sub(_PACKED, _blank, _only(code, ranges))

        def with_constants(part: str) -> str:
            return re.sub(r"\b[A-Za-z_]\w*", lambda m: constants.get(m[0], m[0]), part)

        self.code = with_constants(code) + "\n"
        # Line of each declaration, and the code up to its end.
        self.beginnings = [
            (code.count("\n", 0, start) + 1, with_constants(code[:end]))
            for start, end in ranges
        ]

    def _without_comments(self, text: str) -> str:
        """Return the text with blanks for comments, which are noted by line."""
        code = _COMMENT.sub(lambda m: m[0] if m[0][0] in "\"'" else _blank(m), text)
        for match in _COMMENT.finditer(text):
            if match[0][0] in "\"'":
                continue
            last = text.count("\n", 0, match.end()) + 1
            words = re.sub(r"^[/*!<\s]+|[*/\s]+$", "", match[0])
            words = plain(re.sub(r"\n\s*\*+", "\n", words))
            first = text.count("\n", 0, match.start()) + 1
            begin = text.rfind("\n", 0, match.start()) + 1
            end = text.find("\n", match.end())
            before = code[begin : match.start()].strip()
            after = code[match.end() : end if end >= 0 else None].strip()
            line = first if before else last
            if not before and not after:
                if last - 1 in self.alone and match[0].startswith("//"):
                    words = f"{self.comments[last - 1]} {words}"
                self.alone.add(line)
            comments_of_line = (self.comments.get(line, ""), words)
            self.comments[line] = " ".join(filter(None, comments_of_line))
        return code

    def _define(
        self,
        code: str,
        start: int,
        end: int,
        packs: list[tuple[int, int | None]],
        conditions: list[int],
    ) -> None:
        """Note the definitions of a declaration and what packs each of them."""
        # Open braces: where each begins, and its definition; None for an initializer.
        opened: list[tuple[int, Definition | None]] = []
        begun: Definition | None = None  # between its keyword and its brace
        closed: Definition | None = None  # directly in front of the token
        is_packed = False  # by a word directly in front of the token
        for token in _TOKEN.finditer(code, start, end):
            at = token.start()
            if token["packed"]:
                target = begun or closed
                if target is not None:
                    target.is_packed = True
                is_packed = target is None
                continue
            if is_packed and not token["kind"] and opened and opened[-1][1]:
                opened[-1][1].has_packed_member = True
            closed = None
            if token["kind"]:
                most = next((m for place, m in reversed(packs) if place < at), None)
                begun = Definition(most, is_packed)
            elif token[0] == "{":
                opened.append((at, begun))
                if begun is not None:
                    self.definitions.append(begun)
                begun = None
            elif token[0] == ";":
                begun = None
            elif token[0] == "}" and opened:
                begin, closed = opened.pop()
                if closed is not None:
                    closed.is_conditional = any(begin < c < at for c in conditions)
            is_packed = False

    def above(self, line: int) -> str:
        """Return the comment that ends on the line above."""
        return self.comments.get(line - 1, "") if line - 1 in self.alone else ""

    def beside(self, line: int | None, first: int) -> str:
        """Return the comment after a member, or the one above it.

        ``first`` is the line on which the struct begins: the comment above this line
        is that of the struct.
        """
        if line is None:
            return ""
        comment = self.comments.get(line, "") if line not in self.alone else ""
        return comment or (self.above(line) if line > first else "")


def _blank(match: re.Match[str]) -> str:
    """Return blanks in place of the text, and its line ends."""
    return re.sub(r"[^\n]", " ", match[0])


def _without_inactive(code: str) -> tuple[str, list[int]]:
    """Return the code with blanks for what `#if 0` takes out, and the positions of
    other conditions.
    """
    texts, conditions = list(code), []
    opened: list[int | None] = []  # of each open `#if`: where its `#if 0` begins
    for match in _DIRECTIVE.finditer(code):
        directive = _CONDITION.match(match[0].strip())
        at = code.index("#", match.start())
        if directive is None:
            continue
        if directive[1] in ("if", "ifdef", "ifndef"):
            is_zero = (directive[1], directive[2].strip()) == ("if", "0")
            opened.append(at if is_zero else None)
            if not is_zero:
                conditions.append(at)
        elif opened:
            begin = opened.pop()
            if begin is None:
                conditions.append(at)
            else:
                for index in range(begin, match.end()):
                    texts[index] = "\n" if code[index] == "\n" else " "
            if directive[1] != "endif":
                opened.append(None)
    return "".join(texts), [at for at in conditions if texts[at] == "#"]


def _constants(directives: list[str]) -> dict[str, str]:
    """Return the constants of a file, without those with several values."""
    values: dict[str, set[str]] = {}
    for text in directives:
        if match := _DEFINE.fullmatch(text):
            values.setdefault(match[1], set()).add(match[2])
    return {name: min(texts) for name, texts in values.items() if len(texts) == 1}


def _packs(code: str, constants: dict[str, str]) -> Iterator[tuple[int, int | None]]:
    """Iterate over the places where the most alignment of members changes."""
    most: int | None = None
    stack: list[tuple[str, int | None]] = []  # names and values of `push`
    for match in _PRAGMA.finditer(code):
        words = [word.strip() for word in (match[1] or match[2] or "").split(",")]
        names = [w for w in words[1:] if not constants.get(w, w).isdigit()]
        numbers = [int(n) for w in words if (n := constants.get(w, w)).isdigit()]
        name = names[0] if names else ""
        if words[0] == "push":
            stack.append((name, most))
        elif words[0] == "pop" and stack:
            # `pop` with a name removes all that is above that name, too.
            at = next(
                (i for i, (n, _) in reversed(list(enumerate(stack))) if n == name), None
            )
            at = len(stack) - 1 if not name else at
            if at is not None:
                most = stack[at][1]
                del stack[at:]
        elif words == [""]:
            most = None
        if numbers:
            most = numbers[-1] or None
        yield match.start(), most


def _declarations(code: str) -> list[tuple[int, int]]:
    """Return the places of struct, enum and typedef declarations."""
    ranges = [(match.start(), match.end()) for match in _TYPEDEF.finditer(code)]
    at = 0
    while (match := _BEGINS.search(code, at)) is not None:
        depth, at = 1, match.end()
        while at < len(code) and depth:
            depth += {"{": 1, "}": -1}.get(code[at], 0)
            at += 1
        semicolon = code.find(";", at)
        at = semicolon + 1 if semicolon >= 0 else len(code)
        ranges.append((match.start(), at))
    result: list[tuple[int, int]] = []
    for start, end in sorted(ranges):
        if not result or start >= result[-1][1]:
            result.append((start, end))
    return result


def _only(code: str, ranges: list[tuple[int, int]]) -> str:
    """Return the code with blanks for everything outside the ranges."""
    parts, last = [], 0
    for start, end in ranges:
        parts += [re.sub(r"[^\n]", " ", code[last:start]), code[start:end]]
        last = end
    return "".join(parts)
