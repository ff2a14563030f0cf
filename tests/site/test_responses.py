"""Pages show the responses to telecommands on a framed link."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from icdgen.site import make_site, write_site
from tests.conformance.icds import LINKS
from tests.conftest import ROOT


def plain(page: Path) -> str:
    """Return the text of a page without tags and repeated space."""
    text = re.sub(r"<[^>]+>", " ", page.read_text(encoding="utf-8"))
    return " ".join(text.split())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    write_site(make_site([ROOT / "examples" / "links" / "wheel.yaml"]), folder)
    return folder / "wheel"


def test_the_protocol_page_shows_which_telemetry_responds_and_what_it_repeats(wheel):
    page = plain(wheel / "protocol.html")
    for words in (
        "Ack confirms Command = id",
        "Nak refuses Command = id reason in Reason",
        "Busy the device is busy Command = id",
        "Get Events requested telemetry: Events ; refuses: Nak",
        "Save confirms: Ack ; refuses: Nak ; the device is busy: Busy 3,000 ms",
        "Reset none",
        "Wrong length Bad length",
        "sent again after 100 ms, 2 times at most",
    ):
        assert words in page, words
    assert 'href="../wheel/nak.html"' in (wheel / "protocol.html").read_text()
    index = (wheel.parent / "search-index.js").read_text()
    assert "Responses to telecommands" in index


def test_the_page_of_a_message_shows_its_responses_or_what_it_responds_to(wheel):
    assert "Confirmed by Ack Refused by Nak Busy device Busy" in plain(
        wheel / "set_mode.html"
    )
    assert "May be repeated yes" in plain(wheel / "set_mode.html")
    assert "Answered with Events Refused by Nak" in plain(wheel / "get_events.html")
    assert "Time-out 3,000 ms" in plain(wheel / "save.html")
    assert "Response none" in plain(wheel / "reset.html")
    nak = plain(wheel / "nak.html")
    assert "Response refuses: Set Mode, Set Speed, Get Events, Save" in nak
    assert "Response requested telemetry: Get Events" in plain(wheel / "events.html")
    assert "Response" not in plain(wheel / "status.html").split("Layout")[0]


def test_a_status_says_which_values_confirm_and_which_do_not(tmp_path):
    write_site(make_site([LINKS / "outcomes.yaml"]), tmp_path)
    page = plain(tmp_path / "arm" / "protocol.html")
    assert "Group = id[0], Number = id[1]" in page
    assert (
        "Status: Done, 6: confirms; Later: the device is busy; Moving: still being "
        "executed; otherwise: refuses; reason in Detail"
    ) in page


def test_a_link_without_responses_has_no_table_of_them(tmp_path):
    write_site(make_site([ROOT / "examples" / "links" / "sbp.yaml"]), tmp_path)
    (page,) = tmp_path.glob("*/protocol.html")
    assert "Responses to telecommands" not in plain(page)
