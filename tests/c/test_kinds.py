"""Masks of the kinds of parts that links have, by which a compiler leaves out code."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.c.kinds import kinds_of
from icdgen.protocol.packet_formats import NOTHING, REQUESTED

PLACE = object()


def row(**changes):
    values = {
        "cuts_zeros": False, "repeats": False, "requests": None,
        "is_requested": False, "packet": 0,
    }  # fmt: skip
    return SimpleNamespace(**values | changes)


def link(stream=None, exchanges=(), checksums=(), buses=()):
    facts = SimpleNamespace(
        stream=stream,
        exchanges=exchanges,
        checksums={kind: SimpleNamespace(kind=kind) for kind in checksums},
        bus_exchanges=dict.fromkeys(buses),
    )
    return SimpleNamespace(facts=facts)


def stream(delimited_by, contents, roles, telecommands=(), telemetry=()):
    fields = [SimpleNamespace(role=role) for role in roles]
    packets = [SimpleNamespace(content=content, fields=fields) for content in contents]
    return SimpleNamespace(
        delimited_by=delimited_by,
        packets=packets,
        telecommands=telecommands,
        telemetry=telemetry,
    )


def response(verdict, meanings=(), **places):
    values = {"status": None, "reason": None, "detail": None, **places}
    return SimpleNamespace(verdict=verdict, meanings=meanings, **values)


def exchange(*responses, sources=(), in_header=0):
    return SimpleNamespace(responses=responses, sources=sources, in_header=in_header)


def test_without_a_link_a_caller_can_still_expect_a_reply():
    kinds = {kind.name: kind.bits for kind in kinds_of([])}
    assert kinds == {
        "DELIMITERS": [],
        "CHECKS": [],
        "CONTENTS": [],
        "ROLES": [],
        "STREAM_FLAGS": [],
        "VERDICTS": ["ICDGEN_BIT(ICD_VERDICT_REPLY)"],
        "RESPONSES": [],
        "BUSES": [],
    }


def test_the_kinds_are_those_of_all_links_in_order_of_their_names():
    # A message is in the packet with the number in its row.
    framed = stream(
        "slip",
        [NOTHING, REQUESTED],
        ["length", "id"],
        [row(requests=0, packet=1)],
        [row(repeats=True, cuts_zeros=True), row(is_requested=True)],
    )
    other = stream("length", ["message"], ["id"])
    refusal = response("refused", ((1, "busy"),), status=PLACE, reason=PLACE)
    links = [
        link(framed, [exchange(refusal, sources=(PLACE,))], ["sum"]),
        link(None, [exchange(response("done", detail=PLACE))], ["crc", "sum"], ["i2c"]),
        link(other, [exchange(in_header=1)], buses=["can", "i2c"]),
    ]
    kinds = kinds_of(links)
    assert [(kind.name, kind.bits) for kind in kinds if "ICDGEN_BIT" in kind.bits[0]] == [
        (
            "DELIMITERS",
            ["ICDGEN_BIT(ICD_DELIMITED_BY_LENGTH)", "ICDGEN_BIT(ICD_DELIMITED_BY_SLIP)"],
        ),
        ("CHECKS", ["ICDGEN_BIT(ICD_CHECK_CRC)", "ICDGEN_BIT(ICD_CHECK_SUM)"]),
        (
            "CONTENTS",
            [
                "ICDGEN_BIT(ICD_PACKET_MESSAGE)",
                "ICDGEN_BIT(ICD_PACKET_NOTHING)",
                f"ICDGEN_BIT(ICD_PACKET_{REQUESTED.upper()})",
            ],
        ),
        ("ROLES", ["ICDGEN_BIT(ICD_FIELD_ID)", "ICDGEN_BIT(ICD_FIELD_LENGTH)"]),
        (
            "VERDICTS",
            [
                f"ICDGEN_BIT(ICD_VERDICT_{verdict})"
                for verdict in ("BUSY", "DONE", "REFUSED", "REPLY")
            ],
        ),
        ("BUSES", ["ICDGEN_BIT(ICD_BUS_CAN)", "ICDGEN_BIT(ICD_BUS_I2C)"]),
    ]  # fmt: skip
    bits = {kind.name: kind.bits for kind in kinds}
    assert bits["STREAM_FLAGS"] == [
        f"ICD_STREAM_{flag}"
        for flag in ("CUTS_ZEROS", "NAMELESS", "REPEATS", "REQUESTED", "REQUESTS")
    ]
    assert bits["RESPONSES"] == [
        f"ICDGEN_RESPONSE_{part}"
        for part in ("DETAIL", "ECHO", "HEADER_ECHO", "REASON", "STATUS")
    ]
    assert kinds[0].about == "Of icd_delimiter_t."


@pytest.mark.parametrize(
    ("of_one", "parts"),
    [
        (exchange(response("done")), []),
        (exchange(response("done"), sources=(0,)), ["ECHO"]),
        (exchange(response("done"), in_header=1), ["HEADER_ECHO"]),
        (exchange(response("done", status=PLACE)), ["STATUS"]),
        (exchange(response("done", reason=PLACE)), ["REASON"]),
        (exchange(response("done"), response("done", detail=PLACE)), ["DETAIL"]),
    ],
)
def test_each_part_of_a_response_has_its_own_bit(of_one, parts):
    bits = {kind.name: kind.bits for kind in kinds_of([link(exchanges=[of_one])])}
    assert bits["RESPONSES"] == [f"ICDGEN_RESPONSE_{part}" for part in parts]
