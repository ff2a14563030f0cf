"""Normalised text: spelling that is equal for texts that mean the same, integers and
table numbers, and the lines of a wrapped cell as one text.
"""

from __future__ import annotations

import re
import unicodedata
from functools import lru_cache

_LIGATURES = {c: unicodedata.normalize("NFKC", c) for c in "ﬀﬁﬂﬃﬄﬅﬆ"}
HYPHENS = str.maketrans(dict.fromkeys("\u2010\u2011\u2212", "-"))
_BLANKS = {
    "\u00a0": " ",
    "\u2007": " ",
    "\u202f": " ",
    "\u2009": " ",
    "\u200b": "",
    "\ufeff": "",
}
_PLAIN = {**str.maketrans({**_LIGATURES, **_BLANKS}), **HYPHENS}
_WORD = re.compile(r"[A-Za-z0-9%]+")
SUPERSCRIPTS = str.maketrans("0123456789-+", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺")
_RAISED = re.compile("[⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺]+")
# Mark behind the caption of a table that began on a page before.
CONTINUED = re.compile(
    r"\s*[-–,]?\s*[(\[]?\s*(?:continued|cont\.|cont'd|contd\.?)\s*[)\]]?\s*\Z", re.I
)
_NUMBER = re.compile(r"[-+]?(?:0[xX][0-9A-Fa-f]+|[0-9]+)\Z")


def plain(text: str) -> str:
    """Return a text with ligatures spelled out, ordinary blanks and hyphens, and single
    blanks.
    """
    return " ".join(text.translate(_PLAIN).split())


def tidy_unit(text: str) -> str:
    """Return a unit without brackets, and without a blank before a raised figure."""
    return re.sub(r"\s+(?=[⁰¹²³⁴⁵⁶⁷⁸⁹⁻])", "", plain(text).strip("[] "))


@lru_cache(maxsize=1 << 16)
def folded(text: str) -> tuple[str, ...]:
    """Return the words of a heading, a label or a title, without case and punctuation."""
    return tuple(word.casefold() for word in _WORD.findall(plain(text)))


def squeezed(text: str) -> str:
    """Return letters and digits only.

    The result is equal for texts that differ in spacing, hyphens and case.
    """
    return "".join(folded(text))


_GROWING = re.compile(
    r"(?<![\w.])(?:[0-9]+\s*[-+]\s*(?:[0-9]+\s*[*×·]\s*)?|[0-9]+\s*[*×·]\s*)[NnMk](?:\s*[-+]\s*[0-9]+)?(?!\w)|"
    r"(?<![\w.])[NnMk]\s*[-+*×·]\s*[0-9]+(?:\s*[-+]\s*[0-9]+)?(?![\w.])"
)


def depends_on_count(text: str) -> bool:
    """Return whether a number depends on a count: ``8 + 6*N``, ``N + 1``."""
    return _GROWING.fullmatch(plain(text).strip("() ")) is not None


def without_blanks_in_counts(text: str) -> str:
    """Return the text without blanks in numbers that depend on a count."""
    return _GROWING.sub(lambda m: "".join(m.group().split()), text)


def printed_integer(text: str) -> int | None:
    """Return the integer in a text, decimal or 0x, without a raised footnote mark, or
    None.
    """
    text = _RAISED.sub("", plain(text)).rstrip("*†").strip()
    if not _NUMBER.match(text) or len(text) > 24:
        return None
    return int(text, 16) if "x" in text.lower() else int(text)


_PART = 1_000_000  # more than the tables of a chapter


def table_number(printed: str) -> int:
    """Return a number that preserves the order of table numbers such as ``12`` and
    ``4-12``.

    `table_name` is the reverse.
    """
    number = 0
    for part in re.split("[-.]", printed):
        # At most six digits, so that a part stays below `_PART`.
        number = number * _PART + int(part[:6])
    return number


def table_name(number: int | None) -> str:
    """Return the printed number of a table: ``12``, or ``4-12`` for tables of chapters.

    It is "?" for a table without a number.
    """
    if number is None:
        return "?"
    upper, last = divmod(number, _PART)
    return f"{table_name(upper)}-{last}" if upper else str(last)


_SOFT = "\u00ad"


def unbroken(
    lines: list[str], full: list[bool], document_words: frozenset[str]
) -> list[str]:
    """Return the lines of a wrapped cell, with words joined that were broken to fill a
    line.
    """
    texts: list[str] = []
    for index, line in enumerate(lines):
        before = texts[-1].rsplit(" ", 1)[-1] if texts else ""
        if (
            texts
            and full[index - 1]
            and _is_word(before + line.split(" ", 1)[0], document_words)
        ):
            texts[-1] += line
        else:
            texts.append(line)
    return texts


def join(
    lines: list[str],
    document_words: frozenset[str] = frozenset(),
    full: list[bool] | None = None,
) -> str:
    """Return the lines of a wrapped cell as one text.

    ``document_words`` are unbroken words of the document. They determine whether a
    hyphen at the end of a line belongs to the word, and whether a word that fills its
    line (``full``) continues in the next line.
    """
    text = ""
    for index, line in enumerate(lines):
        line = line.translate(_PLAIN).strip()
        if not line:
            continue
        if not text:
            text = line
            continue
        before, after = text.rsplit(" ", 1)[-1], line.split(" ", 1)[0]
        if text.endswith(_SOFT):
            text = text[:-1] + line
        elif len(before) > 1 and before.endswith("-") and after[:1].islower():
            joined = before[:-1] + after
            if _is_word(joined, document_words) and not _is_word(
                before + after, document_words
            ):
                text = text[:-1]
            text += line
        elif _breaks_without_blank(before, after) or (
            full and full[index - 1] and _is_word(before + after, document_words)
        ):
            text += line
        else:
            text += " " + line
    return " ".join(text.replace(_SOFT, "").split())


def _breaks_without_blank(before: str, after: str) -> bool:
    """Return whether a line may break here without a blank.

    This is the case after a hyphen or slash in a word, and within a formula.
    """
    return (len(before) > 1 and before[-1] in "-/_") or (
        before[-1:] in "*/" and after[:1].isdigit()
    )


def _is_word(word: str, document_words: frozenset[str]) -> bool:
    return word.strip(".,;:()[]") in document_words
