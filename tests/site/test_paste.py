"""A frame pasted on any page leads to its message with its values."""

from __future__ import annotations

import json

import pytest

from tests.cli.conftest import icdgen  # noqa: F401
from tests.conftest import ROOT
from tests.recognize.ways import BARE, WHOLE
from tests.site.pages import KINDS
from tests.site.test_browser import opened, results

ANGLES = "cubeacp/estimated_attitude_angles.html#try=2efb0a000000"
PASTE = """(text) => {
    const data = new DataTransfer();
    data.setData("text/plain", text);
    const box = document.activeElement;
    const event = new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true });
    if (box.dispatchEvent(event)) {
        box.value = box.tagName === "INPUT" ? text.replace(/[\\r\\n]/g, "") : text;
        box.dispatchEvent(new Event("input", { bubbles: true }));
    }
}"""


def test_the_first_page_accepts_every_form_of_a_frame(browser, site):
    top = site.as_uri() + "/"
    with opened(browser, top, KINDS["home"]) as page:
        for text in WHOLE.values():
            page.goto(top + KINDS["home"])
            page.focus("#paste")
            page.evaluate(PASTE, text)
            page.wait_for_url(top + ANGLES)
        assert page.input_value("#value-1") == "-12.34"


def test_page_and_command_line_give_the_same_values_for_every_form(
    browser,
    site,
    icdgen,  # noqa: F811
):
    with opened(browser, site.as_uri() + "/", ANGLES.partition("#")[0]) as page:
        for way, text in {**BARE, **WHOLE}.items():
            page.fill("#frame", "")
            decoded = icdgen(
                "decode",
                "--icd",
                ROOT / "icd",
                "cubeacp",
                "146",
                "--format",
                "json",
                text,
            )
            fields = json.loads(decoded.out)["fields"]
            page.fill("#frame", text)
            shown = [
                (page.input_value(f"#raw-{key}"), page.input_value(f"#value-{key}"))
                for key in (1, 2, 3)
            ]
            assert shown == [
                (str(field["raw"]), f"{field['value']:.2f}") for field in fields
            ], way
            assert not page.locator("#verdict.wrong").count()


def test_page_and_command_line_need_the_message_for_a_frame_without_id(
    browser,
    site,
    icdgen,  # noqa: F811
):
    with opened(browser, site.as_uri() + "/", KINDS["home"]) as page:
        for way, text in BARE.items():
            page.fill("#paste", "")
            decoded = icdgen("decode", "--icd", ROOT / "icd", text)
            page.fill("#paste", text)
            page.wait_for_selector("#pasted li")
            assert (
                decoded.status == 2 and "6 bytes without an id can be" in decoded.err
            ), way
            assert page.inner_text("#pasted .note").startswith(
                "6 bytes without an id can be several"
            ), way


def test_all_possible_messages_of_a_frame_are_listed(browser, site):
    with opened(browser, site.as_uri() + "/", KINDS["home"]) as page:
        page.fill("#paste", BARE["pairs"])
        page.wait_for_selector("#pasted li")
        shown = page.inner_text("#pasted")
        assert "which one is it?" in shown and "Estimated Attitude Angles" in shown
        page.fill("#paste", "1F 7F 92 2E FB")
        page.wait_for_selector("#pasted .wrong")
        assert "end of the message is missing" in page.inner_text("#pasted")
        assert (
            page.locator("#pasted li").count() == 0
            and page.get_attribute("#paste", "aria-invalid") == "true"
        )


@pytest.mark.parametrize(
    "text",
    [
        WHOLE["UART"],
        WHOLE["candump"],
        "08BE0201#00010203040506" + "00\n05920201#2EFB0A000000",
    ],
)
def test_the_search_field_of_every_page_accepts_a_frame(browser, site, text):
    top = site.as_uri() + "/"
    with opened(browser, top, KINDS["enumeration"]) as page:
        page.focus("#search")
        page.evaluate(PASTE, text)
        page.wait_for_selector("#results a")
        assert results(page)[0] == ("frame", "Estimated Attitude Angles")
        page.keyboard.press("Enter")
        page.wait_for_url(top + ANGLES)
        assert page.input_value("#value-1") == "-12.34"


def test_the_search_field_reports_an_invalid_frame(browser, site):
    with opened(browser, site.as_uri() + "/", KINDS["units"]) as page:
        page.click("#search")
        page.fill("#search", "1F 7F 92 2E FB 1F FF")
        page.wait_for_selector("#results .nothing")
        assert "has 6 bytes, 2 given" in page.inner_text("#results")


def test_a_frame_of_another_message_clears_the_values_and_links_to_it(browser, site):
    with opened(browser, site.as_uri() + "/", ANGLES) as page:
        assert page.input_value("#value-1") == "-12.34"
        page.fill("#frame", "1F 7F 93 10 00 20 00 30 00 1F FF")
        assert (
            page.input_value("#value-1") == ""
            and page.locator("svg.layout .lit *").count() == 0
        )
        page.wait_for_selector("#verdict a")
        assert "wrong" in page.get_attribute("#verdict", "class")
        page.click("#verdict a")
        assert page.url.endswith("estimated_angular_rates.html#try=100020003000")


def test_values_out_of_range_are_shown_as_errors(browser, site):
    with opened(
        browser, site.as_uri() + "/", "cubeacp/set_attitude_control_mode.html"
    ) as page:
        page.fill("#frame", "3F 0A 00")
        verdict = page.inner_text("#verdict")
        assert "no such member" in verdict and "wrong" in page.get_attribute(
            "#verdict", "class"
        )
        page.fill("#frame", "01 0A 00")
        assert "wrong" not in (page.get_attribute("#verdict", "class") or "")
    with opened(browser, site.as_uri() + "/", "common/reset.html") as page:
        page.fill("#frame", "01")
        assert "must be 90" in page.inner_text(
            "#verdict"
        ) and "wrong" in page.get_attribute("#verdict", "class")


def test_the_decoder_shows_can_identifiers_and_lines_of_candump(browser, site):
    with opened(browser, site.as_uri() + "/", ANGLES) as page:
        shown = page.inner_text(".sent")
        assert "id 0x05920100" in shown and "05920100#2EFB0A000000" in shown
    with opened(
        browser,
        site.as_uri() + "/",
        "cubeacp/adcs_state.html#try=" + bytes(range(54)).hex(),
    ) as page:
        shown = page.inner_text(".sent")
        assert "08BE0100#0001020304050607" in shown and shown.count("08BE0100#") == 8


def test_the_drawing_shows_the_values(browser, site):
    with opened(browser, site.as_uri() + "/", ANGLES) as page:
        assert page.locator("svg.layout .lit .value").all_text_contents() == [
            "-12.34 deg",
            "0.10 deg",
            "0.00 deg",
        ]
        page.click("#decoder button:text-is('Reset')")
        assert page.locator("svg.layout .lit .value").count() == 0


def test_several_frames_are_all_listed_and_one_that_cannot_be_decoded_is_reported(
    browser, site
):
    top = site.as_uri() + "/"
    two = "1F 7F 92 2E FB 0A 00 00 00 1F FF 1F 7F 93 10 00 20 00 30 00 1F FF"
    with opened(browser, top, KINDS["home"]) as page:
        for text, bad in (
            (two, ""),
            (two + " 1F 7F 92 2E 1F FF", "Not decoded:"),
            (WHOLE["UART"] + " 1F 7F 6F 1F FF", ""),
        ):
            page.fill("#paste", "")
            page.focus("#paste")
            page.evaluate(PASTE, text)
            page.wait_for_selector("#pasted li")
            page.click("#paste-go")
            assert page.url == top + KINDS["home"]
            shown = page.inner_text("#pasted")
            assert "Estimated Attitude Angles" in shown and bad in shown
            assert ("Estimated Angular Rates" in shown) == text.startswith(two)
        assert (
            "Not decoded: no message of" in shown
            or "Not decoded: no message has the id" in shown
        )
