"""The files of the site are small, reproducible and valid, and every link and anchor
resolves.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from collections import Counter
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from icdgen.site import make_site
from tests.conformance.icds import COMMITTED
from tests.conftest import DEMO, ROOT
from tests.site.conftest import program, tool
from tests.site.pages import KINDS


class ParsedPage(HTMLParser):
    """Anchors and links of a page, and the resources that it loads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        # Ids that labels, aria attributes and similar refer to.
        self.refers: list[str] = []
        self.feed(text)

    def handle_starttag(
        self, tag: str, attributes: list[tuple[str, str | None]]
    ) -> None:
        for name, value in attributes:
            if name == "id":
                self.ids.append(value or "")
            elif name in ("href", "src"):
                self.links.append(value or "")
            elif name in (
                "for",
                "aria-labelledby",
                "aria-controls",
                "aria-describedby",
            ):
                self.refers += (value or "").split()


def broken_links(folder: Path) -> list[str]:
    """Return every broken link and every duplicate id of the site."""
    pages = {
        path.relative_to(folder): ParsedPage(path.read_text("utf-8"))
        for path in sorted(folder.rglob("*.html"))
    }
    faults = []
    for path, page in pages.items():
        faults += [
            f"{path}: id {name} stands {n} times"
            for name, n in Counter(page.ids).items()
            if n > 1
        ]
        faults += [
            f"{path}: nothing has id {name}"
            for name in page.refers
            if name not in page.ids
        ]
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or link.startswith("/"):
                faults.append(f"{path}: {link} leaves the site")
                continue
            target = (
                (folder / path.parent / unquote(parts.path)).resolve()
                if parts.path
                else (folder / path).resolve()
            )
            if not target.is_file():
                faults.append(f"{path}: {link} is no file")
            elif parts.fragment and not parts.fragment.startswith("try="):
                ids = pages[target.relative_to(folder.resolve())].ids
                if unquote(parts.fragment) not in ids:
                    faults.append(f"{path}: {link} has no anchor")
    return faults


def test_the_site_is_small_and_has_a_page_for_everything(site, shipped):
    # The pages of the reference take 1 MB.
    assert sum(path.stat().st_size for path in site.rglob("*")) < 12_500_000
    for node in shipped.nodes:
        pages = {path.name for path in (site / node.name).glob("*.html")}
        talks = bool(shipped.protocol_of(node))
        assert len(pages) == len(node.messages) + len(node.enums) + 2 + talks
        assert ("protocol.html" in pages) == talks


def test_the_site_is_the_same_each_time():
    first, second = make_site([ROOT / "icd"]).files, make_site([ROOT / "icd"]).files
    assert first == second and len(first) > 200


def test_every_link_and_anchor_resolves(site):
    assert broken_links(site) == []


def test_every_link_and_anchor_resolves_whatever_the_names(hostile_site):
    assert broken_links(hostile_site) == []


def test_the_checker_detects_broken_links(tmp_path):
    (tmp_path / "a.html").write_text(
        '<p id="x"></p><p id="x"></p><a href="b.html">b</a><a href="#y">y</a><img src="//x.org/">'
    )
    assert [line.split(": ")[1] for line in broken_links(tmp_path)] == [
        "id x stands 2 times", "b.html is no file", "#y has no anchor", "//x.org/ leaves the site",
    ]  # fmt: skip


def test_the_index_of_the_search_leads_to_pages_and_anchors(site):
    text = (site / "search-index.js").read_text("utf-8")
    entries = json.loads(text[text.index("[") : text.rindex("]") + 1])
    pages = {
        str(p.relative_to(site)): set(ParsedPage(p.read_text("utf-8")).ids)
        for p in site.rglob("*.html")
    }
    for _, title, *_, url in entries:
        path, _, anchor = url.partition("#")
        assert not anchor or anchor in pages[path], title
    kinds = Counter(entry[0] for entry in entries)
    assert (
        kinds["message"] == 171
        and kinds["field"] == 1251
        and kinds["member"] > 200
        and kinds["erratum"] > 20
        and kinds["note"] > 200
    )


@pytest.mark.parametrize("fixture_name", ["site", "hostile_site"])
def test_the_pages_are_valid_html(fixture_name, request, tmp_path):
    folder = request.getfixturevalue(fixture_name)
    names = (
        KINDS.values()
        if fixture_name == "site"
        else [str(p.relative_to(folder)) for p in folder.rglob("*.html")]
    )
    config = Path(__file__).parent / "npm" / ".htmlvalidate.json"
    command = [
        program("node"),
        str(tool("html-validate/bin/html-validate.mjs")),
        "--config",
        str(config),
        "-f",
        "text",
    ]
    done = subprocess.run(
        [*command, *(str(folder / name) for name in names)],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_one_json_and_llms_txt_contain_everything(site, shipped):
    data = json.loads((site / "icd.json").read_text("utf-8"))
    assert [node["name"] for node in data["nodes"]] == [
        node.name for node in shipped.nodes
    ]
    text = (site / "llms.txt").read_text("utf-8")
    assert all(
        message.name in text for node in shipped.nodes for message in node.messages
    )
    links = [part.split(")")[0] for part in text.split("](")[1:]]
    assert len(links) > 200 and all((site / link).is_file() for link in links)


def test_a_field_keeps_its_link_when_everything_around_it_changes(tmp_path, demo):
    before = make_site([demo]).files["demo/estimated_roll.html"]
    text = (
        demo.read_text("utf-8")
        .replace("id: 146", "id: 150")
        .replace("at: 0,  bits: 16", "at: 8, bits: 16")
    )
    demo.write_text(text.replace("at: 16, bits: 4", "at: 0, bits: 4"), "utf-8")
    after = make_site([demo]).files["demo/estimated_roll.html"]
    assert (
        "field-roll_angle" in ParsedPage(before).ids
        and "field-roll_angle" in ParsedPage(after).ids
    )


def test_pages_load_scripts_and_styles_only_from_their_folder(site):
    for name in KINDS.values():
        text = (site / name).read_text("utf-8")
        assert "script-src 'self';" in unescape(
            text
        ) and "default-src 'none'" in unescape(text)
        assert (
            " style=" not in text and " onclick=" not in text and "<style" not in text
        )


def test_a_page_lists_the_frames_of_the_golden_vectors(site, shipped):
    from icdgen.backends.html.links import Links

    links = Links(shipped)
    for node in shipped.nodes:
        vectors = json.loads((COMMITTED / f"{node.name}.json").read_text("utf-8"))
        for message, data in zip(node.messages, vectors["messages"], strict=True):
            text = (site / links.message(message)).read_text("utf-8")
            listed = text.partition('<dl class="frames">')[2].partition("</dl>")[0]
            shown = [
                bytes.fromhex(part.partition("<")[0]).hex()
                for part in listed.split("<dd>")[1:]
            ]
            assert shown == [
                vector["bytes"] for vector in data["vectors"] if message.length
            ], message.name


def test_the_page_of_changes_draws_both_layouts_as_the_diff_does(tmp_path):
    from icdgen.diff import report
    from icdgen.diff.inputs import one_side
    from icdgen.diff.reports import html

    old = tmp_path / "icd"
    shutil.copytree(ROOT / "icd", old)
    acp = old / "cubeacp.yaml"
    text = acp.read_text("utf-8")
    assert "at: 0,  bits: 16, name: X Magnetorquer Command" in text
    acp.write_text(
        text.replace(
            "at: 0,  bits: 16, name: X Magnetorquer Command",
            "at: 0,  bits: 15, name: X Magnetorquer Command",
        )
    )
    page = make_site([ROOT / "icd"], str(old)).files["changes.html"]
    report_html = html.report(
        report.make_report(one_side(str(old), []), one_side(str(ROOT / "icd"), []))
    )
    drawings = [
        part.partition("</svg>")[0] for part in page.split('<svg class="layouts"')[1:]
    ]
    assert drawings and drawings == [
        part.partition("</svg>")[0]
        for part in report_html.split('<svg class="layouts"')[1:]
    ]


def test_a_removed_message_is_on_the_page_of_changes_without_a_link(tmp_path):
    gone = {
        "name": "Old Mode",
        "id": 250,
        "kind": "telecommand",
        "length": 0,
        "fields": [],
    }
    (tmp_path / "old").mkdir()
    (tmp_path / "new").mkdir()
    for side, more in (("old", f"  - {json.dumps(gone)}\n"), ("new", "")):
        (tmp_path / side / "demo.yaml").write_text(
            DEMO.rstrip("\n") + "\n" + more, "utf-8"
        )
    result = make_site([tmp_path / "new"], str(tmp_path / "old"))
    assert result.ok and "<h3><del>Old Mode</del>" in result.files["changes.html"]
