"""The site has exactly the pages, scripts and indices of its ICDs."""

from __future__ import annotations

import json
import re

import pytest

from icdgen import backends
from icdgen.backends.html import guide, site
from icdgen.backends.packages import Packages
from icdgen.diff.inputs.side import ComparisonSide
from icdgen.render import Renderer
from tests.icd.files import loaded

ICD = """\
protocol:
  log_mask: {bytes: 1, frame_bytes: 2}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}]}
messages:
  - {name: Status, id: 0, kind: telemetry, length: 1, fields: [
      {at: 0, bits: 8, name: Mode, type: enum, enum: Mode}]}
  - {name: Stop, id: 255, kind: telecommand, length: 1}
  - {name: Go, id: 254, kind: telecommand, length: 1}
"""
PAGES = [
    "index.html",
    "errata.html",
    "units.html",
    "changes.html",
    "demo/index.html",
    "demo/protocol.html",
    "demo/status.html",
    "demo/stop.html",
    "demo/go.html",
    "demo/all-messages.html",
    "demo/enum-mode.html",
]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Return the site without the documentation of icdgen."""
    icd = loaded(tmp_path_factory.mktemp("icd"), ICD).icd
    render = Renderer.of_backend(backends.get("html"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(guide, "pages", list)
        previous = ComparisonSide("old", icd)
        made = site.files(icd, render, Packages(), previous)
        return {str(path): content for path, content in made}


def test_every_object_has_a_page(files):
    assert [name for name in files if name.endswith(".html")] == PAGES
    assert 'href="changes.html"' in files["index.html"]
    assert 'href="../changes.html"' in files["demo/stop.html"]


def test_each_message_links_to_the_one_before_and_after_it(files):
    for name, links in {
        "status": [("next", "stop")],
        "stop": [("prev", "status"), ("next", "go")],
        "go": [("prev", "stop")],
    }.items():
        page = files[f"demo/{name}.html"]
        assert re.findall(r'<a rel="(\w+)" href="../demo/(\w+).html">', page) == links


def test_scripts_and_indices_come_last(files):
    names = [name for name in files if not name.endswith(".html")]
    assert names[0] == "demo/contents.js"
    assert names[1:5] == ["style.css", "layout.css", "print.css", "icon.svg"]
    assert names[-5:] == [
        "protocol.js",
        "search-index.js",
        "frame-index.js",
        "icd.json",
        "llms.txt",
    ]
    assert json.loads(files["icd.json"])["nodes"][0]["name"] == "demo"
    assert files["icd.json"].endswith("}\n")


def test_a_page_loads_every_script_that_the_site_has(files):
    loaded = {
        name
        for text in files.values()
        for name in re.findall(
            r'(?:src|href)="(?:\.\./)?([\w-]+\.(?:js|css|svg))"', text
        )
    }
    assert loaded <= files.keys()
