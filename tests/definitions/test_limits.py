"""Limits of files that are imported: each accepts its own value and refuses the next."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from icdgen.definitions import can, eds, kinds, mavlink, run, sunspec, xtce
from icdgen.diagnostics import Findings
from tests.definitions import test_eds as eds_files
from tests.definitions import test_kaitai as kaitai_files
from tests.definitions import test_xtce as xtce_files
from tests.limits import assert_limits

Text = Callable[[int], str]
Case = tuple[str, Text, int | None, int | None]
"""Words of the complaint, the file for a number, and the ends."""


def complaints(path: Path, reader: object) -> str:
    """Return the messages of all findings of an import."""
    try:
        read = run.read(path, reader)
    except Findings as findings:
        return "\n".join(finding.message for finding in findings.findings)
    return "\n".join(each.message for each in read.definitions.import_findings)


def assert_case(case: Case, path: Path, reader: object) -> None:
    words, text, least, most = case

    def is_accepted(number: int) -> bool:
        path.write_text(text(number))
        return words not in complaints(path, reader)

    assert_limits(is_accepted, least=least, most=most)


def xtce_bits(bits: int) -> str:
    byte = xtce_files.BYTE.replace("Encoding", f'Encoding sizeInBits="{bits}"')
    return xtce_files.system(xtce_files.container("A"), byte)


def xtce_repeated(count: int) -> str:
    repeat = (
        f"<RepeatEntry><Count><FixedValue>{count}</FixedValue></Count></RepeatEntry>"
    )
    return xtce_files.system(xtce_files.container("A", xtce_files.entry(repeat)))


def xtce_label(last: int) -> str:
    labels = f'<Enumeration value="1" maxValue="{last}" label="A"/>'
    inner = f'<IntegerDataEncoding sizeInBits="16"/><EnumerationList>{labels}</EnumerationList>'
    byte = xtce_files.type_("Enumerated", inner)
    return xtce_files.system(xtce_files.container("A"), byte)


def xtce_polynomial(power: int) -> str:
    terms = f'<Term coefficient="2" exponent="{power}"/>'
    calibrator = f"<DefaultCalibrator><PolynomialCalibrator>{terms}</PolynomialCalibrator></DefaultCalibrator>"
    inner = f"<IntegerDataEncoding>{calibrator}</IntegerDataEncoding>"
    byte = xtce_files.type_("Float", inner)
    return xtce_files.system(xtce_files.container("A"), byte)


def xtce_fixed(bits: int) -> str:
    entry = f'<FixedValueEntry sizeInBits="{bits}" binaryValue="1"/>'
    return xtce_files.system(xtce_files.container("A", entry + xtce_files.ENTRY))


def xtce_nested(depth: int) -> str:
    inner = xtce_files.container(f"C{depth - 1}")
    return xtce_files.system(xtce_files.nested(depth - 1, 1) + inner)


def xtce_systems(depth: int) -> str:
    system = xtce_files.system(xtce_files.container("A"))
    return '<SpaceSystem name="a">' * depth + system + "</SpaceSystem>" * depth


XTCE: dict[str, Case] = {
    "bits of an integer": ("an integer has", xtce_bits, 1, 64),
    "repetitions": ("is repeated", xtce_repeated, 0, 1024),
    "values of a label": ("has a label for the values", xtce_label, None, 1024),
    "the degree of a polynomial": ("is calibrated by raw^", xtce_polynomial, None, 15),
    "bits of a fixed value": ("a fixed value has", xtce_fixed, 1, 64),
    "fields of a message": (
        "more than 5000 fields",
        lambda count: xtce_files.system(
            xtce_files.container("A", xtce_files.ENTRY * count)
        ),
        None,
        5000,
    ),
    "containers within each other": ("more than 50 containers", xtce_nested, None, 50),
    "systems within the outermost one": (
        "more than 100 systems",
        xtce_systems,
        None,
        100,
    ),
}


@pytest.mark.parametrize("name", XTCE)
def test_a_limit_of_xtce(name, tmp_path):
    assert_case(XTCE[name], tmp_path / "one.xml", xtce.Xtce())


def eds_bits(bits: int) -> str:
    byte = eds_files.integer(f'sizeInBits="{bits}" encoding="unsigned"')
    return eds_files.sheet(eds_files.container("A"), byte)


def eds_array(size: int) -> str:
    types = eds_files.array("many", "w", f'size="{size}"') + eds_files.WORD
    return eds_files.sheet(types + eds_files.container("A", eds_files.entry("many")))


def eds_fixed(value: int) -> str:
    fixed = eds_files.entry(
        "byte", tag="FixedValueEntry", more=f' fixedValue="{value}"'
    )
    return eds_files.sheet(eds_files.container("A", fixed))


def eds_nested(depth: int) -> str:
    inner = eds_files.container(f"C{depth}", eds_files.ENTRY)
    return eds_files.sheet(eds_files.nested(depth, 1) + inner)


EDS: dict[str, Case] = {
    "bits of an integer": ("bits", eds_bits, None, 64),
    "elements of an array": ("is an array of", eds_array, None, 1024),
    "a constant of 8 bits": ("is never", eds_fixed, 0, 255),
    "containers within the outermost one": ("too deep", eds_nested, None, 30),
}


@pytest.mark.parametrize("name", EDS)
def test_a_limit_of_eds(name, tmp_path):
    assert_case(EDS[name], tmp_path / "one.xml", eds.Eds())


def kaitai_nested(depth: int) -> str:
    types = "".join(
        f"  t{n}:\n    seq: [{{id: x, type: {f't{n + 1}' if n < depth - 2 else 'u1'}}}]\n"
        for n in range(depth - 1)
    )
    return kaitai_files.ksy("{id: b, type: t0}", more=f"types:\n{types}")


KAITAI: dict[str, Case] = {
    "bits of an integer": (
        "an integer has",
        lambda bits: kaitai_files.ksy(f"{{id: b, type: b{bits}}}"),
        None,
        64,
    ),
    "bytes behind the first": (
        "at most 65535",
        lambda size: kaitai_files.ksy(f"{{id: b, size: {size}}}"),
        None,
        65534,
    ),
    "repetitions": (
        "it is repeated",
        lambda count: kaitai_files.ksy(
            f"{{id: b, type: u1, repeat: expr, repeat-expr: {count}}}"
        ),
        1,
        1024,
    ),
    "a byte of the contents": (
        "its contents are",
        lambda byte: kaitai_files.ksy(f"{{id: b, contents: [1, {byte}]}}"),
        0,
        255,
    ),
    "types within each other": ("more than 50 types", kaitai_nested, None, 50),
}


@pytest.mark.parametrize("name", KAITAI)
def test_a_limit_of_kaitai(name, tmp_path):
    assert_case(KAITAI[name], tmp_path / "one.ksy", kinds.reader_of_kind("ksy"))


def model(*points: dict[str, object], id: int = 1, depth: int = 0) -> str:
    """Return a model of SunSpec with these points, ``depth`` groups deep."""
    head = [{"name": "ID", "type": "uint16"}, {"name": "L", "type": "uint16"}]
    group: dict[str, object] = {"name": "inner", "points": list(points)}
    for _ in range(depth):
        group = {"name": "g", "points": [], "groups": [group]}
    return json.dumps(
        {
            "id": id,
            "group": {"name": "m", "points": [*head, *points], "groups": [group]},
        }
    )


POINT = {"name": "A", "type": "uint16"}
SUNSPEC: dict[str, Case] = {
    "the id of a model": ("not a model", lambda id: model(POINT, id=id), 0, 65535),
    "registers of a text": (
        "is of the type `string` and size",
        lambda size: model({"name": "A", "type": "string", "size": size}),
        1,
        32767,
    ),
    "groups within each other": (
        "nested more than 8 deep",
        lambda depth: model(POINT, depth=depth - 1),
        None,
        8,
    ),
}


@pytest.mark.parametrize("name", SUNSPEC)
def test_a_limit_of_sunspec(name, tmp_path):
    assert_case(SUNSPEC[name], tmp_path / "one.json", sunspec.SunSpec())


def dialect(id: int) -> str:
    field = '<field type="uint8_t" name="mode">Text.</field>'
    also = f'<message id="1" name="FIRST">{field}</message>' if id != 1 else ""
    return f'<mavlink><messages>{also}<message id="{id}" name="STATE">{field}</message></messages></mavlink>'


@pytest.mark.parametrize(("reader", "most"), [(mavlink.MavLink2(), 0xFFFFFF)])
def test_the_id_of_a_mavlink_message(reader, most, tmp_path):
    assert_case(("its id is", dialect, None, most), tmp_path / "one.xml", reader)


def test_mavlink_1_has_the_messages_with_ids_of_a_byte(tmp_path):
    def has_message(id: int) -> bool:
        (tmp_path / "one.xml").write_text(dialect(id))
        read = run.read(tmp_path / "one.xml", mavlink.MavLink1())
        (tree,) = read.trees.values()
        return "STATE" in [message["name"] for message in tree["messages"]]

    assert_limits(has_message, most=255)


def test_a_dialect_has_at_most_100_files(tmp_path):
    def is_accepted(files: int) -> bool:
        for number in range(files):
            more = f"<include>{number + 1}.xml</include>" * (number + 1 < files)
            message = (
                dialect(number).removeprefix("<mavlink>").removesuffix("</mavlink>")
            )
            (tmp_path / f"{number}.xml").write_text(
                f"<mavlink>{more}{message}</mavlink>"
            )
        return "files" not in complaints(tmp_path / "0.xml", mavlink.MavLink2())

    assert_limits(is_accepted, most=100)


def database(id: int, start: int = 0, bits: int = 8) -> str:
    signal = f' SG_ Speed : {start}|{bits}@1+ (1,0) [0|0] "" Display\n'
    return f'VERSION ""\n\nBU_: Engine Display\n\nBO_ {id} Status: 8 Engine\n{signal}'


DBC: dict[str, Case] = {
    "an id of 11 bits": ("more than the 11 bits", lambda id: database(id), None, 0x7FF),
    "an id of 29 bits": (
        "which no frame has",
        lambda id: database(id | 1 << 31),
        None,
        (1 << 29) - 1,
    ),
    "the end of a signal": ("ends behind", lambda start: database(1, start), None, 56),
}


@pytest.mark.parametrize("name", DBC)
def test_a_limit_of_a_can_database(name, tmp_path):
    assert_case(DBC[name], tmp_path / "one.dbc", can.Dbc())
