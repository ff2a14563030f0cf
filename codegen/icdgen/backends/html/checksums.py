"""Checksums of a node on the page of its protocol.

Each has its parameters and its value of the characters ``123456789``, by which a reader
can compare it with a catalogue of CRCs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from icdgen.backends.html.all_facts import FactRow, value_text
from icdgen.backends.html.texts import capitalized
from icdgen.frozen import NamedTuple
from icdgen.icd.checksum import CRC, FLETCHER, FLETCHER_255, SUM, XOR
from icdgen.protocol.declared import facts_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import ChecksumAlgorithm, Crc

_KINDS = {
    FLETCHER: "Fletcher's, sums modulo 256",
    FLETCHER_255: "Fletcher's, sums modulo 255",
    SUM: "sum of the bytes",
    XOR: "exclusive or of the bytes",
}
_OF_ALL_KINDS = ("width", "init", "xor_out")


class NodeChecksum(NamedTuple):
    """Checksum with its parameters, and its value of the characters 123456789."""

    name: str
    rows: list[FactRow]
    check: str


def of_node(node_facts: Facts, section: Mapping[str, Any]) -> list[NodeChecksum]:
    """Return the checksums of a node in the order of the ICD."""
    sums = []
    for algorithm in node_facts.checksums.values():
        check = section["link"]["checksums"][algorithm.name].get("check")
        shown = "" if check is None else f"0x{check:X}"
        sums.append(NodeChecksum(algorithm.name, [*_rows(algorithm)], shown))
    return sums


def _rows(algorithm: ChecksumAlgorithm) -> Iterator[FactRow]:
    yield FactRow("Kind", _KINDS.get(algorithm.kind, f"CRC-{algorithm.crc.width}"))
    for fact in facts_of(Crc):
        value = getattr(algorithm.crc, fact.name)
        has_fact = algorithm.kind == CRC or fact.name in _OF_ALL_KINDS
        if has_fact and value is not None:
            yield FactRow(capitalized(fact.about), value_text(fact, value))
    if algorithm.seeds:
        seeds = (f"{message} {seed}" for message, seed in algorithm.seeds.items())
        yield FactRow("A byte after all others, by message", ", ".join(seeds))
