"""Compare the physical value of every raw value of every scaled field in every
language.

Run ``python -m tests.conformance.physical``. It tests all values of fields of up to 16
bits; for wider fields the extremes and a million random values. Each double must equal
that of the reference codec to the last bit, and setting it must return the raw value.
Ends with status 0 if everything agrees.
"""

from __future__ import annotations

import argparse
import json
import random
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from icdgen import codec
from icdgen.icd.layout import Scalar
from icdgen.icd.model import Icd, Message
from icdgen.icd.places import NodePlace
from icdgen.vectors.settings import bits_of
from tests.conformance.build import BuildError, build
from tests.conformance.driver import Testee
from tests.conformance.icds import icd_of
from tests.conformance.languages import TESTEE, all_languages
from tests.conformance.reference import comes_back

CHUNK = 65536


@dataclass
class Total:
    """Result of one language."""

    name: str
    fields: int = 0
    values: int = 0
    differences: int = 0
    not_back: int = 0
    seconds: float = 0.0


@dataclass(frozen=True)
class Chunk:
    """Raw values of one kind of field in the form of a sweep request, and the expected
    answer.
    """

    request: dict
    raw: tuple[int, ...]
    physical: str
    failures: int


def scaled_fields(icd: Icd) -> Iterator[tuple[Message, NodePlace]]:
    for node in icd.nodes:
        for message in node.messages:
            for field in message.fields:
                if field.has_formula and field.is_invertible and not field.is_read_only:
                    yield message, field


def chunks(
    field: NodePlace, count: int, exhaustive_bits: int, near: int = 1000
) -> list[Chunk]:
    """Return all raw values to test for a field. Fields of one kind share them."""
    return _chunks(
        field.scale, field.curve, field.type, field.bits, count, exhaustive_bits, near
    )


@cache
def _chunks(
    scale, curve, type_: str, bits: int, count: int, exhaustive_bits: int, near: int
) -> list[Chunk]:
    field = Scalar(name="any", at=0, bits=bits, type=type_, scale=scale, curve=curve)
    low, high = field.raw_min, field.raw_max
    if bits <= exhaustive_bits:
        return [_chunk(field, {"from": low, "to": high}, tuple(range(low, high + 1)))]
    source = random.Random(f"{scale or curve}/{type_}/{bits}")
    edges = [
        raw
        for middle in (low, 0, high)
        for raw in range(middle - near, middle + near + 1)
        if low <= raw <= high
    ]
    values = edges + [source.randint(low, high) for _ in range(count)]
    values += [
        raw
        for shift in range(bits)
        for raw in (1 << shift, -(1 << shift))
        if low <= raw <= high
    ]
    parts = (tuple(values[at : at + CHUNK]) for at in range(0, len(values), CHUNK))
    return [_chunk(field, {"values": part}, part) for part in parts]


def _chunk(field: NodePlace, request: dict, raw: tuple[int, ...]) -> Chunk:
    doubles = [codec.physical_double(field, value) for value in raw]
    failures = sum(
        not comes_back(field, raw_value, value)
        for raw_value, value in zip(raw, doubles, strict=True)
    )
    return Chunk(request, raw, "".join(map(bits_of, doubles)), failures)


def sweep(
    testee: Testee,
    total: Total,
    message: Message,
    field: NodePlace,
    chunk: Chunk,
    notes: list[str],
) -> None:
    """Send one sweep request and compare the answer."""
    about = {
        "node": message.node,
        "kind": message.kind,
        "id": message.ids[0],
        "message": message.name,
        "field": field.name,
    }
    request = {"op": "sweep", **about, **chunk.request}
    start = time.perf_counter()
    (line,) = testee.ask([json.dumps(request).encode()])
    total.seconds += time.perf_counter() - start
    answer = json.loads(line) if line else {}
    total.values += len(chunk.raw)
    where = f"{message.node} {message.name!r} {field.name!r}"
    if answer.get("ok") is not True or len(answer.get("physical", "")) != len(
        chunk.physical
    ):
        total.differences += len(chunk.raw)
        notes.append(f"{where}: {str(answer)[:200]}")
        return
    if answer["physical"] != chunk.physical:
        for index, raw in enumerate(chunk.raw):
            expected, actual = (
                text[index * 16 : index * 16 + 16]
                for text in (chunk.physical, answer["physical"])
            )
            if expected != actual:
                total.differences += 1
                notes.append(f"{where}: raw {raw} is {actual}, not {expected}")
    total.not_back += answer["failures"]
    if answer["failures"] != chunk.failures:
        total.differences += abs(answer["failures"] - chunk.failures)
        notes.append(
            f"{where}: {answer['failures']} values do not come back, expected {chunk.failures}"
        )


def run(
    names: list[str], icd: Icd, count: int, exhaustive_bits: int = 16, near: int = 1000
) -> tuple[list[Total], list[str]]:
    """Return the totals and a description of the first differences. Raises
    `BuildError`.

    All values of fields of up to ``exhaustive_bits`` bits are tested; of wider fields
    ``count`` random values and those ``near`` 0 and the ends of the range.
    """
    languages = all_languages()
    totals, notes = [Total(name) for name in names], []
    testees = [Testee(build(languages[name], icd)) for name in names]
    for message, field in scaled_fields(icd):
        for total, testee in zip(totals, testees, strict=True):
            total.fields += 1
            for chunk in chunks(field, count, exhaustive_bits, near):
                differences: list[str] = []
                sweep(testee, total, message, field, chunk, differences)
                notes += [f"{total.name}: {note}" for note in differences[:5]]
    for testee in testees:
        testee.close()
    return totals, notes


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.conformance.physical", description=__doc__
    )
    parser.add_argument(
        "--lang", default="c,python,rust", help="comma-separated (default: %(default)s)"
    )
    parser.add_argument(
        "--random",
        type=int,
        default=1_000_000,
        help="values of each wider field (default: %(default)s)",
    )
    parser.add_argument(
        "icds", nargs="*", type=Path, help="ICDs: files or folders (default: icd/)"
    )
    options = parser.parse_args(arguments)
    languages = all_languages()
    for name in options.lang.split(","):
        if name not in languages or languages[name].kind != TESTEE:
            parser.error(f"{name} has no testee")
        if languages[name].missing():
            parser.error(f"{name} needs {', '.join(languages[name].missing())}")
    try:
        totals, notes = run(
            options.lang.split(","), icd_of(options.icds), options.random
        )
    except (BuildError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    for note in notes[:50]:
        print(note)
    print(
        f"{'language':12}{'fields':>8}{'values':>14}{'differences':>14}{'not back':>10}{'seconds':>9}"
    )
    for t in totals:
        print(
            f"{t.name:12}{t.fields:8,}{t.values:14,}{t.differences:14,}{t.not_back:10,}{t.seconds:9.1f}"
        )
    return 1 if any(t.differences for t in totals) else 0


if __name__ == "__main__":
    sys.exit(main())
