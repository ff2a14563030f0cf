"""Tables of a link: constants of the generated C, and the expressions that refer to
them.

`TableSet` is the base class of the tables of links and of procedures. C needs a
declaration before its use, so each method declares its table and returns the expression
that refers to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from icdgen.backends.c import names
from icdgen.backends.c.facts import TYPES, TableRow, fact_value
from icdgen.backends.c.text import comment, plain
from icdgen.backends.lines import STEP, in_rows
from icdgen.describe.links import Assumptions, LinkDescription, byte_table
from icdgen.frozen import NamedTuple
from icdgen.protocol.declared import FactKind, facts_of
from icdgen.protocol.sections import ChecksumAlgorithm, Crc

NODE_PREFIX = "icdgen_node_"
"""Prefix of the tables of all nodes."""


def algorithm_table(checksum: str) -> str:
    """Return the name of the table with the algorithm of a checksum."""
    return f"checksum_{names.checksum_word(checksum)}"


class Table(NamedTuple):
    """Constant of the link."""

    comment: str
    type: str
    name: str
    rows: Sequence[str]
    unless: str = ""  # macro that omits the table


class TableSet:
    """Tables of one function.

    Each method declares a table and returns the expression that refers to it.
    """

    def __init__(
        self, link: LinkDescription, assumed: Assumptions, prefix: str = ""
    ) -> None:
        self.link, self.facts_of_link, self.assumed = link, link.facts, assumed
        self.prefix = prefix  # of all names
        self.tables: list[Table] = []
        self._shared: dict[tuple[str, tuple[str, ...]], str] = {}

    def add(
        self,
        name: str,
        type: str,
        rows: Iterable[str | TableRow],
        assumed: Iterable[tuple[str, str]] = (),
    ) -> str:
        """Declare a table, with a comment on assumed facts: their keys and reasons."""
        table = self.table(f"{self.prefix}{name}", type, rows, assumed)
        self.tables.append(table)
        return f"&{table.name}"

    def table(
        self,
        name: str,
        type: str,
        rows: Iterable[str | TableRow],
        assumed: Iterable[tuple[str, str]] = (),
    ) -> Table:
        """Return a table, with a comment on assumed facts."""
        about = " ".join(f"Assumed {plain(f'{key}: {why}')}" for key, why in assumed)
        return Table(
            comment([about], STEP) if about else "", type, name, list(map(str, rows))
        )

    def array(self, name: str, type: str, rows: Iterable[str | TableRow]) -> str:
        """Declare an array; return NULL if it is empty."""
        items = [row if isinstance(row, TableRow) else TableRow(row) for row in rows]
        # The name of an array is its address: `&rows[]` becomes `rows`.
        return self.add(f"{name}[]", type, items).strip("&[]") if items else "NULL"

    def numbers(self, name: str, type: str, numbers: Iterable[str], count: int) -> str:
        """Declare an array of numbers, ``count`` per line; return NULL if it is empty."""
        rows = in_rows(numbers, count)
        return self.add(f"{name}[]", type, rows).strip("&[]") if rows else "NULL"

    def shared(self, name: str, type: str, rows: Iterable[str]) -> str:
        """Declare an array with a number in its name, unless an array of these rows is
        declared; return NULL if it is empty.
        """
        items = tuple(rows)
        number = len([other for other, _ in self._shared if other == name])
        # Many exchanges refer to the same places and echoes. Each table exists once in
        # the memory of the target.
        if items and (name, items) not in self._shared:
            self._shared[name, items] = self.array(f"{name}_{number}", type, items)
        return self._shared.get((name, items), "NULL")

    def part(self, name: str, part: object, *further: TableRow) -> str:
        """Declare the table of a part: its facts, then further rows.

        Return NULL for None.
        """
        if part is None:
            return "NULL"
        return self.add(
            name,
            TYPES[type(part)],
            [*self.facts(name, part), *further],
            self.assumed.of_part(part),
        )

    def facts(self, name: str, part: object) -> list[TableRow]:
        """Return a row for each declared fact."""
        rows = []
        for fact in facts_of(part):
            value, text = getattr(part, fact.name), fact.name
            about = f"{text} in ms" if fact.kind is FactKind.TIME else text
            rows.append(TableRow(fact_value(fact, value), about))
        return rows

    def values(self, name: str, part: object) -> str:
        """Return the facts of a part as one row."""
        return ", ".join(row.value for row in self.facts(name, part))

    def algorithm(self, algorithm: ChecksumAlgorithm) -> str:
        """Return the expression that refers to the algorithm of a checksum, which is a
        table of the node.
        """
        node = self.facts_of_link.node.name
        return f"&{NODE_PREFIX}{node}_{algorithm_table(algorithm.name)}"

    def crc(self, name: str, parameters: Crc, is_crc: bool = True) -> str:
        """Return the initialiser of a CRC without braces; the table for whole bytes is
        separate.
        """
        tables = ["NULL", "NULL"]
        if is_crc and parameters.width <= 16:
            entries = (
                f"{value:#0{2 + -(-parameters.width // 4)}x}u"
                for value in byte_table(parameters)
            )
            bits = 8 if parameters.width <= 8 else 16
            tables[bits // 8 - 1] = (
                f"ICDGEN_TABLE({self.numbers(f'{name}_table', f'uint{bits}_t', entries, 8)})"
            )
            # The table that `numbers` declared last.
            self.tables[-1] = self.tables[-1]._replace(unless="ICDGEN_NO_TABLES")
        # Two lines, because the names of tables are long.
        return f"{self.values(name, parameters)},\n{STEP * 2} {', '.join(tables)}"
