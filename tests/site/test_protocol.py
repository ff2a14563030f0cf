"""The page that says how a node talks."""

from __future__ import annotations

import re

from tests.site.test_browser import opened

PAGE = "cubeacp/protocol.html"


def test_the_calculator_computes_the_checksums_of_the_icd(browser, site, shipped):
    protocol = shipped.protocol_of(shipped.node("cubeacp"))
    with opened(browser, site.as_uri() + "/", PAGE) as page:
        shown = page.inner_text("#crc-values")
        assert f"0x{protocol['crc8']['check']:X}" in shown and f"0x{protocol['crc16']['check']:X}" in shown
        page.fill("#crc-bytes", "")
        assert f"0x{protocol['crc8']['empty']:X}" in page.inner_text("#crc-values")
        page.fill("#crc-bytes", "3x")
        assert "not hexadecimal" in page.inner_text("#crc-wrong") and page.inner_text("#crc-values") == ""


def test_every_fact_and_every_assumption_stands_there(site, shipped):
    from icdgen.protocol.facts import of

    text = (site / PAGE).read_text("utf-8")
    plain = re.sub(r"\s+", " ", re.sub("<[^>]*>", " ", text)).replace("&#39;", "'").replace("&#34;", '"')
    known = of(shipped, shipped.node("cubeacp"))
    assert len(known.assumptions) > 30
    for one in known.assumptions:
        assert " ".join(one.why.split()) in plain, one.key
    for words in ("115,200", "29", "0x57", "1,000 ms", "Message Type", "28 … 24", "Incorrect Length"):
        assert words in plain


def test_procedures_lead_to_their_messages(site):
    text = (site / PAGE).read_text("utf-8")
    section = text[text.index('id="procedures"') : text.index('id="times"')]
    for name in ("load_file_download_block", "download_block_ready", "erase_file"):
        assert f'href="../common/{name}.html"' in section


def test_a_node_of_which_nothing_is_said_has_no_such_page(site):
    assert not (site / "cubemag" / "protocol.html").exists()
