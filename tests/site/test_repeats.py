"""Arrays on the page of a message: one element is drawn, all can be decoded, and the
page stays fast.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from icdgen.backends.html import fields, sections
from icdgen.backends.html.plan import message_plan
from icdgen.backends.html.relations import Relations
from icdgen.icd import schema
from icdgen.loading import load
from icdgen.site import make_site, write_site
from tests.conftest import ROOT
from tests.describe.test_display import in_page
from tests.site.test_browser import opened

DEVICES = ROOT / "examples" / "devices"
NAV_SAT, MON_VER = "ublox/nav_sat.html", "ublox/mon_ver.html"
SATELLITE = "02 07 2B 2E 01 00 0A 00 3F 12 34 00"
FRAME = f"00 00 00 00 01 02 00 00 {'00 ' * 12}{SATELLITE}"
NESTED = {
    "icdgen": 1,
    "node": {"name": "nested", "title": "Nested", "byte_order": "little", "bit_order": "lsb0"},
    "structs": [
        {"name": "Signal", "length": 2, "fields": [{"at": 0, "bits": 8, "name": "Level", "type": "uint"}]},
        {"name": "Channel", "length": 10, "fields": [
            {"at": 0, "bits": 8, "name": "Number", "type": "uint"},
            {"at": 8, "name": "Signals", "struct": "Signal", "count": 4},
        ]},
    ],
    "messages": [{"name": "State", "id": 1, "kind": "telemetry", "length": 123, "fields": [
        {"at": 0, "bits": 8, "name": "Before", "type": "uint"},
        {"at": 8, "name": "Channels", "struct": "Channel", "count": 3},
        {"at": 248, "bits": 16, "name": "Samples", "type": "uint", "count": 20},
        {"at": 568, "bits": 8, "name": "Few", "type": "uint", "count": 3},
        {"at": 600, "bits": 1, "name": "Flags", "type": "bool", "count": 40},
        {"at": 648, "bits": 8, "name": "After", "type": "uint"},
    ], "derived": [{"name": "Double", "formula": "2*Before"}]}],
}  # fmt: skip


@pytest.fixture(scope="module")
def ublox(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("ublox")
    write_site(make_site([DEVICES / "ublox" / "ublox.yaml"]), out)
    return out


@pytest.fixture(scope="module")
def many_satellites(tmp_path_factory) -> Path:
    """Generate a site with up to 1,024 satellites in NAV-SAT."""
    folder = tmp_path_factory.mktemp("many")
    text = (DEVICES / "ublox" / "ublox.yaml").read_text("utf-8")
    text = text.replace("bits: 8, name: numSvs", "bits: 16, name: numSvs")
    text = text.replace("count: numSvs, up_to: 64", "count: numSvs, up_to: 1024")
    (folder / "ublox.yaml").write_text(text, "utf-8")
    write_site(make_site([folder / "ublox.yaml"]), folder / "site")
    return folder / "site"


@pytest.fixture(scope="module")
def icds(tmp_path_factory):
    folder = tmp_path_factory.mktemp("nested")
    (folder / "nested.yaml").write_text(json.dumps(NESTED), encoding="utf-8")
    return [
        load([path]).icd
        for path in (
            *sorted(DEVICES.rglob("*.yaml")),
            folder / "nested.yaml",
            ROOT / "icd",
        )
    ]


def test_each_field_is_in_the_tables_once_and_can_be_decoded(icds):
    for icd in icds:
        relations = Relations(icd)
        for node in icd.nodes:
            for message in node.messages:
                shown = relations.links.repeats(message).fields
                rows = fields.rows(message, relations.links)
                parts = sections.part_sections(
                    relations, message
                ) or sections.field_sections(message, relations.links.repeats(message))
                keys = [
                    flag.key
                    for cells in fields.split(rows, parts)
                    for cell in cells
                    for flag in getattr(cell, "flags", [cell])
                    if flag.key
                ]
                assert sorted(keys) == [
                    field.key for field in shown if not field.place.is_count
                ], message.name
                for field in shown:
                    assert message.fields[field.key - 1].name == field.place.name


def test_the_page_lists_the_fields_of_all_elements_itself(icds):
    plans, names = [], []
    for icd in icds:
        for node in icd.nodes:
            for message in node.messages:
                plans.append(message_plan(message, node))
                names.append([field.name for field in message.fields])
    listed = "((plans) => plans.map((plan) => codec.expanded(plan).fields.map((field) => field.name)))"
    assert in_page(listed, plans) == names
    nav_sat = next(plan for plan in plans if plan["name"] == "NAV-SAT")
    assert len(nav_sat["fields"]) == 4


def test_an_array_has_one_section_with_its_count(icds):
    ublox = next(icd for icd in icds if icd.nodes[0].name == "ublox")
    titles = [
        band.title
        for band in sections.part_sections(
            Relations(ublox), message_of(ublox, "NAV-SAT")
        )
    ]
    assert titles == ["Bytes 0 to 7", "satellites × 0 to 64"]
    nested = next(icd for icd in icds if icd.nodes[0].name == "nested")
    relations, message = Relations(nested), message_of(nested, "State")
    parts = sections.part_sections(relations, message)
    assert [(part.title, part.first, part.end) for part in parts] == [
        ("Byte 0", 0, 1),
        ("Channels × 3", 1, 2),
        ("Channels[].Signals × 4", 2, 4),
        ("Channels × 3", 10, 11),
        ("Samples × 20", 31, 33),
        ("Bytes 71 to 122", 71, 123),
    ]
    names = [name for name, _ in relations.shown_fields(message)]
    assert names[:5] == [
        "Before",
        "Channels[].Number",
        "Channels[].Signals[].Level",
        "Samples",
        "Few[0]",
    ]


def message_of(icd, name: str):
    return next(
        message
        for node in icd.nodes
        for message in node.messages
        if message.name == name
    )


def test_a_page_of_64_satellites_loads_within_a_second(browser, ublox):
    with opened(browser, ublox.as_uri() + "/", NAV_SAT) as page:
        times = []
        # The fastest of three runs counts, because other programs use the machine
        # too.
        for _ in range(3):
            page.reload()
            times.append(
                page.evaluate("performance.getEntriesByType('navigation')[0].duration")
            )
        assert min(times) < 1000, times
        assert page.evaluate("document.querySelectorAll('*').length") < 3000


def test_a_field_under_the_pointer_is_highlighted_within_50_milliseconds(
    browser, ublox
):
    with opened(browser, ublox.as_uri() + "/", NAV_SAT) as page:
        page.fill("#frame", FRAME)
        times = page.evaluate("""async () => {
            const times = [];
            for (const shape of [...document.querySelectorAll("svg.layout a")].slice(0, 12)) {
                const row = document.querySelector(`.fields [data-key="${shape.dataset.key}"]`);
                const start = performance.now();
                shape.dispatchEvent(new PointerEvent("pointerover", { bubbles: true }));
                if (!getComputedStyle(row).getPropertyValue("--tie").trim()) throw new Error(shape.dataset.key);
                document.body.getBoundingClientRect();
                times.push(performance.now() - start);
                await new Promise(requestAnimationFrame);
            }
            return times.sort((a, b) => a - b);
        }""")
        assert len(times) == 12 and times[6] < 50, times


def test_all_satellites_of_a_frame_are_decoded_and_one_can_be_added(browser, ublox):
    with opened(browser, ublox.as_uri() + "/", NAV_SAT) as page:
        page.fill("#frame", FRAME)
        summaries = page.locator("#decoder summary:visible")
        assert [text.partition(",")[0] for text in summaries.all_inner_texts()] == [
            "Fields", "satellites[0]", "satellites[1]", "satellites[2]",
        ]  # fmt: skip
        summaries.nth(2).click()
        fold = page.locator("#decoder details:has(summary:text('satellites[1]'))")
        assert fold.get_by_label("satellites[1].svId, raw").input_value() == "7"
        assert fold.get_by_label("satellites[1].gnssId, value").input_value() == "2"
        fold.locator("tr:has-text('satellites[1].cno')").hover()
        assert (
            page.locator("svg.layout .tied").get_attribute("href")
            == "#field-satellites_cno"
        )
        summaries.nth(3).click()
        page.get_by_label("satellites[2].svId, raw").fill("9")
        page.get_by_label("satellites[2].svId, raw").blur()
        assert (
            page.input_value("#frame").startswith("00 00 00 00 01 03")
            and len(page.input_value("#frame").split()) == 44
        )
        assert summaries.count() == 5


def test_a_page_of_1024_satellites_stays_small_and_decodes_them(
    browser, ublox, many_satellites
):
    few, many = (
        (folder / NAV_SAT).read_text("utf-8") for folder in (ublox, many_satellites)
    )
    assert len(many) < 3 * len(few)
    assert "All 67 frames" in few and re.search(r"The first \d+ frames", many)
    with opened(browser, many_satellites.as_uri() + "/", NAV_SAT) as page:
        page.fill("#frame", f"00 00 00 00 01 00 04 00 {'00 ' * 12 * 1023}{SATELLITE}")
        fold = page.locator("#decoder details:has(summary:text('satellites[1023],'))")
        assert "bytes 12284 to 12295, 26 fields" in fold.inner_text()
        fold.locator("summary").click()
        assert fold.get_by_label("satellites[1023].svId, raw").input_value() == "7"


def test_a_link_to_a_field_of_a_struct_leads_to_its_row(browser, ublox):
    with opened(
        browser, ublox.as_uri() + "/", f"{NAV_SAT}#field-satellites_elev"
    ) as page:
        assert (
            page.locator("svg.layout .tied").get_attribute("href")
            == "#field-satellites_elev"
        )
        assert page.is_visible("tr:target")


def test_the_search_has_a_field_of_a_struct_once(ublox):
    index = (ublox / "search-index.js").read_text("utf-8")
    assert index.count('"satellites[].elev"') == 1 and "satellites[1]" not in index


@pytest.mark.parametrize("sheet", ["style.css", "print.css"])
def test_each_type_of_field_has_a_colour(sheet):
    types = set(
        json.loads(schema.PATH.read_text("utf-8"))["$defs"]["field"]["properties"][
            "type"
        ]["enum"]
    )
    styles = (ROOT / "templates" / "html" / sheet).read_text("utf-8")
    assert "text" in types and types <= set(re.findall(r"--t-(\w+):", styles))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_is_drawn_in_its_colour(browser, ublox, scheme):
    with opened(browser, ublox.as_uri() + "/", MON_VER, color_scheme=scheme) as page:
        fills = page.evaluate(
            """[...document.querySelectorAll("svg.layout a rect")].map((one) => getComputedStyle(one).fill)"""
        )
        assert len(fills) == 3 and "rgb(0, 0, 0)" not in fills


def test_the_number_of_omitted_bytes_is_next_to_the_name(browser, ublox):
    with opened(browser, ublox.as_uri() + "/", MON_VER) as page:
        overlaps = page.evaluate("""() => {
            const boxes = (selector) => [...document.querySelectorAll(selector)].map((one) => one.getBoundingClientRect());
            return boxes("svg.layout .skip-rows").some((a) => boxes("svg.layout a text").some((b) =>
                a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom));
        }""")
        assert not overlaps
