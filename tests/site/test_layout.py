"""Navigation of the pages: the sidebar, sticky headings, folded sections, marked
targets and copied text.
"""

from __future__ import annotations

import pytest

from tests.site.pages import KINDS
from tests.site.test_browser import opened, wait_until

DESK, PHONE = {"width": 1440, "height": 900}, {"width": 390, "height": 844}


def test_the_sidebar_lists_all_messages_of_the_node(browser, site, shipped):
    node = shipped.node("cubeacp")
    with opened(browser, site.as_uri() + "/", KINDS["message"], viewport=DESK) as page:
        assert (
            page.is_visible("#sidebar")
            and page.inner_text("#sidebar li [aria-current]") == "Current ADCS State"
        )
        folded = page.locator("#sidebar details:not([open]) > summary")
        while folded.count():
            folded.first.click()
        wait_until(
            page,
            "!document.querySelector('#sidebar').innerText.includes('All on one page')",
        )
        listed = {
            link.inner_text(): link.get_attribute("href")
            for link in page.locator("#sidebar li a").all()
        }
        assert {
            thing.name for thing in (*shipped.messages_of(node), *node.enums)
        } <= set(listed)
        assert [
            url for url in listed.values() if not (site / "cubeacp" / url).is_file()
        ] == []
        page.click("#sidebar a:text-is('Estimated Attitude Angles')")
        assert page.url.endswith("estimated_attitude_angles.html")


def test_on_a_phone_the_sidebar_is_a_drawer_without_a_script(browser, site):
    with opened(
        browser,
        site.as_uri() + "/",
        KINDS["message"],
        viewport=PHONE,
        java_script_enabled=False,
    ) as page:
        assert not page.is_visible("#sidebar")
        page.click(".drawer")
        assert page.is_visible("#sidebar") and page.is_visible(
            "#sidebar .everywhere a:text-is('CubeWheel')"
        )
        assert page.is_visible("#sidebar a:text-is('Estimated Attitude Angles')")
        page.click("#sidebar summary:has-text('General')")
        page.click("#sidebar details:has-text('General') a:text-is('All on one page')")
        assert page.url.endswith("cubeacp/index.html#messages") and page.is_visible(
            "a:text-is('ADCS Run Mode')"
        )
        page.click(".drawer")
        page.click("#sidebar a:text-is('Errata')")
        assert page.url.endswith("errata.html")


def test_section_links_and_table_headings_stay_visible(browser, site):
    at = "(s) => document.querySelector(s).getBoundingClientRect().top"
    with opened(
        browser, site.as_uri() + "/", KINDS["composite"], viewport=DESK
    ) as page:
        row = page.locator(".fields tbody tr").nth(3)
        row.evaluate(
            "(one) => scrollTo(0, one.getBoundingClientRect().top + scrollY - 250)"
        )
        assert (
            0 <= page.evaluate(at, ".local") < 80
            and 80 <= page.evaluate(at, ".fields thead th") < 140
        )


@pytest.mark.parametrize(
    ("address", "marked"),
    [
        ("cubeacp/estimated_attitude_angles.html#field-estimated_pitch_angle", "tr:has(#bit-16) > th"),
        ("cubeacp/estimated_attitude_angles.html#bit-16", "tr:has(#bit-16) > th"),
        ("cubeacp/index.html#telemetry-146", "tr:has(#telemetry-146) > th"),
        ("cubeacp/enum-con_mode_select.html#value-3", "tr:has(#value-3) > th"),
        ("cubeacp/enum-con_mode_select.html#member-no_control", "#member-no_control > th"),
        ("cubeacp/current_adcs_state.html#field-cubesense1_enabled", "#field-cubesense1_enabled"),
        ("cubeacp/adcs_configuration.html#field-css_threshold", "tr#field-css_threshold > th"),
        ("units.html#unit-deg", "#unit-deg"),
        ("errata.html#ACP-066", "#ACP-066 > summary"),
    ],
)  # fmt: skip
def test_the_target_of_a_link_is_visible_and_marked(browser, site, address, marked):
    with opened(browser, site.as_uri() + "/", address, viewport=DESK) as page:
        lit = page.evaluate(
            "getComputedStyle(document.documentElement).getPropertyValue('--lit').trim()"
        )
        colour = page.evaluate(
            """([selector, lit]) => {
                const probe = document.createElement("i");
                probe.style.setProperty("background-color", lit);
                document.body.append(probe);
                const [is, wanted] = [document.querySelector(selector), probe].map((one) => getComputedStyle(one).backgroundColor);
                probe.remove();
                return [is, wanted];
            }""",
            [marked, lit],
        )
        assert colour[0] == colour[1]
        assert page.locator(marked).first.is_visible()
        assert 0 < page.locator(marked).first.bounding_box()["y"] < DESK["height"]


def test_errata_are_filtered_by_words_node_message_and_confidence(browser, site):
    with opened(browser, site.as_uri() + "/", KINDS["errata"], viewport=DESK) as page:
        entries = page.locator("details.erratum:visible")
        page.fill("[name=message]", "Estimated Attitude Angles")
        some = entries.count()
        assert 0 < some < 40 and "ACP-066" in page.inner_text("main")
        page.select_option("[name=confidence]", "open")
        assert 0 < entries.count() <= some
        page.select_option("[name=node]", "cubewheel")
        assert entries.count() == 0
        page.fill("[name=message]", "")
        page.select_option("[name=confidence]", "")
        assert entries.count() > 0


def test_flags_are_shown_in_a_grid_with_their_values(browser, site):
    with opened(
        browser,
        site.as_uri() + "/",
        KINDS["message"] + "#try=0000ffffffff",
        viewport=DESK,
    ) as page:
        boxes = page.locator("#decoder .flag-grid input")
        assert (
            boxes.count() == 36
            and sum(boxes.nth(n).is_checked() for n in range(36)) == 32
        )
        assert page.locator("#decoder .flag-grid").bounding_box()["height"] < 500


def test_bytes_code_and_names_can_be_copied(browser, served):
    allowed = ["clipboard-read", "clipboard-write"]
    with opened(browser, served, KINDS["numbers"], permissions=allowed) as page:
        for selector, expected in {
            ".names dd >> nth=0": "cubeacp_estimated_attitude_angles_t",
            ".buses dd >> nth=0": "1F 7F 92 1F FF",
            ".snippet.c": '#include "cubeacp.h"',
        }.items():
            frame = page.locator(selector)
            button = (
                frame.locator("..") if selector == ".snippet.c" else frame
            ).locator("button.copy")
            button.click()
            page.wait_for_selector(".copy.done")
            assert page.evaluate("navigator.clipboard.readText()").startswith(expected)
            page.wait_for_selector(".copy.done", state="detached")


def test_a_page_without_a_clipboard_copies_a_selection(browser, served):
    """Browsers give no clipboard to pages that were opened from a folder."""
    allowed = ["clipboard-read", "clipboard-write"]
    with opened(browser, served, KINDS["numbers"], permissions=allowed) as page:
        page.evaluate("navigator.clipboard.writeText('before')")
        page.evaluate(
            "() => { navigator.clipboard.writeText = () => Promise.reject('refused') }"
        )
        page.locator(".names dd >> nth=0").locator("button.copy").click()
        page.wait_for_selector(".copy.done", timeout=5000)
        assert page.evaluate("navigator.clipboard.readText()") == (
            "cubeacp_estimated_attitude_angles_t"
        )
        assert page.locator("textarea:not([id])").count() == 0


def test_results_of_the_search_stay_on_the_screen_of_a_phone(browser, site):
    with opened(browser, site.as_uri() + "/", KINDS["home"], viewport=PHONE) as page:
        page.fill("#search", "attitude")
        page.wait_for_selector("#results a")
        box = page.locator("#results").bounding_box()
        assert (
            box["x"] >= 0
            and box["x"] + box["width"] <= 390
            and box["y"] + box["height"] <= 844
        )
        assert page.evaluate("document.documentElement.scrollWidth") <= 390
