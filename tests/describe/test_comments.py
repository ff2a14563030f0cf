"""Comments in every language: each erratum once with its reason, and the parts of units
by name.
"""

from __future__ import annotations

import pytest

from icdgen.describe import describe
from icdgen.describe.integer_scale import part_of_unit
from icdgen.icd.layout import Scalar
from icdgen.icd.units import STANDARD, Unit
from icdgen.loading import load
from tests.conformance.icds import shipped


def parts():
    """Yield every message and enumeration with its members."""
    for node in describe(shipped()).nodes:
        yield from (
            (thing, (thing, *thing.members)) for thing in (*node.messages, *node.enums)
        )


def test_the_first_comment_of_an_erratum_has_its_reason_and_others_refer_to_it():
    repeated = 0
    for owner, things in parts():
        full: dict[str, str] = {}
        for thing in things:
            for erratum, text in zip(
                thing.model.errata, thing.comment.errata, strict=True
            ):
                assert text.startswith(
                    f"{erratum.label} {erratum.id}{erratum.sureness}: "
                )
                if erratum.id in full:
                    assert text.endswith(f": see {full[erratum.id]}."), owner.model.name
                    repeated += 1
                else:
                    full[erratum.id] = thing.model.name
                    assert erratum.title in text
    assert repeated > 100


def test_the_reason_stands_with_the_title():
    message = next(
        message
        for message in describe(shipped()).node("cubeacp").messages
        if message.model.name == "ADCS Configuration"
    )
    (radius,) = (
        member for member in message.members if member.model.name == "Nadir Max Radius"
    )
    assert radius.comment.errata == (
        "Erratum ACP-148 (certain): Degree sign is deg. Two fields have the sign, all other angles deg.",
    )


@pytest.mark.parametrize(
    ("symbol", "per", "name", "words"),
    [
        ("km", 1000, "m", "m"),
        ("km", 1_000_000, "mm", "mm"),
        ("km/s", 1000, "m_per_s", "m/s"),
        ("m/s", 1000, "mm_per_s", "mm/s"),
        ("uT", 1000, "nt", "nT"),
        ("mA", 1000, "ua", "uA"),
        ("deg", 1000, "mdeg", "thousandths of deg"),
        ("C", 1000, "mc", "thousandths of C"),
        ("%", 1000, "milli_percent", "thousandths of %"),
    ],
)
def test_a_part_of_a_unit_has_its_common_name(symbol, per, name, words):
    field = Scalar(name="One", at=0, bits=8, type="uint", unit=STANDARD[symbol])
    assert part_of_unit(field, per) == (name, words)


def test_a_user_defined_unit_is_not_split():
    field = Scalar(
        name="One", at=0, bits=8, type="uint", unit=Unit("klick", "km", "length")
    )
    assert part_of_unit(field, 1000) == ("m", "thousandths of klick")


def test_an_enumeration_lists_the_fields_that_use_it(tmp_path):
    fields = "".join(
        f"      - {{at: {at * 2}, bits: 2, name: F{at}, type: enum, enum: Mode}}\n"
        for at in range(4)
    )
    field = "fields: [{{at: 0, bits: 2, name: F0, type: enum, enum: Mode}}]"
    heads = f"  - {{{{name: {{0}}, id: {{1}}, kind: telemetry, length: 1, {field}}}}}\n"
    (tmp_path / "demo.yaml").write_text(
        "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}\nenums:\n"
        "  - {name: Mode, members: [{value: 0, name: Idle}]}\n  - {name: Other, members: [{value: 0, name: Idle}]}\n"
        "messages:\n" + "".join(heads.format(f"M{id}", id) for id in range(1, 8))
        + f"  - name: Last\n    id: 9\n    kind: telemetry\n    length: 1\n    fields:\n{fields}",
        encoding="utf-8",
    )  # fmt: skip
    mode, other = describe(load([tmp_path / "demo.yaml"]).icd).node("demo").enums
    assert mode.comment.details == (
        "Used by F0 in M1, M2, M3, M4, M5 and 3 others; F1 in Last; F2 in Last; F3 in Last.",
    )
    assert other.comment.paragraphs == ("Other: an enumeration.",)
