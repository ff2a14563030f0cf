"""Grids: bits or bytes as columns, names of fields in cells that may span several; register maps, frames, bytes as rows."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise

from icdgen.importer.document import Row, Table, Trouble
from icdgen.importer.profile import Profile
from icdgen.importer.understand import around
from icdgen.importer.understand.around import Around, Said
from icdgen.importer.understand.fields import scaled, scaled_name
from icdgen.importer.understand.messages import take
from icdgen.importer.understand.model import ReadField, ReadMessage
from icdgen.importer.words import folded, plain

FEWEST = 4  # columns of a grid
_COLUMN = re.compile(
    r"(?P<word>bits?|bytes?|octets?|[bBD])?\s*\[?(?P<n>[0-9]{1,3})(?:\s*[~:–-]\s*(?:bits?|bytes?|octets?|[bBD])?\s*(?P<m>[0-9]{1,3}))?\]?\Z",
    re.I,
)
_BITS, _BYTES = {"bit", "bits", "d"}, {"byte", "bytes", "octet", "octets"}
_ADDRESS = re.compile(r"(?:0[xX][0-9A-Fa-f]+|[0-9A-Fa-f]+[hH]|[0-9]+)\Z")
_INDEX = re.compile(r"\s*[\[(<][0-9]+(?:\s*[:.-]+\s*[0-9]+)?[\])>]\Z")
_ACCESS = {"r": "telemetry", "ro": "telemetry", "w": "telecommand", "wo": "telecommand", "rw": "configuration"}


@dataclass(slots=True)
class Grid:
    """The heading row of a grid. ``columns`` are the numbers of its bits or bytes by cell, ``unit`` how many bits each is."""

    row: Row
    columns: dict[int, range]
    unit: int
    roles: dict[str, int]  # of the other cells

    @property
    def count(self) -> int:
        return _width(self.columns)


def find(table: Table, profile: Profile) -> tuple[Grid, list[Row]] | None:
    """The heading row of the grid that a table is, and the rows below it; None for a table that is none."""
    rows = table.all_rows
    for index, row in enumerate(rows[:4]):
        columns, words = _columns(row.cells)
        if _width(columns) < FEWEST or len(columns) < 2 or index + 1 == len(rows):
            continue
        said = {word for above in rows[: index + 1] for cell in above.cells for word in folded(cell)} | words
        numbers = [columns[cell] for cell in sorted(columns)]
        rises = numbers[0].start < numbers[-1].start
        is_bytes = bool(words & _BYTES) or (not words & _BITS and rises and bool(said & _BYTES))
        if not is_bytes and rises and not said & _BITS:
            continue
        return Grid(row, columns, 8 if is_bytes else 1, _roles(row.cells, columns, profile)), rows[index + 1 :]
    return None


def is_heading(row: Row) -> bool:
    """Whether a row of a text is surely the heading row of a grid: numbers in a row behind words, or all of them words."""
    columns, words = _columns(row.cells)
    others = [cell for index, cell in enumerate(row.cells) if cell and index not in columns]
    return (
        _width(columns) >= FEWEST
        and len(columns) > 1
        and (bool(words) or (bool(others) and not any(c.isdigit() for cell in others for c in cell)))
    )


def _columns(cells: list[str]) -> tuple[dict[int, range], set[str]]:
    """The longest run of cells that number columns one by one, ``Byte0~Byte1`` two at once, and the words before the
    numbers."""
    best: dict[int, range] = {}
    words: set[str] = set()
    here: dict[int, range] = {}
    for index, cell in enumerate([*cells, ""]):
        match = _COLUMN.match(plain(cell))
        numbered = _numbers(match)
        last = here.get(index - 1)
        if here and (last is None or numbered is None or not _follows(list(here.values()), numbered)):
            best = max(best, here, key=_width)
            here = {}
        if numbered is not None and match is not None:
            here[index] = numbered
            words |= {match["word"].casefold()} if match["word"] else set()
    return best, words


def _numbers(match: re.Match[str] | None) -> range | None:
    if match is None:
        return None
    first, last = sorted((int(match["n"]), int(match["m"] or match["n"])))
    return range(first, last + 1)


def _follows(before: list[range], numbered: range) -> bool:
    """Whether numbers go on counting up, or down, behind those before."""
    rises, falls = numbered.start == before[-1].stop, numbered.stop == before[-1].start
    return (rises or falls) and (len(before) == 1 or rises == (before[-1].start == before[-2].stop))


def _width(columns: dict[int, range]) -> int:
    return sum(len(numbered) for numbered in columns.values())


def _roles(cells: list[str], columns: dict[int, range], profile: Profile) -> dict[str, int]:
    made: dict[str, int] = {}
    for role, titles in profile.registers.items():
        for index, cell in enumerate(cells):
            if index not in columns and index not in made.values() and folded(cell) in titles:
                made[role] = index
                break
    return made


def read(
    grid: Grid, rows: list[Row], table: Table, profile: Profile, about: Around, troubles: list[Trouble]
) -> list[ReadMessage]:
    """A message for each row that has an address, else one for the grid; none where nothing gives it an id."""
    said = around.read(about, profile)
    if "address" not in grid.roles and not said.ids:
        return []
    troubles.append(Trouble("IMP026", f"{table.title}: a grid prints no types", table.spot,
                            "one bit is held as bool, the rest as uint; look at the page"))  # fmt: skip
    _unread_columns(grid, rows, table, troubles)
    if "address" in grid.roles:
        made = []
        for row in rows:
            if any(row.cells) and (message := _register(grid, row, table, profile, troubles)):
                made.append(message)
        return made
    message = ReadMessage("", "", table, names=[table.caption] if table.caption else [])
    message.register_bits = grid.count if grid.unit == 1 else None
    take(message, said)
    for index, row in enumerate(row for row in rows if any(row.cells)):
        label = next((n for cell in row.cells[: min(grid.columns)] if (n := _label(cell)) is not None), index)
        message.fields += _fields(grid, row, table, 0 if grid.unit == 8 else label * grid.count, profile, troubles)
    message.length = max((f.end + 7) // 8 for f in message.fields) if message.fields else None
    return [message]


def _unread_columns(grid: Grid, rows: list[Row], table: Table, troubles: list[Trouble]) -> None:
    """Says which columns are neither of the grid nor have a role, so that their cells are not held."""
    spread = [_spread(grid, row) for row in rows]
    for index, title in enumerate(grid.row.cells):
        if index in grid.columns or index in grid.roles.values():
            continue
        cells = [text for row in spread if (text := row.get(index, "")) and _label(text) is None]
        if cells:
            numbered = any(c.isdigit() for c in title)
            what = "numbers no column of the grid" if numbered else "has no role"
            troubles.append(Trouble("IMP027", f"{table.title}: the heading `{title[:40]}` {what}, its cells were left out: "
                                    f"`{cells[0][:40]}`" + (f" and {len(cells) - 1} more" if cells[1:] else ""), table.spot,
                                    "look at the page", "error" if numbered else "warning"))  # fmt: skip


def _label(cell: str) -> int | None:
    match = _COLUMN.match(plain(cell))
    return int(match["n"]) if match else None


def _register(grid: Grid, row: Row, table: Table, profile: Profile, troubles: list[Trouble]) -> ReadMessage | None:
    cells = _spread(grid, row)
    address = plain(cells.get(grid.roles["address"], ""))
    value = around.value(address) if _ADDRESS.match(address) else None
    name = cells.get(grid.roles.get("name", -1), "")
    if value is None:
        troubles.append(Trouble("IMP023", f"{table.title}: the row `{row.shown[:80]}` has no address", table.spot_of(row),
                                "the row was left out", "error"))  # fmt: skip
        return None
    message = ReadMessage("", "", table, names=[name] if name else [])
    message.register_bits = grid.count if grid.unit == 1 else None
    access = "".join(folded(cells.get(grid.roles.get("access", -1), "")))
    take(message, Said(name or f"Register {address}", (str(value),), _ACCESS.get(access, "")))
    message.fields = _fields(grid, row, table, 0, profile, troubles)
    message.length = (grid.count * grid.unit + 7) // 8
    return message


def _spread(grid: Grid, row: Row) -> dict[int, str]:
    """The text of each column of the grid that begins a cell of the row."""
    return {first: text for first, _, text in _cells(grid, row)}


def _cells(grid: Grid, row: Row) -> list[tuple[int, int, str]]:
    """First and last column of each cell: by its edges on the page; without them an empty cell goes on from the left."""
    made: list[tuple[int, int, str]] = []
    if row.edges and grid.row.edges:
        for text, (left, right) in zip(row.cells, pairwise(row.edges), strict=False):
            covered = [
                index for index, (a, b) in enumerate(pairwise(grid.row.edges))
                if min(b, right) - max(a, left) > 0.5 * (b - a)
            ]  # fmt: skip
            if covered:
                made.append((covered[0], covered[-1], text))
        return made
    for index, text in enumerate(row.cells):
        inside = index in grid.columns and index - 1 in grid.columns
        if not text and inside and made and made[-1][2]:
            made[-1] = (made[-1][0], index, made[-1][2])
        else:
            made.append((index, index, text))
    return made


def _fields(
    grid: Grid, row: Row, table: Table, start: int, profile: Profile, troubles: list[Trouble]
) -> list[ReadField]:  # fmt: skip
    made = []
    for first, last, text in _cells(grid, row):
        name, scale = scaled_name(_INDEX.sub("", plain(text)))
        over = [grid.columns[i] for i in range(first, last + 1) if i in grid.columns]
        numbers = [number for numbered in over for number in numbered]
        if not numbers or not name or name in ("-", "–", "0", "1") or folded(name) in profile.reserved:
            continue
        if len(over) != last - first + 1:
            troubles.append(Trouble("IMP023", f"{table.title}: the cell `{text[:60]}` stands over columns of two kinds",
                                    table.spot_of(row), "the cell was left out", "error"))  # fmt: skip
            continue
        lowest = min(numbers) - (min(n.start for n in grid.columns.values()) if grid.unit == 8 else 0)
        bits = len(numbers) * grid.unit
        at = start + lowest * grid.unit
        if bits > 64:
            troubles.append(Trouble("IMP037", f"{table.title}: `{name}` has {bits} bits, which no number has",
                                    table.spot_of(row), "the cell was left out", "error"))  # fmt: skip
            continue
        kind = "bool" if bits == 1 else "uint"
        made.append(ReadField(name, at, bits, kind, scaled(scale), table.spot_of(row)))
    return made
