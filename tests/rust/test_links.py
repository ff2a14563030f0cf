"""Links of nodes in generated Rust have the facts of the protocol section."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.literals import written
from icdgen.backends.rust import links
from icdgen.describe import describe
from icdgen.describe.links import links_of
from icdgen.loading import load
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
