"""The golden vectors have the properties that their format promises.

The properties are checked without the reference codec where this is possible.
"""

from __future__ import annotations

import json
import struct
from decimal import Decimal
from fractions import Fraction
from itertools import combinations
from pathlib import Path

import jsonschema_rs
import pytest

import icdgen
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Scalar
from icdgen.vectors.make import make_vectors
from icdgen.vectors.settings import assignments_of_field
from icdgen.vectors.write import decimal, vector_file_text
from tests.conformance import odd
from tests.conformance.icds import icd_of, vectors_of

SCHEMA = json.loads(
    (Path(icdgen.__file__).parent / "vectors.schema.json").read_text(encoding="utf-8")
)


@pytest.fixture(scope="module")
def icd():
    return icd_of()


@pytest.fixture(scope="module")
def files(icd):
    return vectors_of(icd)


@pytest.fixture(scope="module")
def odd_icd(tmp_path_factory):
    return icd_of([odd.write(tmp_path_factory.mktemp("icd"))])


def messages(files):
    return [message for data in files.values() for message in data["messages"]]


def test_files_follow_the_published_schema(icd, odd_icd, files):
    validator = jsonschema_rs.validator_for(SCHEMA)
    for data in (*files.values(), *vectors_of(odd_icd).values()):
        validator.validate(data)
    broken = json.loads(json.dumps(files["cubewheel"]))
    broken["messages"][0]["vectors"][0]["bytes"] = "0"
    assert not validator.is_valid(broken)


def test_the_text_is_the_same_on_every_run_and_small_enough_to_commit(icd):
    texts = [vector_file_text(make_vectors(icd, node)) for node in icd.nodes]
    assert texts == [vector_file_text(make_vectors(icd, node)) for node in icd.nodes]
    assert sum(map(len, texts)) < 2_000_000


def test_raw_values_are_the_bits_of_the_frame(icd, files):
    """The frame is one little-endian integer, as the manual defines it."""
    seen = 0
    for node in icd.nodes:
        for message, message_vectors in zip(
            node.messages, files[node.name]["messages"], strict=True
        ):
            for vector in message_vectors["vectors"]:
                frame = int.from_bytes(bytes.fromhex(vector["bytes"]), "little")
                for field, raw in zip(message.fields, vector["raw"], strict=True):
                    value = frame >> field.at & (1 << field.bits) - 1
                    if field.is_bytes:
                        assert bytes.fromhex(raw) == value.to_bytes(
                            field.bits // 8, "little"
                        )
                    elif field.type == "float":
                        assert int(raw, 16) == value
                    else:
                        assert raw == (
                            value - (1 << field.bits)
                            if field.type == "int" and value >> field.bits - 1
                            else value
                        )
                    seen += 1
    assert seen > 40_000


def test_reserved_bits_are_encoded_as_zeros(icd, files):
    for node in icd.nodes:
        for message, message_vectors in zip(
            node.messages, files[node.name]["messages"], strict=True
        ):
            covered = 0
            for field in message.fields:
                covered |= (1 << field.bits) - 1 << field.at
            for vector in message_vectors["vectors"]:
                frame = int.from_bytes(bytes.fromhex(vector["bytes"]), "little")
                encoded = int.from_bytes(
                    bytes.fromhex(vector.get("encoded", vector["bytes"])), "little"
                )
                assert encoded == frame & covered


def test_any_two_bits_of_a_frame_differ_in_a_vector(files):
    for message in messages(files):
        frames = [
            int.from_bytes(bytes.fromhex(v["bytes"]), "little")
            for v in message["vectors"]
            # These vectors encode the position of each bit in binary.
            if "position" in v["why"]
        ]
        bits = message["length"] * 8
        codes = {tuple(frame >> bit & 1 for frame in frames) for bit in range(bits)}
        assert len(codes) == bits
        assert len(frames) <= 2 * max(1, bits.bit_length())


def test_every_field_has_vectors_at_the_ends_of_its_range_and_for_every_member(files):
    members = {e["name"]: e for data in files.values() for e in data["enums"]}
    for message in messages(files):
        for index, field in enumerate(message["fields"]):
            seen = {vector["raw"][index] for vector in message["vectors"]}
            wanted = set()
            bits = field["bits"]
            if field["type"] == "int":
                wanted = {-(1 << bits - 1), (1 << bits - 1) - 1, -1, 0}
            elif field["type"] in ("uint", "bool", "enum"):
                wanted = {0, (1 << bits) - 1}
            elif field["type"] == "float":
                wanted = {
                    # Infinities, a quiet and a signalling NaN, the negative zero, and a
                    # NaN with a payload.
                    32: {
                        "7f800000",
                        "ff800000",
                        "7fc00000",
                        "7f800001",
                        "80000000",
                        "ffa55a3c",
                    },
                    64: set(),
                }[bits]
            if field["type"] == "enum":
                enum = members[field["enum"]]
                wanted |= {value for value, _ in enum["members"]}
                if enum["unknown"] < 1 << bits:
                    wanted.add(enum["unknown"])
            assert wanted <= seen, field["name"]


def test_physical_values_are_exact_and_their_doubles_are_the_nearest(files):
    seen = 0
    for message in messages(files):
        scaled = [
            (index, f) for index, f in enumerate(message["fields"]) if "factor" in f
        ]
        for vector in message["vectors"]:
            rows = zip(
                scaled,
                vector.get("physical", ()),
                vector.get("doubles", ()),
                strict=True,
            )
            for (index, field), exact, bits in rows:
                value = vector["raw"][index] * Fraction(field["factor"]) + Fraction(
                    field["offset"]
                )
                assert Fraction(exact) == value
                assert (
                    struct.unpack(">d", bytes.fromhex(bits))[0]
                    == float(Decimal(exact))
                    == float(exact)
                )
                seen += 1
    assert seen > 10_000


def test_settings_include_exact_ties_in_both_directions_and_rejected_values(files):
    ties, refused = {0: 0, 1: 0}, 0
    for message in messages(files):
        for field in message["fields"]:
            for bits, raw in field.get("set", ()):
                value = Fraction(struct.unpack(">d", bytes.fromhex(bits))[0])
                exact = (value - Fraction(field["offset"])) / Fraction(field["factor"])
                if raw is None:
                    refused += 1
                else:
                    assert abs(exact - raw) <= Fraction(1, 2)
                    if exact.denominator == 2:
                        # Ties are rounded to even.
                        assert raw % 2 == 0
                        ties[int(exact > raw)] += 1
    assert min(ties.values()) > 300
    assert refused > 300


def test_settings_include_ties_for_every_formula_that_has_them(odd_icd):
    fields = {
        f.name: f
        for node in odd_icd.nodes
        for m in node.messages
        for f in m.fields
        if f.scale
    }

    def ties(field):
        exact = [
            field.scale.raw(Fraction(struct.unpack(">d", bytes.fromhex(bits))[0]))
            for bits, _ in assignments_of_field(field)
        ]
        return sum(1 for value in exact if value.denominator == 2)

    assert all(
        ties(fields[name]) >= 4 for name in ("Eleven", "Crossing", "Between", "A")
    )
    assert (
        ties(fields["Wide"]) >= 2
    )  # 64 bits: near the end of the range no double lies half way
    third = Scalar(
        name="raw + 1/3",
        at=0,
        bits=8,
        type="uint",
        scale=Scale(Fraction(1), Fraction(1, 3)),
    )  # half way between two raw values is never a double
    assert ties(third) == 0


def test_exact_decimals():
    assert [decimal(Fraction(text)) for text in ("-12.34", "0", "5", "1/3", "-7/30", "1/1024")] == [
        "-12.34", "0", "5", "1/3", "-7/30", "0.0009765625",
    ]  # fmt: skip
    assert decimal(Fraction(1, 10**7)) == "0.0000001"


def test_no_two_messages_share_their_vectors(files):
    """The vectors must detect a dispatcher that confuses two messages of the same
    length.
    """
    for first, second in combinations(messages(files), 2):
        if first["length"] == second["length"] > 0 and [
            f["type"] for f in first["fields"]
        ] == [f["type"] for f in second["fields"]]:
            assert first["vectors"] != second["vectors"]
