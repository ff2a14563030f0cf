"""The protocol page of a node shows every fact, assumption, checksum and procedure of
its link.
"""

from __future__ import annotations

import re

import pytest
from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.uart import uart_encode

from icdgen.loading import load
from icdgen.protocol.facts import of as facts_of
from icdgen.runtime_objects.links import link_of
from tests.cli.conftest import icdgen  # noqa: F401
from tests.site.test_browser import opened

PAGE = "cubeacp/protocol.html"


def test_the_calculator_computes_the_checksums_of_the_icd(browser, site, shipped):
    checksums = shipped.protocol_of(shipped.node("cubeacp"))["link"]["checksums"]
    with opened(browser, site.as_uri() + "/", PAGE) as page:
        shown = page.inner_text("#crc-values")
        assert (
            f"0x{checksums['crc8']['check']:X}" in shown
            and f"0x{checksums['crc16']['check']:X}" in shown
        )
        page.fill("#crc-bytes", "")
        assert f"0x{checksums['crc8']['empty']:X}" in page.inner_text("#crc-values")
        page.fill("#crc-bytes", "3x")
        assert (
            "not hexadecimal" in page.inner_text("#crc-wrong")
            and page.inner_text("#crc-values") == ""
        )


def test_the_page_shows_every_fact_and_every_assumption(site, shipped):
    text = (site / PAGE).read_text("utf-8")
    plain = (
        re.sub(r"\s+", " ", re.sub("<[^>]*>", " ", text))
        .replace("&#39;", "'")
        .replace("&#34;", '"')
    )
    facts = facts_of(shipped, shipped.node("cubeacp"))
    assert len(facts.assumptions) > 30
    for assumption in facts.assumptions:
        assert " ".join(assumption.why.split()) in plain, assumption.key
    for words in (
        "115,200",
        "29",
        "0x57",
        "1,000 ms",
        "Message Type",
        "28 … 24",
        "Incorrect Length",
    ):
        assert words in plain


def test_procedures_lead_to_their_messages(site):
    text = (site / PAGE).read_text("utf-8")
    section = text[text.index('id="procedures"') : text.index('id="times"')]
    for name in ("load_file_download_block", "download_block_ready", "erase_file"):
        assert f'href="../common/{name}.html"' in section


def test_a_node_without_protocol_has_no_protocol_page(site):
    assert not (site / "cubemag" / "protocol.html").exists()


def test_a_procedure_is_drawn_with_its_loops_times_and_limits(site):
    text = (site / PAGE).read_text("utf-8")
    download = text[
        text.index("<figcaption>Download") : text.index("<figcaption>Erase")
    ]
    for part in (
        "for each block",
        "every 50 ms, for 10000 ms at most",
        "until Ready = 1",
        "while packets are missing; if block.is_empty = 0",
        "under id 119 on UART; requested one by one on I²C, CAN",
        "Blocks of up to 20480 bytes, in packets of 20",
        'href="../common/file_download_buffer_with_file_contents.html"',
    ):
        assert part in download


WIDE = {  # CRC-16/IBM-3740 and CRC-32/ISO-HDLC, as the catalogues have them
    16: ("0x1021", "0xFFFF", "false", "0x0000", "0x29B1"),
    32: ("0x04C11DB7", "0xFFFFFFFF", "true", "0xFFFFFFFF", "0xCBF43926"),
}


@pytest.mark.parametrize("width", WIDE)
def test_a_checksum_of_several_bytes_is_computed_shown_and_removed(
    browser,
    tmp_path,
    icdgen,  # noqa: F811
    width,
):
    assert icdgen("init", "battery").status == 0
    path = tmp_path / "icd" / "battery.yaml"
    polynomial, init, reflected, xor_out, check = WIDE[width]
    values = {
        "width": width,
        "polynomial": polynomial,
        "init": init,
        "xor_out": xor_out,
        "check": check,
    }
    values |= {"reflect_in": reflected, "reflect_out": reflected}
    text = path.read_text("utf-8").replace("- bits: 8", f"- bits: {width}")
    for key, value in values.items():
        text = re.sub(rf"(\n        {key}: )\S+", rf"\g<1>{value}", text, count=1)
    path.write_text(text, "utf-8")
    built = icdgen("docs", "--out", "site")
    assert built.status == 0, built.err
    top = (tmp_path / "site").as_uri() + "/"
    with opened(browser, top, "battery/protocol.html") as page:
        assert check in page.inner_text(
            "#crc-values"
        ) and f"CRC-{width}" in page.inner_text("main")
    facts = facts_of(loaded := load([path]).icd, loaded.node("battery"))
    id = next(
        id for id, message in facts.telecommands.items() if message.name == "Reset"
    )
    link = link_of(loaded, facts)
    body = i2c_write(link, id, b"\x5a", True)
    line = uart_encode(link, body).hex(" ").upper()
    assert len(body) == 2 + width // 8
    with opened(browser, top, "battery/reset.html") as page:
        page.fill("#frame", line)
        assert "CRC is right" in page.inner_text(
            "#verdict"
        ) and line in page.inner_text(".sent")
        assert line.replace(" ", "") in re.sub(r"\s", "", page.inner_text(".buses"))
        page.fill("#frame", body[:-1].hex() + f"{body[-1] ^ 1:02x}")
        assert page.locator("#verdict.wrong").count()
    with opened(browser, top, "index.html") as page:
        page.fill("#paste", body.hex())
        page.wait_for_selector("#pasted li")
        assert "CRC is right" in page.inner_text("#pasted li")
