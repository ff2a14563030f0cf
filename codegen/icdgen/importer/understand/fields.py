"""The rows of a message's table -> its fields."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise, zip_longest

from icdgen.icd.units import SPELLINGS, STANDARD
from icdgen.importer.document import DOUBTFUL, Header, Table, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.understand import counting, descriptions, formulas, numbers, types
from icdgen.importer.understand.counting import Extent, Units
from icdgen.importer.understand.model import ReadField, ReadMessage
from icdgen.importer.understand.rows import Entry, entries
from icdgen.importer.understand.types import Type
from icdgen.importer.words import BY_HAND, folded, grows, number, tidy_unit

MOST_BITS = 64  # of a number
_NONE = ("", "-", "–", "n/a", "na", "none")
_READABLE_UNIT = re.compile(r"(?:[^\W\d_]|[%°℃'\"′″‰(]|1\s*/|10\s*\^)[\w\s%°'\"′″‰^*/·.,()\[\]⁻⁺+-]*\Z")
_NAMED = re.compile(
    r"(?P<name>[^,;]+?)\s*[,;]\s*(?:unit:?\s*)?(?P<factor>[0-9]*\.?[0-9]+)?\s*(?P<unit>[^\W\d][^\s,;]*|[%°]\S*)\Z"
)
_SCALED_UNIT = re.compile(r"(?P<factor>[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*(?P<unit>[^0-9\s].*)?\Z")


@dataclass(slots=True)
class Line:
    """A row on its way to a field. ``at`` and ``width`` are as printed, ``units`` what their cells say they count."""

    entry: Entry
    where: str
    type: Type | None
    at: int | None = None
    width: int | None = None
    units: tuple[int, int] = (0, 0)

    @property
    def extent(self) -> Extent:
        kind = self.type.kind if self.type else ""
        return Extent(self.at, self.width, self.type.bits * self.type.times if self.type else 0, kind, *self.units)


class Unreadable(Exception):
    """The table has fields, and something makes all of them doubtful; the finding was given."""


def read(message: ReadMessage, profile: Profile, troubles: list[Trouble]) -> list[ReadField]:
    """Return the fields of a message whose table has headings; set its `register_bits` if the positions count down.

    Raises `Unreadable` if no field can be read.
    """
    table, length = message.table, message.length
    header = table.header
    assert header is not None
    _positions_named(header, table)
    found = entries(table, troubles, lambda cells: _stands_alone(cells, header, profile))
    lines = [line for entry in found if (line := _line(entry, header, table, profile, troubles))]
    places = [entry.get("at") or entry.get("at_bytes") for entry in found]
    is_register = "at" in header.roles and _falls([numbers.span(text) or (number(text), 1) for text in places])
    if is_register or any(numbers.span(text) for text in places):
        for line in lines:  # beside ranges, a single position is one bit or one byte
            if line.width is None and not (line.type and line.type.bits):
                line.width, line.units = 1, (line.units[0], line.units[0])
    if len(lines) == len(found) and not {"bits", "bits_bytes", "type"} & set(header.roles):
        _follow(lines, length, troubles)
    if "type" not in header.roles and lines:
        troubles.append(Trouble("IMP026", f"{table.title}: it prints no types", table.spot,
                                "one bit is held as bool, the rest as uint; look at the page"))  # fmt: skip
    units = counting.decide(header, [line.extent for line in lines], length, profile)
    if units is None:
        titles = " and ".join(
            f"`{title}`" for role, title in zip(header.roles, header.titles, strict=True) if role in ("at", "bits")
        )
        troubles.append(Trouble("IMP036", f"{table.title}: nothing tells whether {titles} count bits or bytes", table.spot,
                                "it was left out; in the profile: `headings: {fields: {at_bytes: [...], bits_bytes: [...]}}`",
                                "error"))  # fmt: skip
        raise Unreadable
    made: list[ReadField] = []
    implicit = not header.has_offsets
    if implicit and lines:
        troubles.append(Trouble("IMP038", f"{table.title}: it prints no offsets; they follow from the widths", table.spot,
                                "compare the length with the page", "note"))  # fmt: skip
    at = 0
    for line in lines:
        bits = _bits(line, units, troubles)
        if bits is None:
            if implicit:
                problem = f"{line.where}: without its width nothing tells where the rest stands"
                troubles.append(Trouble("IMP023", problem, line.entry.spot, "the rest was left out", "error"))
                break
            continue
        start = at if implicit else (line.at or 0) * (line.units[0] or units.at) + _within(line, header)
        made.append(_field(line, start, bits, table, profile, troubles))
        at = start + bits
    if is_register:
        message.register_bits = 0
        made = [one for one in made if folded(one.name) not in profile.reserved]  # as in grids
    return made


def _follow(lines: list[Line], length: int | None, troubles: list[Trouble]) -> None:
    """Gives fields of a table without widths and types those that follow from the offsets of the next ones, in bytes."""
    for line, following in zip_longest(lines, lines[1:]):
        end = following.at if following else length
        if line.width is not None or line.at is None or end is None or end <= line.at:
            continue
        line.width, line.units = end - line.at, (line.units[0], line.units[0])
        if line.width > 1:
            troubles.append(Trouble("IMP038", f"{line.where}: it prints no width; it has {line.width} bytes up to the next one",
                                    line.entry.spot, "make sure that no row was lost", sure=DOUBTFUL))  # fmt: skip


def _falls(spans: list[tuple[int | None, int]]) -> bool:
    """Whether positions count down, as the bits of registers do: bit 0 is the lowest one."""
    firsts = [first for first, _ in spans]
    return len(firsts) > 1 and all(a is not None and b is not None and a > b for a, b in pairwise(firsts))


def _positions_named(header: Header, table: Table) -> None:
    """A column `Bits` without one for offsets holds positions where its cells are ranges or count down: ``7:4``, ``3``."""
    if header.has_offsets or "bits" not in header.roles:
        return
    column = header.roles.index("bits")
    cells = [row.cells[column] for row in table.rows if column < len(row.cells) and row.cells[column]]
    values = [number(cell) for cell in cells]
    falls = len(values) > 1 and all(a is not None and b is not None and a > b for a, b in pairwise(values))
    if falls or any(numbers.span(cell) for cell in cells):
        header.roles[column] = "at"


def _stands_alone(cells: dict[str, str], header: Header, profile: Profile) -> bool:
    """Whether a row without an offset is a row all the same: it has a name, and a type or a width."""
    if not cells.get("name"):
        return False
    width = cells.get("bits") or cells.get("bits_bytes") or ""
    return types.read(cells.get("type", ""), profile) is not None or numbers.figure(width) is not None


def _line(entry: Entry, header: Header, table: Table, profile: Profile, troubles: list[Trouble]) -> Line | None:
    """Reads offset, width and type of a row; None, and a finding, where one of them is there and cannot be read."""
    name = entry.get("name")
    line = Line(
        entry, f"{table.title}, field `{name}`" if name else table.title, types.read(entry.get("type"), profile)
    )
    at_unit = width_unit = 0
    if header.has_offsets:
        text = entry.get("at") or entry.get("at_bytes")
        if span := numbers.span(text):
            line.at, line.width = span
            at_unit = width_unit = 0 if entry.get("at") else 8
        elif figure := numbers.figure(text):
            line.at, at_unit = figure
        else:
            _refuse(text, "the offset", line, table, troubles)
            return None
        if not at_unit and not entry.get("at"):
            at_unit = 8
        if entry.get("at") and "at_bytes" in header.roles and number(entry.get("at_bytes")) is None:
            _refuse(entry.get("at_bytes"), "the byte of the offset", line, table, troubles)
            return None
    for role in ("bits", "bits_bytes"):
        text = entry.get(role)
        if not text:
            continue
        figure = numbers.figure(text)
        if figure is None:
            _refuse(text, "the width", line, table, troubles)
            return None
        line.width, width_unit = figure.value, figure.unit or (8 if role == "bits_bytes" else 0)
        break
    line.units = (at_unit, width_unit)
    return line


def _refuse(text: str, what: str, line: Line, table: Table, troubles: list[Trouble]) -> None:
    if grows(text):
        troubles.append(Trouble("IMP037", f"{line.where}: {what} `{text}` depends on a count, which import does not read",
                                line.entry.spot, f"the row was left out; {BY_HAND}", "error"))  # fmt: skip
    else:
        numbers.refused(text, what, line.where, line.entry.spot, troubles)


def _within(line: Line, header: Header) -> int:
    """The bit within the byte, where one column counts bytes and another one the bits in them."""
    if line.entry.get("at") and "at_bytes" in header.roles:
        return 8 * (number(line.entry.get("at_bytes")) or 0)
    return 0


def _bits(line: Line, units: Units, troubles: list[Trouble]) -> int | None:
    """The width in bits; None, and a finding, where nothing tells it or two things contradict each other."""
    told = line.type.bits * line.type.times if line.type else 0
    if line.width is None:
        if told:
            return told
        troubles.append(Trouble("IMP023", f"{line.where}: neither a width nor a type that tells it", line.entry.spot,
                                "look at the page; the row was left out", "error"))  # fmt: skip
        return None
    own = line.units[1] or (line.units[0] if _is_range(line) else 0) or units.width
    bits = line.width * own
    if told and line.type and line.type.times > 1 and bits == line.type.bits:
        return told  # the width is that of one element
    if told and bits != told and line.type and (line.type.kind != "bool" or line.type.times > 1):
        troubles.append(Trouble("IMP026", f"{line.where}: its type `{line.entry.get('type')}` has {told} bits, its width is "
                                f"{bits}", line.entry.spot, "the width is held; look at the page", "error"))  # fmt: skip
        line.type = line.type._replace(times=1)
    return bits


def _is_range(line: Line) -> bool:
    return not line.entry.get("bits") and not line.entry.get("bits_bytes")


def _field(
    line: Line, at: int, bits: int, table: Table, profile: Profile, troubles: list[Trouble]
) -> ReadField:  # fmt: skip
    """The field of a row."""
    entry, name = line.entry, line.entry.get("name")
    has_scale = any(role in table.header.roles for role in ("unit", "formula")) if table.header else False
    name, scale = (name, "") if has_scale else scaled_name(name)
    kind = _kind(line, bits, "type" in (table.header.roles if table.header else ()), troubles)
    if not name:
        troubles.append(Trouble("IMP025", f"{table.title}: the field at bit {at} has no name", entry.spot,
                                "name it in the ICD, or by an erratum", "error"))  # fmt: skip
        name = f"Unnamed {at}"
    described = _described(entry, profile, kind == "enum")
    _unit(scale, described)
    for problem in described.problems:
        text = f": `{entry.get('description')[-160:]}`" if entry.get("description") else ""
        troubles.append(Trouble("IMP040", f"{line.where}: {problem}{text}", entry.spot, "read the page"))
    count = line.type.times if line.type else 1
    if count > 1 and kind != "bytes":
        return ReadField(name, at, bits // count, kind, described, entry.spot, count)
    made = ReadField(name, at, bits, kind, described, entry.spot)
    if kind == "uint" and bits <= MOST_BITS:
        found = descriptions.bits(entry.get("description"), bits)
        if found is None:
            troubles.append(Trouble("IMP040", f"{line.where}: the bits that it names overlap, or do not fit into it: "
                                    f"`{entry.get('description')[:160]}`", entry.spot, "read the page"))  # fmt: skip
        elif found:
            made.bitfields = found
            troubles.append(Trouble("IMP029", f"{line.where}: its description names {len(found)} fields of bits", entry.spot,
                                    "held under `bitfields:`; compare them with the page", "note"))  # fmt: skip
    return made


def _kind(line: Line, bits: int, has_types: bool, troubles: list[Trouble]) -> str:
    """The type as the ICD calls it. Where the table has no column of types, one finding speaks for all of its fields."""
    if not has_types:
        return "bool" if bits == 1 else "uint" if bits <= MOST_BITS else "bytes"
    if line.type is not None:
        if not line.type.is_said:
            troubles.append(Trouble("IMP026", f"{line.where}: the type `{line.entry.get('type')}` does not say whether the "
                                    "value has a sign", line.entry.spot, "held as uint; look at the page"))  # fmt: skip
        return line.type.kind
    text = line.entry.get("type")
    what = f"the type `{text}` is unknown" if text else "it has no type"
    fallback = "uint" if bits <= MOST_BITS else "bytes"
    troubles.append(Trouble("IMP026", f"{line.where}: {what}", line.entry.spot,
                            f"held as {fallback}; in the profile: `types: {{{text or '?'}: ...}}`", "error"))  # fmt: skip
    return fallback


def _described(entry: Entry, profile: Profile, is_enum: bool) -> descriptions.Described:
    text = entry.get("description")
    if is_enum and entry.get("values"):
        text = f"{text} {entry.get('values')}"
    made = descriptions.read(text, profile, is_enum)
    if is_enum and made.enum_table is None and not made.enum_title and entry.get("values"):
        made.enum_title = entry.get("values")
    _unit(tidy_unit(entry.get("unit")).strip("()- "), made)
    formula = entry.get("formula").strip()
    if tidy_unit(formula) in STANDARD or tidy_unit(formula) in SPELLINGS:
        _unit(tidy_unit(formula), made)  # a column of factors with their units, of which one is 1
    elif formula.casefold() not in _NONE:
        scaled = formulas.per_step(formula, descriptions.names(profile))
        if scaled is None:
            made.problems.append(f"the formula `{formula}` cannot be read")
        else:
            _scale(scaled.formula, made)
            _unit(scaled.unit, made)
    return made


def scaled_name(text: str) -> tuple[str, str]:
    """A cell that names a field, and its unit with a factor if it has one: ``voltage, 10 mV``."""
    match = _NAMED.match(text)
    unit = tidy_unit(match["unit"]) if match else ""
    if match and (match["factor"] or unit in STANDARD or unit in SPELLINGS):
        return match["name"], f"{match['factor'] or ''} {unit}".strip()
    return text, ""


def scaled(text: str) -> descriptions.Described:
    """What a unit says, with a factor or without."""
    made = descriptions.Described()
    _unit(text, made)
    return made


def _unit(text: str, made: descriptions.Described) -> None:
    """A cell of units: a unit, a factor (``0.01``), or both (``10 mV``)."""
    if text.casefold() in _NONE:
        return
    match = _SCALED_UNIT.match(text)
    if match and not (match["unit"] or "").startswith(("/", "^", "*", "·")):  # `1/s`, `10^-3 T` are units
        scaled = formulas.per_step(match["factor"], None)
        _scale(scaled.formula if scaled else "", made)
        text = tidy_unit(match["unit"] or "")
        if not text:
            return
    if not _READABLE_UNIT.match(text):
        made.problems.append(f"the unit `{text}` cannot be read")
        return
    if made.unit and made.unit != text:
        made.problems.append(f"its unit is `{text}` in one column and `{made.unit}` in another")
    made.unit = text


def _scale(formula: str, made: descriptions.Described) -> None:
    if formula and made.formula and formula != made.formula:
        made.problems.append(f"it gives two formulas: `{made.formula}` and `{formula}`")
    made.formula = formula or made.formula
