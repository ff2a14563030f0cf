"""The manual of icdgen is part of the site."""

from __future__ import annotations

import re

from icdgen.backends.html import guide
from tests import documents
from tests.site.test_find import search_results


def test_every_page_of_the_manual_is_on_the_site_with_all_its_headings(site):
    names = sorted(
        path.relative_to(documents.DOCS).with_suffix("").as_posix()
        for path in documents.pages()
    )
    assert sorted(page.name for page in guide.pages()) == names and len(names) > 7
    for page in guide.pages():
        source = re.sub("^```.*?^```", "", documents.text(page.name), flags=re.S | re.M)
        assert len(re.findall("^#{1,6} ", source, flags=re.M)) == len(page.sections)
        assert (site / page.url).is_file()


def test_html_in_markdown_is_escaped(tmp_path):
    path = tmp_path / "strange.md"
    path.write_text(
        "# <script>alert(1)</script>\n\n<img src=x onerror=alert(1)> [x](javascript:alert(1)) ![y](http://z/)\n"
    )
    html = guide._page(path).html
    assert (
        "<script" not in html
        and "<img" not in html
        and "href" not in html
        and "&lt;script&gt;" in html
    )


def test_links_lead_to_pages_and_links_to_missing_files_become_text(tmp_path):
    (tmp_path / "b.md").write_text("# B\n")
    path = tmp_path / "a.md"
    path.write_text(
        "# A\n\n[to b](b.md#b) [to c](c.md) [away](https://x.org/) [up](../d.md) [here](#a)\n"
    )
    html = guide._page(path).html
    assert (
        re.findall('href="([^"]*)"', html) == ["b.html#b", "#a"]
        and "to c away up" in html
    )


TASKS = {  # query -> the page for the task
    "describe a device": "guides/describe-a-device",
    "my device sends SLIP": "guides/serial-link",
    "cobs": "guides/serial-link",
    "dle etx": "guides/serial-link",
    "crc of a frame": "guides/serial-link",
    "I have a DBC, I want Rust": "guides/import-can",
    "import dbc": "guides/import-can",
    "mavlink dialect": "guides/import-mavlink",
    "import xtce": "guides/import-xtce",
    "sunspec": "guides/import-sunspec",
    "kaitai": "guides/import-kaitai",
    "pdf manual": "guides/import-a-manual",
    "driver": "guides/driver-in-c",
    "rust": "guides/rust",
    "python asyncio": "guides/python",
    "simulator": "guides/simulator",
    "how do I test without hardware": "guides/simulator",
    "log to csv": "guides/simulator",
    "golden vectors": "guides/golden-vectors",
    "test own decoder": "guides/golden-vectors",
    "self-test": "guides/golden-vectors",
    "decode a frame": "guides/decode-frames",
    "compare releases": "guides/compare-releases",
    "semantic diff": "guides/compare-releases",
    "yamcs": "guides/yamcs",
    "lookup table": "guides/scales",
    "variable length": "guides/variable-length",
    "optional field": "guides/variable-length",
    "array": "guides/arrays-and-structs",
    "errata": "guides/errata",
    "add a language": "guides/add-a-language",
    "traceability": "guides/verification-package",
    "what does ICD055 mean": "reference/rules",
    "icdgen.toml": "reference/configuration",
    "shell completion": "reference/configuration",
    "icd format": "reference/icd-format",
    "wire layer": "reference/wire",
    "what is not supported": "explanation/not-supported",
    "glossary": "glossary",
}


def test_the_first_result_of_the_search_is_the_page_for_the_task(site):
    results = zip(TASKS.items(), search_results(site, list(TASKS)), strict=True)
    page = re.compile(r"icdgen-docs/(.*)\.html(#.*)?")
    first = {
        words: page.fullmatch(urls[0]) if urls else None for (words, _), urls in results
    }
    missed = {
        words: match and match[0]
        for words, match in first.items()
        if not match or match[1] != TASKS[words]
    }
    assert missed == {}
