"""Unit, formula, enumeration and constant of a field, taken from its description.

The `phrases` and `variables` of the profile say how a manual words them. The text that
contains none of them is the summary of the field.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from icdgen.importer import formulas
from icdgen.importer.profile import Profile
from icdgen.importer.words import plain, table_number, tidy_unit

_TABLE = re.compile(r"[0-9]+(?:[-.][0-9]+)*\Z")
_GAP = "\0"  # in place of a phrase that is removed from a description
_FORMULA_WORD = re.compile(r"\bformula\b", re.I)


@dataclass(slots=True)
class Described:
    """Facts of a description.

    ``problems`` are texts for findings; ``contradiction`` is set if words and formula
    disagree.
    """

    unit: str = ""
    formula: str = ""
    formula_for: str = ""
    enum_table: int | None = None
    enum_title: str = ""
    const: str = ""  # as printed
    prose: str = ""  # text without the phrases above
    problems: list[str] = field(default_factory=list)


def read_description(text: str, profile: Profile, is_enum: bool = False) -> Described:
    """Return the facts in a description, and its remaining prose."""
    text = plain(text)
    described = Described()
    spans: list[tuple[int, int]] = []
    _formula(text, profile, described, spans)
    _unit(text, profile, described, spans)
    if is_enum:
        _enumeration(text, profile, described, spans)
    _const(text, profile, described)
    described.prose = _without_spans(text, spans)
    return described


def value_names(profile: Profile) -> formulas.ValueNames:
    variables = profile.data["variables"]
    return formulas.value_names(tuple(variables["raw"]), tuple(variables["physical"]))


def _formula(
    text: str, profile: Profile, described: Described, spans: list[tuple[int, int]]
) -> None:
    formula = formulas.find_formula(text, value_names(profile))
    announced = ""
    for what, value in (("gives_physical", "physical"), ("gives_raw", "raw")):
        for pattern in profile.phrases[what]:
            if match := pattern.search(text):
                announced = value
                spans.append(match.span())
    if formula is None:
        if formulas.mentions_formula(text, value_names(profile)) or (
            announced and _FORMULA_WORD.search(text)
        ):
            described.problems.append("a formula is there and cannot be read")
        return
    spans.append((formula.start, formula.end))
    described.formula, described.unit = formula.formula, formula.unit
    if announced and announced != formula.gives:
        described.formula_for = announced


def _unit(
    text: str, profile: Profile, described: Described, spans: list[tuple[int, int]]
) -> None:
    units = [described.unit] if described.unit else []
    for what in ("unit", "formula_unit"):
        for pattern in profile.phrases[what]:
            match = pattern.search(text)
            if match and not any(
                a < match.end() and match.start() < b and what == "unit"
                for a, b in spans
            ):
                units.append(tidy_unit(match["unit"] or match["bare"]))
                spans.append(match.span())
                break
    if units:
        described.unit = units[0]
        if len(set(units)) > 1:
            described.problems.append(
                "it gives two units: "
                + " and ".join(f"`{u}`" for u in dict.fromkeys(units))
            )


def _enumeration(
    text: str, profile: Profile, described: Described, spans: list[tuple[int, int]]
) -> None:
    for pattern in profile.phrases["enumeration"]:
        match = pattern.search(text)
        if not match:
            continue
        groups = match.groupdict()
        if groups.get("table"):
            number = _TABLE.search(groups["table"])
            described.enum_table = table_number(number.group()) if number else None
        described.enum_title = (groups.get("title") or "").strip()
        spans.append(match.span())
        return
    # Otherwise, a table that the text names, whatever the words around it.
    words = "|".join(re.escape(word) for word in profile.data["captions"])
    match = re.search(
        rf"\b(?:{words})\s*(?P<number>[0-9]+(?:[-.][0-9]+)*)(?:\s*[:–—-]\s*(?P<title>[^.;()]+))?",
        text,
        re.I,
    )
    if match:
        described.enum_table = table_number(match["number"])
        described.enum_title = (match["title"] or "").strip()


def _const(text: str, profile: Profile, described: Described) -> None:
    for pattern in profile.phrases["const"]:
        match = pattern.search(text)
        if not match or re.match(
            r"\s*(?:,?\s*(?:or|to|and|if|for|when)\b|[-–]\s*[0-9]|[.][0-9]|[.]{2,3}\s*[0-9])",
            text[match.end() :],
            re.I,
        ):
            continue
        numbers = re.findall(r"0x[0-9a-f]+|[0-9]+", match["number"], re.I)
        values = {int(n, 16) if "x" in n.lower() else int(n) for n in numbers}
        if len(values) > 1:
            described.problems.append(
                f"it gives the value in two ways that differ: {match['number']}"
            )
            return
        described.const = next((n for n in numbers if "x" in n.lower()), numbers[0])
        return


def _without_spans(text: str, spans: list[tuple[int, int]]) -> str:
    remaining, at = "", 0
    for start, end in sorted(spans):
        if start > at:
            remaining += text[at:start]
        remaining += _GAP
        at = max(at, end)
    remaining += text[at:]
    # Only marks around a gap are superfluous: those of `1..5` are part of the text.
    remaining = re.sub(
        rf"(?:\s*[:.])*\s*{_GAP}(?:\s*[:.{_GAP}])*", _joined_marks, remaining
    )
    remaining = re.sub(r"\s+([,:;]|[.](?![.]))", r"\1", " ".join(remaining.split()))
    return re.sub(r"[.:;,\s]*\Z", "", remaining)


def _joined_marks(match: re.Match[str]) -> str:
    """Return one full stop for the marks before and behind a phrase that was removed."""
    marks = re.findall("[:.]", match.group())
    return "." if len(marks) > 1 else match.group().replace(_GAP, "")
