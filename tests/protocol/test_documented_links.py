"""The links in docs/guides/example-links.md pass `icdgen check`, work in generated
code, and equal the files in examples/links.
"""

from __future__ import annotations

import re

import pytest
import yaml

from icdgen.loading import load
from tests import documents
from tests.conftest import ROOT
from tests.python import packages

SHOWN = documents.text("guides/example-links")
EXAMPLES = {match["name"]: match["yaml"] for match in re.finditer(
    r"\*\*(?P<name>[^*]+)\*\*[^`]*?(?:`[^`]+`[^`]*?)*```yaml\n(?P<yaml>icdgen: 1\n.*?)```\n", SHOWN, re.S
)}  # fmt: skip
FILES = {
    "Sync bytes, a length and a CRC": "sbp",
    "SLIP": "slip",
    "COBS": "cobs",
    "Escape characters": "tsip",
    "CCSDS space packets.": "ccsds",
    "MAVLink 2.": "mavlink2",
}
CUBEADCS = "The link of a CubeADCS"


def test_the_page_shows_all_expected_links():
    assert list(EXAMPLES) == [*FILES, CUBEADCS]


@pytest.mark.parametrize("name", FILES)
def test_an_example_is_that_of_its_file(name):
    shown = yaml.safe_load(EXAMPLES[name])
    shipped = yaml.safe_load(
        (ROOT / "examples" / "links" / f"{FILES[name]}.yaml").read_text(
            encoding="utf-8"
        )
    )
    for name, checksum in shown["protocol"]["link"].get("checksums", {}).items():
        # The shown messages are only some, and so are the seeds.
        seeds = shipped["protocol"]["link"]["checksums"][name].get("seeds", {})
        assert checksum.get("seeds", {}).items() <= seeds.items()
        checksum.pop("seeds", None)
        shipped["protocol"]["link"]["checksums"][name].pop("seeds", None)
    assert (shown["node"], shown["protocol"]) == (shipped["node"], shipped["protocol"])
    assert all(message in shipped["messages"] for message in shown["messages"])


def test_the_link_of_the_cubeadcs_is_that_of_its_icd():
    shown = yaml.safe_load(EXAMPLES[CUBEADCS])["protocol"]
    common, acp = (
        yaml.safe_load((ROOT / "icd" / f"{name}.yaml").read_text(encoding="utf-8"))
        for name in ("common", "cubeacp")
    )
    shown_link, link = shown["link"], common["protocol"]["link"]
    assert shown_link["ids"].items() <= link["ids"].items()
    assert (
        shown_link["buses"]["uart"]["framing"].items()
        <= link["buses"]["uart"]["framing"].items()
    )
    link = acp["protocol"]["link"]
    crc, trailer = link["checksums"]["crc8"], link["packets"]["telecommand"]["trailer"]
    assert shown_link["checksums"]["crc8"].items() <= crc.items()
    assert shown_link["packets"]["telecommand"]["trailer"] == trailer


@pytest.mark.parametrize("name", [*FILES, CUBEADCS])
def test_an_example_is_checked_generated_and_run(name, tmp_path):
    (tmp_path / "device.yaml").write_text(EXAMPLES[name], encoding="utf-8")
    loaded = load([tmp_path / "device.yaml"])
    assert loaded.findings == []
    node = loaded.icd.nodes[0].name
    package = packages.write(loaded.icd, tmp_path / "made", f"documented_{node}")
    link, wire = package.module(node).LINK, package.module("wire")
    module = package.module(node)
    kinds = [
        kind
        for kind in (getattr(module, name) for name in module.__all__)
        if hasattr(kind, "from_bytes") and hasattr(kind, "NAME")
    ]
    assert {kind.NAME for kind in kinds} == {
        message.name for message in loaded.icd.nodes[0].messages
    }
    for kind in kinds:
        sent = kind()
        if name == CUBEADCS:
            line = wire.uart_encode(link, bytes([kind.ID]) + sent.to_bytes())
            (event,) = wire.UartDecoder(link).feed(b"noise" + line)
            assert kind.from_bytes(event.message[1:]) == sent
            continue
        direction = (
            "telemetry"
            if kind in messages_with_id_of(link.TELEMETRY, kind)
            else "telecommand"
        )
        decoder = wire.StreamDecoder(link, direction)
        line = wire.stream_encode(link, sent, direction=direction)
        events = [event for byte in line for event in decoder.feed(bytes([byte]))]
        assert [event.of(kind) for event in events] == [sent]
        assert (decoder.discarded, decoder.pending) == (0, 0)


def messages_with_id_of(table, kind):
    """Return the messages that a direction has under the id of ``kind``."""
    return table.of(kind.IDS[-1]) if kind.IDS[-1] in table else ()


def test_the_documented_procedure_is_that_of_the_bootloader():
    shown = re.search(
        r"```yaml\n(protocol:\n.*?)```", documents.text("guides/procedures"), re.S
    )
    assert shown
    path = ROOT / "examples" / "links" / "bootloader.yaml"
    shipped = yaml.safe_load(path.read_text(encoding="utf-8"))
    procedures = yaml.safe_load(shown[1])["protocol"]["procedures"]
    assert procedures == shipped["protocol"]["procedures"]
