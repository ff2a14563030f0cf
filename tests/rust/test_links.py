"""Links of nodes in generated Rust have the facts of the protocol section."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from icdgen.backends.literals import written
from icdgen.backends.rust import links
from icdgen.describe import describe
from icdgen.describe.links import links_of
from icdgen.icd.pieces import Piece
from icdgen.loading import load
from icdgen.protocol.sections import Index, IndexField, LogBit, LogMask, TimePart
from tests.conformance.icds import LINKS

ALGORITHM = (
    "link::ChecksumAlgorithm { kind: link::CheckKind::Crc, crc: link::CrcForm {"
    " width: 16, polynomial: 0x1021, init: 0xffff, reflect_in: false,"
    " reflect_out: false, xor_out: 0x0000, empty: None } }"
)
LINK = """\
link::Link {
    node: "battery",
    node_type: None,
    interface_version: None,
    longest: 19,
    longest_data: 16,
    little: false,
    telemetry_ids: link::Ids { first: 130, last: 131 },
    telecommands: &[
        link::Form { id: 5, length: 1, acknowledged: true, repeatable: false },
        link::Form { id: 6, length: 0, acknowledged: true, repeatable: false },
    ],
    telemetry: &[
        link::Form { id: 130, length: 16, acknowledged: true, repeatable: false },
        link::Form { id: 131, length: 1, acknowledged: true, repeatable: false },
    ],
    client: link::Settings {
        reply_timeout_ms: 1_000,
        // Assumed. Not stated.
        retries: 2,
        poll_interval_ms: 20,
        poll_timeout_ms: 5_000,
        late_ms: 1_000,
        busy_pause_ms: 100,
        gap_ms: 0,
        in_flight: 1,
        progress_for_ms: 60_000,
    },
    reasons: &[0, 1, 2, 3, 4],
    framing: Some(link::Framing {
        escape: 0x1f,
        start: 0x7f,
        end: 0xff,
        escaped: 0x1f,
        escapes_id: true,
        ignores_other: false,
    }),
    acknowledge_bytes: Some(2),
    i2c_address: Some(32),
    i2c_repeated_start: true,
    can: None,
    checksums: &[
        ("crc", ALGORITHM),
    ],
    checksum: Some(link::Checksum {
        covers_id: true,
        telecommand_buses: link::PerBus { uart: true, i2c: true, can: true },
        telemetry_buses: link::PerBus { uart: true, i2c: false, can: false },
        telecommand_always: link::PerBus { uart: true, i2c: true, can: true },
        telemetry_always: link::PerBus { uart: true, i2c: false, can: false },
        bytes: 2,
        algorithm: ALGORITHM,
    }),
    mask: None,
    log_file: None,
    log_message: None,
    time: None,
    index: None,
    unsolicited: &[],
    exchanges: link::PerBus {
""".replace("ALGORITHM", ALGORITHM)


def test_a_link_on_buses_has_its_messages_facts_and_assumptions(tmp_path):
    text = (LINKS / "battery.yaml").read_text("utf-8")
    assumed = (
        "    client: {retries: 2, assumptions: {retries: Not stated.}}\n    packets:\n"
    )
    text = text.replace("    packets:\n", assumed)
    (tmp_path / "battery.yaml").write_text(text, "utf-8")
    result = load([tmp_path / "battery.yaml"])
    assert result.ok, [finding.message for finding in result.findings]
    values = links.values(links_of(describe(result.icd))["battery"])
    assert values["literal"][: len(LINK)] == LINK
    assert values["literal"].endswith(
        "    identification: None,\n    boot_ms: None,\n    stream: None,\n}"
    )
    assert values["doc"] == (
        "/// The protocol of node `battery`. Facts that the manual omits are marked as"
        " assumed."
    )
    assert (values["node"], values["longest"]) == ("battery", "19")
    assert (values["sequences"], values["tables"]) == ("", [])


def test_a_link_of_packets_has_the_tables_of_their_checksums():
    (link,) = links_of(describe(load([LINKS / "science.yaml"]).icd)).values()
    values = links.values(link)
    assert values["tables"] == [
        (
            "TABLE",
            "link::CrcForm { width: 16, polynomial: 0x1021, init: 0xffff,"
            " reflect_in: false, reflect_out: false, xor_out: 0x0000, empty: None }",
        )
    ]
    assert (values["longest"], values["sequences"]) == ("19", "1")
    assert "\n    stream: Some(link::Stream {\n" in values["literal"]


def test_the_types_of_can_packets_are_optional():
    text = written(links._can_types({"telecommand": 0, "reply": 1000}), None)
    assert text.startswith("link::CanTypes {\n    telecommand: Some(0),\n")
    assert "    reply: Some(1_000),\n" in text
    assert text.count("None") == text.count("\n") - 3


@pytest.mark.parametrize(
    ("longest", "joined", "entry", "header", "size"),
    [(9, 1, 1, 1, 9), (1, 9, 1, 1, 9), (1, 1, 9, 1, 9), (1, 1, 1, 9, 9)],
)
def test_a_buffer_has_the_longest_of_all_uses(longest, joined, entry, header, size):
    log = SimpleNamespace(header_bytes=header)
    facts = SimpleNamespace(log_file=log, mask=object(), longest=longest)
    link = SimpleNamespace(facts=facts, joined_bytes=joined, log_entry_bytes=entry)
    assert links.longest_buffer(link) == size


@pytest.mark.parametrize("keys", [{"log_file": None}, {"mask": None}])
def test_a_link_without_log_needs_no_header(keys):
    keys = {"log_file": SimpleNamespace(header_bytes=9), "mask": object()} | keys
    facts = SimpleNamespace(longest=3, **keys)
    link = SimpleNamespace(facts=facts, joined_bytes=1, log_entry_bytes=1)
    assert links.longest_buffer(link) == 3


def text_of(value):
    return written(value, None)


def literal(**description):
    """Return the literal of a link with these parts and nothing assumed."""
    facts = SimpleNamespace(parts={}, checksums={}, assumptions=())
    facts.mask = description.pop("mask", None)
    made = links._LinkLiteral(SimpleNamespace(facts=facts, **description))
    made.assumed = SimpleNamespace(
        why=lambda section, key: "", why_fact=lambda part, fact: ""
    )
    return made


def test_a_time_has_its_parts():
    parts = [("year", TimePart(2, 7, 1, 1980)), ("second", TimePart(0, 5, 2, 0))]
    assert text_of(literal(time=parts).time_form()) == (
        "link::TimeForm {\n"
        "    year: link::TimePart { at: 2, bits: 7, factor: 1, offset: 1_980 },\n"
        "    second: link::TimePart { at: 0, bits: 5, factor: 2, offset: 0 },\n"
        "}"
    )
    assert literal(time=[]).time_form() is None


def test_an_index_has_its_fields_by_role():
    roles = ("type", "counter", "checksum", "size", "time", "meta")
    fields = {role: IndexField(at, at + 1) for at, role in enumerate(roles)}
    index = Index(entry_bytes=1000, file_type=None, fields=fields)
    assert text_of(literal(index=index).index_form()) == (
        "link::IndexForm {\n"
        "    entry_bytes: 1_000,\n"
        "    file_type: None,\n"
        "    kind: link::Span { at: 0, bytes: 1 },\n"
        "    counter: link::Span { at: 1, bytes: 2 },\n"
        "    checksum: link::Span { at: 2, bytes: 3 },\n"
        "    size: link::Span { at: 3, bytes: 4 },\n"
        "    time: link::Span { at: 4, bytes: 5 },\n"
        "    meta: link::Span { at: 5, bytes: 6 },\n"
        "}"
    )
    assert literal(index=None).index_form() is None


def test_a_mask_has_its_assigned_bits_in_order():
    bits = {
        9: LogBit(9, 0, 2, "Mode"),
        1: LogBit(1, 255, 1, None),
        3: LogBit(3, None, 4, None),
    }
    mask = LogMask(size=2, msb0=True, slot_bytes=4, fill=0, bits=bits)
    assert text_of(literal(mask=mask).mask_form()).splitlines()[-6:] == [
        "    fill: 0x00,",
        "    bits: &[",
        '        link::LogBit { bit: 1, id: 255, length: 1, name: "" },',
        '        link::LogBit { bit: 9, id: 0, length: 2, name: "Mode" },',
        "    ],",
        "}",
    ]
    assert literal().mask_form() is None


def test_an_identification_has_the_pieces_of_its_numbers():
    pieces = (Piece(0, 4, 4, 0), Piece(1, 0, 8, 4))
    place = SimpleNamespace(role="node_type", field=SimpleNamespace(pieces=pieces))
    report = SimpleNamespace(message=SimpleNamespace(length=1000), places=(place,))
    assert text_of(links._identification(report)) == (
        "link::Identification {\n"
        "    length: 1_000,\n"
        "    node_type: &[link::Piece { byte: 0, shift: 4, bits: 4, at: 0 },"
        " link::Piece { byte: 1, shift: 0, bits: 8, at: 4 }],\n"
        "    interface_version: &[],\n"
        "}"
    )
    assert links._identification(None) is None


def test_assumptions_without_a_place_are_in_the_comment(monkeypatch):
    link = link_with_assumptions(
        [
            ("procedures.read", "time_s", "Not here."),
            ("link.x", "rate", "Not *stated*."),
        ]
    )
    assert links.values(link)["doc"] == (
        "/// The protocol of node `battery`. Facts that the manual omits are marked as"
        " assumed.\n"
        "///\n"
        "/// Assumed (`link.x`, `rate`): Not \\*stated\\*."
    )


def link_with_assumptions(rows):
    """Return a link whose facts have these assumptions as well."""
    icd = load([LINKS / "battery.yaml"]).icd
    link = links_of(describe(icd))["battery"]
    more = (SimpleNamespace(section=a, key=b, why=c) for a, b, c in rows)
    link.facts = replace(link.facts, assumptions=(*link.facts.assumptions, *more))
    return link
