"""The decoder of a page supports fields after a variable-length field."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.site import make_site, write_site
from tests.conformance import odd
from tests.site.test_browser import opened


@pytest.fixture(scope="module")
def behind(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("behind")
    write_site(make_site([odd.FOLDER / "behind.yaml"]), out)
    return out


def test_a_field_after_an_array_is_decoded_and_stays_at_the_end(browser, behind):
    with opened(browser, behind.as_uri() + "/", "behind/packet.html") as page:
        page.fill("#frame", "00 01 AA BB CC 34 12")
        crc = page.get_by_label("CRC, raw")
        assert crc.input_value() == "4660"
        assert page.get_by_label("Payload, raw").input_value().split() == [
            "AA",
            "BB",
            "CC",
        ]
        page.get_by_label("Payload, raw").fill("AA BB")
        page.get_by_label("Payload, raw").blur()
        assert page.input_value("#frame") == "00 01 AA BB 34 12"
        crc.fill("1")
        crc.blur()
        assert page.input_value("#frame") == "00 01 AA BB 01 00"
        page.locator("[title='byte 4'] i").first.hover()
        tied = page.locator("svg.layout .tied").first.get_attribute("href")
        assert tied == "#field-crc"


def test_a_page_shows_the_fields_after_an_array(behind):
    text = (behind / "behind" / "packet.html").read_text("utf-8")
    assert "up to 40 bytes, up to the fields behind it" in text
