"""C functions return correctly rounded physical values, and set the nearest raw value.

The tests cover all values of fields of up to 16 bits, and extremes and random values of
wider ones. The reference codec computes the expected values.
"""

from __future__ import annotations

import math
import random
import struct
import subprocess
from array import array
from collections import defaultdict
from fractions import Fraction
from math import lcm
from pathlib import Path

import jinja2
import pytest

from icdgen import codec
from icdgen.backends.c.names import stem
from icdgen.backends.c.types import type_of
from icdgen.describe import FieldDescription, describe
from icdgen.describe.accessors import accessors_of
from icdgen.icd.model import Icd
from icdgen.icd.places import NodePlace
from tests.c import harness, odd

REFUSED = 0x5245465553454421


def test_scaled_fields_of_the_shipped_icds_are_exact(tmp_path):
    compared = compare(harness.shipped(), tmp_path)
    assert compared > 30_000_000


@pytest.mark.parametrize("option", ["-O2", "-ffast-math", "-mfpmath=387"])
def test_odd_scales_are_exact_with_any_arithmetic_of_the_compiler(tmp_path, option):
    folder = tmp_path / "icd"
    folder.mkdir()
    assert (
        compare(harness.read_unchecked(*odd.write(folder)), tmp_path, option, wide=300)
        > 100_000
    )


def compare(icd: Icd, folder: Path, *options: str, wide: int = 4000) -> int:
    """Compare C with the reference codec; fail on any difference.

    Returns the number of comparisons.
    """
    scaled = [
        f
        for node in describe(icd).nodes
        for message in node.messages
        for f in message.fields
        if f.steps
    ]
    harness.generate(icd, folder)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(harness.HERE),
        trim_blocks=True,
        lstrip_blocks=True,
    )
    template = environment.get_template("physical.c.j2")
    nodes = [node.name for node in icd.nodes]
    source = folder / "physical.c"
    source.write_text(
        template.render(nodes=nodes, fields=[row(field) for field in scaled])
    )
    program = harness.compile(
        source, "-std=c99", "-O2", *options, "-fsanitize=undefined", "-fno-sanitize-recover=all",
        f"-I{folder}", output=folder / "physical",
    )  # fmt: skip
    alike = defaultdict(list)
    for number, description in enumerate(scaled):
        alike[description.steps, description.model.bits, description.storage].append(
            number
        )
    with subprocess.Popen(
        [program], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        for numbers in alike.values():
            field = scaled[numbers[0]].model
            process.stdin.write(
                struct.pack(f"<H{len(numbers)}H", len(numbers), *numbers)
            )
            for table in tables(field, wide):
                process.stdin.write(table)
        out = process.communicate()[0].decode()
    assert process.returncode == 0, out
    return int(out.split()[0])


def row(field: FieldDescription) -> dict[str, object]:
    name = stem(field.message)
    keys = {
        "type": f"{name}_t",
        "name": field.name,
        "storage": type_of(field),
        "exact": str(_survives(field.model)).lower(),
        "getter": f"{name}_{field.physical_name}",
        "setter": f"{name}_set_{field.physical_name}",
        "get_whole": None,
    }
    for accessor in accessors_of(field, "integer"):
        keys["get_whole"] = f"{name}_{accessor.name}"
        keys["set_whole"] = f"{name}_set_{accessor.name}"
        keys["whole"] = f"int{accessor.integer_access.bits}_t"
    return keys


def _survives(field: NodePlace) -> bool:
    """Report whether each raw value survives a round trip through its double.

    It does if all physical values of the field have different doubles.
    """
    ends = (
        field.scale.physical(raw) / field.scale.factor
        for raw in (field.raw_min, field.raw_max)
    )
    return max(map(abs, ends)) < 2**52


def tables(field: NodePlace, wide: int):
    """Yield tables of expected values for the test program, as bytes.

    A field of more than 16 bits has ``wide`` values.
    """
    generator = random.Random(f"{field.scale}{field.bits}")
    raws = raw_values(field, wide, generator)
    denominator = lcm(field.scale.factor.denominator, field.scale.offset.denominator)
    factor, offset = (
        int(field.scale.factor * denominator),
        int(field.scale.offset * denominator),
    )
    doubles = array("d", [(raw * factor + offset) / denominator for raw in raws])
    for raw in generator.sample(raws, min(300, len(raws))):
        assert (
            codec.physical_double(field, raw) == (raw * factor + offset) / denominator
        )
    yield table(words(raws), doubles.tobytes())
    values = physical_values(field, wide // 10, generator)
    yield table(
        array("d", values).tobytes(),
        words([set_by_codec(field, value) for value in values]),
    )
    per = next(
        (
            per
            for per in (1000, 10**6)
            if (per * factor) % denominator == (per * offset) % denominator == 0
        ),
        None,
    )
    integers = (
        [(raw * factor + offset) * per // denominator for raw in raws] if per else []
    )
    if not per or not all(-(2**63) <= value < 2**63 for value in integers):
        yield table(b"", b"")
        yield table(b"", b"")
        return
    yield table(words(raws), words(integers))
    small = all(
        -(2**31) <= field.scale.physical(end) * per < 2**31
        for end in storage_ends(field)
    )
    low, high = (-(2**31), 2**31 - 1) if small else (-(2**63), 2**63 - 1)
    numbers = [
        value
        for value in integer_values(field, per, wide // 10, generator)
        if low <= value <= high
    ]
    yield table(
        words(numbers),
        words([set_by_codec(field, Fraction(value, per)) for value in numbers]),
    )


def storage_ends(field: NodePlace) -> tuple[int, int]:
    bits = next(b for b in (8, 16, 32, 64) if field.bits <= b)
    return (
        (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
        if field.is_signed
        else (0, (1 << bits) - 1)
    )


def table(keys: bytes, values: bytes) -> bytes:
    return struct.pack("<I", len(keys) // 8) + keys + values


def words(values: list[int]) -> bytes:
    return array("Q", [value & 0xFFFFFFFFFFFFFFFF for value in values]).tobytes()


def set_by_codec(field: NodePlace, value: float | Fraction) -> int:
    try:
        return codec.raw_from_physical(field, value)
    except codec.CodecError:
        return REFUSED


def raw_values(field: NodePlace, wide: int, source: random.Random) -> list[int]:
    if field.bits <= 16:
        return list(range(field.raw_min, field.raw_max + 1))
    near = [
        field.raw_min,
        field.raw_min + 1,
        -1,
        0,
        1,
        field.raw_max - 1,
        field.raw_max,
    ]
    near = [raw for raw in near if field.raw_min <= raw <= field.raw_max]
    small = [
        source.getrandbits(source.randint(1, field.bits)) + field.raw_min
        for _ in range(wide // 2)
    ]
    return (
        near
        + small
        + [source.randint(field.raw_min, field.raw_max) for _ in range(wide // 2)]
    )


def physical_values(field: NodePlace, count: int, source: random.Random) -> list[float]:
    """Return doubles at and near ties, at and beyond the limits, and special values."""
    values = [
        math.nan,
        -math.nan,
        math.inf,
        -math.inf,
        0.0,
        -0.0,
        5e-324,
        -5e-324,
        2.2e-308,
        1.7e308,
        -1.7e308,
    ]
    values += [
        2.0**exponent * sign for exponent in range(-70, 130, 3) for sign in (1, -1)
    ]
    raws = [field.raw_min, field.raw_max] * 3 + [
        source.randint(field.raw_min, field.raw_max) for _ in range(count)
    ]
    for raw in raws:
        for part in (
            Fraction(1, 2),
            Fraction(-1, 2),
            Fraction(0),
            Fraction(source.randint(-99, 99), 100),
        ):
            exact = field.scale.physical(raw + part)
            nearest = exact.numerator / exact.denominator
            values += [
                nearest,
                math.nextafter(nearest, math.inf),
                math.nextafter(nearest, -math.inf),
            ]
    return values


def integer_values(
    field: NodePlace, per: int, count: int, source: random.Random
) -> list[int]:
    values = [0, 1, -1, 2**31 - 1, -(2**31), 2**63 - 1, -(2**63)]
    raws = [field.raw_min, field.raw_max] * 3 + [
        source.randint(field.raw_min, field.raw_max) for _ in range(count)
    ]
    for raw in raws:
        for part in (
            Fraction(1, 2),
            Fraction(-1, 2),
            Fraction(source.randint(-99, 99), 100),
        ):
            middle = math.floor(field.scale.physical(raw + part) * per)
            values += [middle - 1, middle, middle + 1]
    return values
