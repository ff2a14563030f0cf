"""Tables of a link: constants of the generated C, and the expressions that refer to
them.

`TableSet` is the base class of the tables of links and of procedures. C needs a
declaration before its use, so each method `declare...` adds a table to `tables` and
returns the expression that refers to it.
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
"""Start of the name of each table of a node."""


def algorithm_table_name(checksum: str) -> str:
    """Return the name of the table with the algorithm of a checksum, without
    `NODE_PREFIX` and the name of the node.
    """
    return f"checksum_{names.checksum_word(checksum)}"


class Table(NamedTuple):
    """Constant of the generated C."""

    comment: str
    type: str
    name: str  # in its declaration: of an array with "[]"
    rows: Sequence[str]
    unless: str = ""  # macro that omits the table


class TableSet:
    """Tables of one C scope: of a file, with a prefix for their names, or of a
    function, without a prefix.
    """

    def __init__(
        self, link: LinkDescription, assumptions: Assumptions, prefix: str = ""
    ) -> None:
        self.link, self.facts, self.assumptions = link, link.facts, assumptions
        self.prefix = prefix  # of all names
        self.tables: list[Table] = []
        self._declared_once: dict[tuple[str, tuple[str, ...]], str] = {}

    def declare(
        self,
        name: str,
        type: str,
        rows: Iterable[str | TableRow],
        reasons: Iterable[tuple[str, str]] = (),
        unless: str = "",
    ) -> str:
        """Declare a table; return its address.

        ``reasons``: keys of the assumed facts in it and why they are assumed, for a
        comment. ``unless``: macro that omits the table.
        """
        table = self.table_of_rows(f"{self.prefix}{name}", type, rows, reasons)
        self.tables.append(table._replace(unless=unless))
        return f"&{table.name}"

    def table_of_rows(
        self,
        name: str,
        type: str,
        rows: Iterable[str | TableRow],
        reasons: Iterable[tuple[str, str]] = (),
    ) -> Table:
        """Return a table without declaring it. Parameters as of `declare`."""
        about = " ".join(f"Assumed {plain(f'{key}: {why}')}" for key, why in reasons)
        return Table(
            comment([about], STEP) if about else "", type, name, list(map(str, rows))
        )

    def declare_array(
        self, name: str, type: str, rows: Iterable[str | TableRow]
    ) -> str:
        """Declare an array; return its name, or NULL without declaring it if it is
        empty.
        """
        items = [row if isinstance(row, TableRow) else TableRow(row) for row in rows]
        if not items:
            return "NULL"
        self.declare(f"{name}[]", type, items)
        # In C, the name of an array is its address.
        return f"{self.prefix}{name}"

    def declare_numbers(
        self,
        name: str,
        type: str,
        numbers: Iterable[str],
        count: int,
        unless: str = "",
    ) -> str:
        """Declare an array of numbers, ``count`` per line; return its name, or NULL
        without declaring it if it is empty.
        """
        rows = in_rows(numbers, count)
        if not rows:
            return "NULL"
        self.declare(f"{name}[]", type, rows, unless=unless)
        return f"{self.prefix}{name}"

    def declare_once(self, name: str, type: str, rows: Iterable[str]) -> str:
        """Declare an array with a number in its name, unless an array of these rows is
        declared; return its name, or NULL if it is empty.
        """
        items = tuple(rows)
        number = len([other for other, _ in self._declared_once if other == name])
        # Many exchanges refer to the same places and echoes. Each table exists once in
        # the memory of the target.
        if items and (name, items) not in self._declared_once:
            self._declared_once[name, items] = self.declare_array(
                f"{name}_{number}", type, items
            )
        return self._declared_once.get((name, items), "NULL")

    def declare_section(self, name: str, section: object, *further: TableRow) -> str:
        """Declare the table of a section of the protocol: its facts, then further
        rows. Return its address, or NULL for None.
        """
        if section is None:
            return "NULL"
        return self.declare(
            name,
            TYPES[type(section)],
            [*self.rows_of_facts(section), *further],
            # `Assumptions` returns each reason once, so it is in no other comment.
            self.assumptions.of_part(section),
        )

    def rows_of_facts(self, section: object) -> list[TableRow]:
        """Return a row for each declared fact of a section."""
        rows = []
        for fact in facts_of(section):
            value, text = getattr(section, fact.name), fact.name
            about = f"{text} in ms" if fact.kind is FactKind.TIME else text
            rows.append(TableRow(fact_value(fact, value), about))
        return rows

    def values_of_facts(self, section: object) -> str:
        """Return the facts of a section in one row."""
        return ", ".join(row.value for row in self.rows_of_facts(section))

    def pointer_to_algorithm(self, algorithm: ChecksumAlgorithm) -> str:
        """Return the address of the algorithm of a checksum, which is a table of the
        node. `_LinkTables` declares it.
        """
        node = self.facts.node.name
        return f"&{NODE_PREFIX}{node}_{algorithm_table_name(algorithm.name)}"

    def declare_crc(self, name: str, parameters: Crc, is_crc: bool) -> str:
        """Declare the lookup table of a CRC; return the initialiser of its parameters,
        without braces.

        The table has an entry for each byte. A CRC of more than 16 bits has no table,
        nor has another kind of checksum.
        """
        pointers = ["NULL", "NULL"]  # to entries of 8 and of 16 bits
        if is_crc and parameters.width <= 16:
            entries = (
                f"{value:#0{2 + -(-parameters.width // 4)}x}u"
                for value in byte_table(parameters)
            )
            bits = 8 if parameters.width <= 8 else 16
            table = self.declare_numbers(
                f"{name}_table", f"uint{bits}_t", entries, 8, unless="ICDGEN_NO_TABLES"
            )
            pointers[bits // 8 - 1] = f"ICDGEN_TABLE({table})"
        # Two lines, because the names of tables are long.
        return f"{self.values_of_facts(parameters)},\n{STEP * 2} {', '.join(pointers)}"
