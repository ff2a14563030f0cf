"""A profile guessed from what stands in the columns of tables that are not understood."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from icdgen.icd.units import SPELLINGS, STANDARD
from icdgen.importer.profile import Profile
from icdgen.importer.understand import formulas, numbers, types
from icdgen.importer.words import folded, number, tidy_unit

_FORMULA = re.compile(r"[A-Za-z]\w*\s*=|[*×/]\s*[0-9.]|[0-9.]\s*[*×]")


@dataclass
class Column:
    """A heading and the cells below it, in order."""

    title: str
    cells: list[str] = field(default_factory=list)

    @property
    def filled(self) -> list[str]:
        return [cell for cell in self.cells if cell]

    def share(self, test: Callable[[str], bool]) -> float:
        """Which share of the filled cells passes a test."""
        filled = self.filled
        return sum(1 for cell in filled if test(cell)) / len(filled) if filled else 0.0


def proposal(
    unread: list[list[Column]],
    partly: list[list[Column]],
    captions: list[str],
    labelled: Counter[str],
    kindless: int,
    profile: Profile,
) -> list[str]:
    """The lines of a profile that would have more of the tables read. Every guess is marked. ``kindless``: messages of
    which nothing says the kind."""
    lines = [f"captions: [{', '.join(captions)}]   # ?", ""] if captions else []
    guesses: dict[str, dict[str, list[str]]] = {"fields": {}, "enumeration": {}}
    names: dict[str, None] = {}
    for columns in unread:
        kind, roles = _roles(columns, profile)
        for column, role in roles:
            if kind and role and column.title and column.title not in guesses[kind].setdefault(role, []):
                guesses[kind][role].append(column.title)
            if role == "type":
                names |= _unknown_types(column, profile)
    for column in (column for columns in partly for column in columns):
        if folded(column.title) in profile.headings["fields"].get("type", ()):
            names |= _unknown_types(column, profile)
    if any(guesses.values()):
        lines.append("headings:")
        for kind, roles_of in guesses.items():
            lines += [f"  {kind}:"] if roles_of else []
            lines += [
                f"    {role}: [{', '.join(_quoted(t) for t in titles)}]   # ?" for role, titles in roles_of.items()
            ]
        lines.append("")
    lines += _labels(labelled)
    if names:
        lines += ["types:   # ? uint, int, bool, enum, float or bytes; `bits` where the name tells the width"]
        lines += [f"  {_quoted(name)}: {{type: {_type(name)}}}" for name in list(names)[:40]]
        lines.append("")
    lines += ["# Where ids stand in headings, captions or prose:", '# patterns: ["{name} ({id})", "Message ID {id}"]',
              "# What the manual does not say:", _defaults(kindless),
              "# node: {byte_order: little, bit_order: lsb0}"]  # fmt: skip
    return lines


def _unknown_types(column: Column, profile: Profile) -> dict[str, None]:
    """The names of types that nobody knows, in order."""
    return dict.fromkeys(cell for cell in column.filled if len(cell) < 24 and types.read(cell, profile) is None)


def _defaults(kindless: int) -> str:
    if not kindless:
        return "# defaults: {kind: telemetry}"
    return (
        f"defaults: {{kind: telemetry}}   # ? of {kindless} message{'s' if kindless != 1 else ''} nothing says the kind"
    )


def _quoted(text: str) -> str:
    if re.fullmatch(r"[A-Za-z][\w ()./-]*[\w)]|[A-Za-z]", text) and text.casefold() not in _WORDS:
        return text
    escaped = "".join(c for c in text if c.isprintable()).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


_WORDS = {"y", "n", "yes", "no", "on", "off", "true", "false", "null"}


def _labels(labelled: Counter[str]) -> list[str]:
    made: dict[str, list[str]] = {}
    for label in labelled:
        words = set(folded(label))
        if words & {"length", "size", "bytes", "byte"}:
            made.setdefault("length", []).append(label)
        elif words & {"id", "opcode", "code", "command", "message", "identifier", "number", "apid"}:
            made.setdefault("id", []).append(label)
    lines = [f"  {what}: [{', '.join(_quoted(label) for label in found)}]   # ?" for what, found in made.items()]
    return ["labels:", *lines, ""] if lines else []


def _type(name: str) -> str:
    words = name.casefold()
    for kind, parts in (("bool", ("bool", "switch", "flag", "bit")), ("enum", ("enum", "choice", "select")),
                        ("float", ("float", "double", "real")), ("uint", ("unsigned", "uint", "word", "byte")),
                        ("int", ("signed", "int")), ("bytes", ("array", "string", "text", "char"))):  # fmt: skip
        if any(part in words for part in parts):
            return kind
    return "uint"


def _is_figure(cell: str) -> bool:
    return numbers.figure(cell) is not None or numbers.span(cell) is not None


def _roles(columns: list[Column], profile: Profile) -> tuple[str, list[tuple[Column, str]]]:
    """What kind of table has such columns, and the role of each: known headings first, then by what stands below them."""
    made = [(column, _known(column, profile)) for column in columns]
    taken = {role for _, role in made}
    free = [column for column, role in made if not role and column.filled]
    guessed: dict[int, str] = {}

    def give(role: str, column: Column | None) -> None:
        if column is not None and role not in taken:
            guessed[id(column)] = role
            taken.add(role)
            free.remove(column)

    figures = [column for column in free if column.share(_is_figure) > 0.8]
    if len(columns) <= 3 and len(figures) == 1 and len(set(figures[0].filled)) == len(figures[0].filled):
        give("value", figures[0])
        give("name", next((c for c in free if c.share(str.isdigit) < 0.5), None))
        give("description", next(iter(free), None))
        return "enumeration", [(column, guessed.get(id(column), "")) for column in columns]
    if "at" not in taken and "at_bytes" not in taken and figures:
        give(_unit("at", figures[0], figures), figures[0])
        figures = figures[1:]
    if "bits" not in taken and "bits_bytes" not in taken and figures:
        give(_unit("bits", figures[0], figures), figures[0])
    typed = [c for c in free if _types(c, profile) > 0.5]
    give("type", max(typed, key=lambda c: _types(c, profile), default=None))
    give("unit", next((c for c in free if c.share(_is_unit) > 0.6), None))
    give("formula", next((c for c in free if c.share(_is_formula) > 0.6), None))
    words = [c for c in free if c.share(lambda cell: any(x.isalpha() for x in cell)) > 0.8]
    dense = [c for c in words if len(c.filled) >= 0.5 * len(c.cells)]
    give("name", max(dense, key=lambda c: len(set(c.filled)), default=None))
    words = [c for c in words if c in free]
    few = (c for c in words if len(set(c.filled)) <= max(2, 0.6 * len(c.filled)) and max(map(len, c.filled)) < 20)
    give("type", next(few, None))
    give("description", max((c for c in words if c in free), key=lambda c: sum(map(len, c.filled)), default=None))
    kind = "fields" if "name" in taken and ({"at", "at_bytes", "bits", "bits_bytes", "type"} & taken) else ""
    return kind, [(column, guessed.get(id(column), "")) for column in columns]


def _known(column: Column, profile: Profile) -> str:
    words = folded(column.title)
    return next((role for role, titles in profile.headings["fields"].items() if words in titles), "")


def _unit(role: str, column: Column, figures: list[Column]) -> str:
    """Whether a column of figures counts bytes: widths of 1, 2, 4 and steps to match."""
    words = set(folded(column.title))
    if words & {"bit", "bits"}:
        return role
    widths = [number(cell) for cell in figures[-1].filled]
    small = [width for width in widths if width is not None]
    return f"{role}_bytes" if words & {"byte", "bytes"} or (small and max(small) <= 8) else role


def _types(column: Column, profile: Profile) -> float:
    return column.share(lambda cell: types.read(cell, profile) is not None and not _is_figure(cell))


def _is_unit(cell: str) -> bool:
    unit = tidy_unit(cell).strip("()- ")
    return unit in STANDARD or unit in SPELLINGS or cell in ("-", "–")


def _is_formula(cell: str) -> bool:
    return bool(_FORMULA.search(cell)) or formulas.per_step(cell, None) is not None
