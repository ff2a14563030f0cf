"""Users search, decode, filter and print on the site in a browser, from the folder and
from a server.
"""

from __future__ import annotations

import json
import time
from contextlib import contextmanager

import pytest

from tests.conformance.icds import COMMITTED
from tests.site import measure
from tests.site.pages import KINDS

NODES = ["common", "bootloader", "cubeacp", "cubemag", "cubewheel"]


@pytest.fixture(params=["file", "server"])
def top(request, site) -> str:
    """Return the address of the site, which precedes the paths of the pages."""
    return (
        site.as_uri() + "/"
        if request.param == "file"
        else request.getfixturevalue("served")
    )


@contextmanager
def opened(browser, top: str, path: str, **options):
    """Return a page. Fails if it logs an error or requests anything outside the site."""
    complaints, requested_urls = [], []
    listeners = {
        "console": lambda message: complaints.append(message.text),
        "pageerror": lambda error: complaints.append(str(error)),
        "request": lambda request: requested_urls.append(request.url),
    }
    with browser.page(**options) as page:
        for event, listener in listeners.items():
            page.on(event, listener)
        page.goto(top + path)
        if page.evaluate("localStorage.length"):  # choices of an earlier test
            page.evaluate("localStorage.clear()")
            page.reload()
        yield page
        for event, listener in listeners.items():
            page.remove_listener(event, listener)
    assert complaints == []
    assert [url for url in requested_urls if not url.startswith(top)] == []


def wait_until(page, condition: str) -> None:
    """Wait until a JavaScript expression is true.

    Playwright's `wait_for_function` polls with `eval`, which the policy of the pages
    forbids: it fails if the condition does not hold at once.
    """
    end = time.monotonic() + 30
    while not page.evaluate(f"Boolean({condition})"):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(10)


def results(page) -> list[tuple[str, str]]:
    page.wait_for_selector("#results a")
    return [
        (
            item.query_selector(".what").inner_text(),
            item.query_selector(".title").inner_text(),
        )
        for item in page.query_selector_all("#results a")
    ]


@pytest.mark.parametrize(
    ("text", "expected", "url"),
    [
        ("estimated roll", ("field", "Estimated Roll Angle"), "cubeacp/estimated_attitude_angles.html#field-estimated_roll_angle"),
        ("thomson", ("member", "Y-Thomson spin"), "cubeacp/enum-con_mode_select.html#member-y_thomson_spin"),
        ("0x92", ("message", "Estimated Attitude Angles"), "cubeacp/estimated_attitude_angles.html"),
        ("146", ("message", "Estimated Attitude Angles"), "cubeacp/estimated_attitude_angles.html"),
        ("acp-066", ("note", "ACP-066 Attitude angles: order of rotation and frame"), "errata.html#ACP-066"),
        ("deg/s", ("unit", "deg/s"), "units.html#unit-deg_per_s"),
    ],
)  # fmt: skip
def test_the_search_lists_results(browser, top, text, expected, url):
    with opened(browser, top, KINDS["numbers"]) as page:
        page.keyboard.press("/")
        page.keyboard.type(text)
        assert results(page)[0] == expected
        page.keyboard.press("ArrowDown")
        page.keyboard.press("ArrowUp")
        page.keyboard.press("Enter")
        page.wait_for_url(top + url)


def test_results_appear_before_the_next_key_is_typed(browser, site):
    with opened(browser, site.as_uri() + "/", KINDS["home"]) as page:
        page.click("#search")
        wait_until(page, "globalThis.icdgenSearchIndex")
        page.evaluate("""() => {
            const input = document.getElementById("search");
            for (const text of ["a", "wheel", "enabled", "0x92", "deg", "thomson"]) {
                input.value = text;
                input.dispatchEvent(new Event("input"));
                if (!document.querySelector("#results a")) throw new Error(text);
            }
        }""")


def golden(node: str) -> tuple[str, dict, dict]:
    """Return the message of the node's vectors with the most kinds of fields, and a
    random frame of it.
    """
    data = json.loads((COMMITTED / f"{node}.json").read_text("utf-8"))
    short = [m for m in data["messages"] if 0 < len(m["fields"]) <= 30]
    message = max(
        short, key=lambda m: (len({f["type"] for f in m["fields"]}), len(m["fields"]))
    )
    return (
        message["name"],
        message,
        next(v for v in message["vectors"] if v["why"] == "random 0"),
    )


@pytest.mark.parametrize("node", NODES)
def test_the_decoder_decodes_a_golden_vector_and_encodes_it_back(
    browser, top, shipped, node
):
    from icdgen.backends.html.links import Links

    name, data, vector = golden(node)
    message = next(m for m in shipped.node(node).messages if m.name == name)
    with opened(browser, top, Links(shipped).message(message)) as page:
        page.fill("#frame", vector["bytes"])
        page.evaluate(
            "document.querySelectorAll('details').forEach((one) => (one.open = true))"
        )
        in_grid = set()
        for key, (field, raw) in enumerate(
            zip(data["fields"], vector["raw"], strict=True), 1
        ):
            if (
                field["type"] == "bool" and not page.locator(f"#raw-{key}").count()
            ):  # it stands in a grid
                assert page.is_checked(f"#value-{key}") == bool(raw)
                in_grid.add(key)
                continue
            shown = (
                page.input_value(f"#raw-{key}")
                .replace(" ", "")
                .lower()
                .removeprefix("0x")
            )
            assert shown == (str(raw).lower())
            if field["type"] == "bool":
                assert page.is_checked(f"#value-{key}") == bool(raw)
        assert page.locator("svg.layout .lit rect").count() > 0
        values = {
            k: page.input_value(f"#raw-{k}")
            for k in range(1, len(data["fields"]) + 1)
            if k not in in_grid
        }
        flags = {key: page.is_checked(f"#value-{key}") for key in in_grid}
        page.click("#decoder button:text-is('Reset')")
        for key, value in flags.items():
            page.set_checked(f"#value-{key}", value)
        for key, value in values.items():
            page.fill(f"#raw-{key}", value)
            page.locator(f"#raw-{key}").blur()
        encoded = vector.get("encoded", vector["bytes"])
        assert page.input_value("#frame").replace(" ", "").lower() == encoded


def test_the_decoder_takes_framing_and_checksums_and_physical_values(browser, site):
    with opened(browser, site.as_uri() + "/", KINDS["numbers"]) as page:
        page.fill("#frame", "1F 7F 92 2e fb 1f 1f 00 00 00 1F FF")
        assert (
            page.input_value("#value-1") == "-12.34"
            and page.input_value("#raw-2") == "31"
        )
        assert "framing with id 146 removed" in page.inner_text("#verdict")
        page.fill("#value-2", "-0.015")
        page.locator("#value-2").blur()
        assert (
            page.input_value("#frame") == "2E FB FF FF 00 00"
            or page.input_value("#frame") == "2E FB FE FF 00 00"
        )
        page.fill("#frame", "zz")
        assert "not hexadecimal" in page.inner_text("#verdict")
        page.fill("#value-1", "400")
        page.locator("#value-1").blur()
        assert "takes -327.68 to 327.67" in page.inner_text("#verdict")


def test_pointer_and_keyboard_highlight_a_field_in_drawing_and_table(browser, top):
    with opened(browser, top, KINDS["message"]) as page:
        lit = "getComputedStyle(document.documentElement).getPropertyValue('--lit').trim()"
        fill = "(s) => getComputedStyle(document.querySelector(s)).getPropertyValue('--tie').trim()"
        row, shape = ".fields [data-key='5']", "svg.layout [data-key='5']"
        assert page.evaluate(fill, row) == ""
        page.hover(shape + " rect")
        assert page.evaluate(fill, row) == page.evaluate(lit)
        page.mouse.move(0, 0)
        page.hover(row)
        assert page.evaluate(fill, shape) == page.evaluate(lit)
        page.mouse.move(0, 0)
        page.focus(shape)
        assert page.evaluate(fill, row) == page.evaluate(lit)
        page.keyboard.press("Enter")
        assert page.url.endswith("#field-cubecontrol_signal_enabled")


def test_a_node_s_messages_are_filtered(browser, site):
    with opened(browser, site.as_uri() + "/", KINDS["node"]) as page:
        rows = page.locator("#message-table tbody tr:visible")
        everything = rows.count()
        page.fill("[name=text]", "0x92")
        assert (
            rows.count() == 1 and "Estimated Attitude Angles" in rows.first.inner_text()
        )
        page.fill("[name=text]", "")
        page.select_option("[name=kind]", "telecommand")
        commands = rows.count()
        page.fill("[name=bytes]", ">20")
        assert 0 < rows.count() < commands < everything
        page.select_option("[name=kind]", "")
        page.fill("[name=bytes]", "")
        page.fill("[name=mask]", "any")
        loggable = rows.count()
        page.fill("[name=mask]", "28")
        assert rows.count() == 1 < loggable < everything
        page.fill("[name=mask]", "nonsense")
        assert (
            rows.count() == everything
            and page.get_attribute("[name=mask]", "aria-invalid") == "true"
        )


def test_the_chosen_language_is_remembered(browser, served):
    with opened(browser, served, KINDS["numbers"]) as page:
        page.click("label:text-is('Rust')")
        page.goto(served + KINDS["message"])
        assert page.is_visible(".snippet.rust") and not page.is_visible(".snippet.c")


@pytest.mark.parametrize("path", KINDS.values(), ids=KINDS.keys())
@pytest.mark.parametrize("scheme", measure.SCHEMES)
def test_axe_reports_no_violation(browser, site, path, scheme):
    with opened(browser, site.as_uri() + "/", path, color_scheme=scheme) as page:
        assert measure.broken_rules(page) == []


@pytest.mark.parametrize("path", KINDS.values(), ids=KINDS.keys())
def test_no_page_is_too_wide_or_too_long(browser, site, path):
    """No page is wider than the screen, or longer than 8,000 pixels before anything is
    unfolded.
    """
    with opened(browser, site.as_uri() + "/", path) as page:
        for width in measure.WIDTHS:
            page.set_viewport_size({"width": width, "height": 900})
            assert (width, measure.faults(page, width)) == (width, [])


def test_dark_mode_follows_the_system_and_the_button(browser, served):
    background = "getComputedStyle(document.documentElement).backgroundColor"
    with opened(browser, served, "", color_scheme="dark") as page:
        dark = page.evaluate(background)
        page.click("#theme")
        light = page.evaluate(background)
        page.reload()
        assert (
            light == "rgb(255, 255, 255)"
            and dark != light
            and page.evaluate(background) == light
        )


def test_a_node_prints_with_a_page_for_each_message(browser, site, shipped):
    with opened(browser, site.as_uri() + "/", "bootloader/all-messages.html") as page:
        pdf = page.pdf(prefer_css_page_size=True, print_background=True)
    sheets = pdf.count(b"/Type /Page\n") or pdf.count(b"/Type /Page")
    assert (
        pdf.startswith(b"%PDF")
        and sheets >= len(shipped.node("bootloader").messages) + 1
    )


def test_without_javascript_only_search_and_decoder_are_missing(browser, site):
    with opened(
        browser, site.as_uri() + "/", KINDS["message"], java_script_enabled=False
    ) as page:
        assert not page.is_visible("#search") and not page.is_visible("#decoder")
        assert (
            page.is_visible("svg.layout")
            and page.is_visible(".fields")
            and page.is_visible(".snippet.c")
        )
        page.click("label:text-is('Python')")
        assert page.is_visible(".snippet.python") and not page.is_visible(".snippet.c")
        page.click("svg.layout [data-key='5']")
        assert page.url.endswith("#field-cubecontrol_signal_enabled")


def test_hostile_texts_are_shown_and_not_executed(browser, hostile_site):
    top = hostile_site.as_uri() + "/"
    paths = sorted(
        str(p.relative_to(hostile_site)) for p in hostile_site.rglob("*.html")
    )
    # The documents of icdgen have no word of the ICDs.
    paths = [path for path in paths if not path.startswith("icdgen-docs/")]
    assert len(paths) > 8
    with opened(browser, top, paths[0]) as page:
        for path in paths:
            page.goto(top + path)
            assert page.title() != "broken" and page.locator("img").count() == 0, path
    with opened(browser, top, "hostile/index_.html") as page:
        text = page.inner_text("main")
        assert (
            "<script>document.title" in text and "{{ 7*7 }}" in text and "&lt;" in text
        )
        page.fill("#frame", "ff" * 33)
        assert page.input_value("#raw-1") == "18446744073709551615"
        assert (
            page.input_value("#raw-5") == "0xFFFFFFFF"
            and page.input_value("#raw-6") == "FF FF"
        )
        page.fill("#search", "endless")
        assert len(results(page)) >= 3
