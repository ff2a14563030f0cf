"""The manual of icdgen as part of the site."""

from __future__ import annotations

import re

from icdgen.backends.html import guide
from tests import documents
from tests.site.test_find import found


def test_every_page_of_the_manual_is_on_the_site_with_all_its_headings(site):
    names = sorted(path.relative_to(documents.DOCS).with_suffix("").as_posix() for path in documents.pages())
    assert sorted(page.name for page in guide.pages()) == names and len(names) > 7
    for page in guide.pages():
        source = re.sub("^```.*?^```", "", documents.text(page.name), flags=re.S | re.M)
        assert len(re.findall("^#{1,6} ", source, flags=re.M)) == len(page.sections)
        assert (site / page.url).is_file()


def test_html_in_markdown_is_text(tmp_path):
    path = tmp_path / "strange.md"
    path.write_text(
        "# <script>alert(1)</script>\n\n<img src=x onerror=alert(1)> [x](javascript:alert(1)) ![y](http://z/)\n"
    )
    html = guide._page(path).html
    assert "<script" not in html and "<img" not in html and "href" not in html and "&lt;script&gt;" in html


def test_links_lead_to_pages_and_what_is_not_there_is_text(tmp_path):
    (tmp_path / "b.md").write_text("# B\n")
    path = tmp_path / "a.md"
    path.write_text("# A\n\n[to b](b.md#b) [to c](c.md) [away](https://x.org/) [up](../d.md) [here](#a)\n")
    html = guide._page(path).html
    assert re.findall('href="([^"]*)"', html) == ["b.html#b", "#a"] and "to c away up" in html


def test_the_search_finds_the_manual(site):
    asked = {
        "icd format": "reference/icd-format.html",
        "describe a device": "guides/describe-a-device.html",
        "wire layer": "reference/wire.html",
        "compare releases": "guides/compare-releases.html",
        "simulator": "guides/simulator.html",
        "errata": "guides/errata.html",
        "slip": "guides/serial-link.html",
        "dbc": "guides/import-can.html",
        "mavlink dialect": "guides/import-mavlink.html",
        "pdf manual": "guides/import-a-manual.html",
        "rust": "guides/rust.html",
        "python asyncio": "guides/python.html",
        "driver": "guides/driver-in-c.html",
        "lookup table": "guides/scales.html",
        "variable length": "guides/variable-length.html",
        "yamcs": "guides/yamcs.html",
        "ICD055": "reference/rules.html",
        "icdgen.toml": "reference/configuration.html",
        "shell completion": "reference/configuration.html",
        "what is not supported": "explanation/not-supported.html",
        "glossary": "glossary.html",
        "verification": "guides/verification-package.html",
    }
    results = zip(asked.items(), found(site, list(asked)), strict=True)
    missed = {q: r[:3] for (q, page), r in results if not any(f"icdgen-docs/{page}" in url for url in r[:3])}
    assert missed == {}
