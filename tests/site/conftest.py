"""Fixtures: the site of the shipped ICDs, generated once, a site of hostile names, and
a browser.
"""

from __future__ import annotations

import json
import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

from icdgen.loading import load
from icdgen.site import make_site, write_site
from icdgen.site.serve import HOST, SiteSource, handler
from tests.conftest import ROOT
from tests.site import hostile, pages

TOOLS = Path(__file__).parent / "npm" / "node_modules"


def program(*names: str) -> str:
    """Return the path of the first installed program. scripts/test installs them."""
    program_path = next((path for name in names if (path := shutil.which(name))), None)
    assert program_path, f"scripts/test installs {names[0]}"
    return program_path


def tool(path: str) -> Path:
    """Return the path of a file of an npm package of ``npm/``."""
    path_of_tool = TOOLS / path
    assert path_of_tool.exists(), (
        "scripts/test installs it: npm ci --prefix tests/site/npm"
    )
    return path_of_tool


@pytest.fixture(scope="session")
def site(tmp_path_factory) -> Path:
    """Generate the site of the shipped ICDs, compared with an older release, and return
    its folder.
    """
    out = tmp_path_factory.mktemp("site")
    pages.shipped(out, tmp_path_factory.mktemp("old"))
    return out


@pytest.fixture(scope="session")
def shipped():
    return load([ROOT / "icd"]).icd


@pytest.fixture(scope="session")
def hostile_site(tmp_path_factory) -> Path:
    """Generate the site of ICDs with hostile texts and return its folder."""
    folder = tmp_path_factory.mktemp("strange")
    result = make_site([hostile.write(folder / "icd")])
    assert result.ok, result.findings
    write_site(result, folder / "site")
    return folder / "site"


@pytest.fixture(scope="session")
def served() -> Iterator[str]:
    """Serve the shipped site and return its address."""
    server = ThreadingHTTPServer((HOST, 0), handler(SiteSource([ROOT / "icd"])))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


class OpenPages:
    """A browser that keeps one page for each look (color scheme, size, permissions) and
    uses it again: opening an address takes 0.2 s of processor time, a new context 1 s.
    """

    def __init__(self, chromium) -> None:
        self.chromium = chromium
        self.kept: dict[str, Any] = {}

    @contextmanager
    def page(self, **look: Any) -> Iterator[Any]:
        """Lend the page of a look as if it were new. It is not kept if the test fails or
        another address is still being opened.
        """
        from playwright.sync_api import Error

        key = json.dumps(look, sort_keys=True)
        page = self.kept.pop(key, None) or self.chromium.new_context(**look).new_page()
        page.set_viewport_size(look.get("viewport", {"width": 1280, "height": 720}))
        page.mouse.move(0, 0)
        try:
            yield page
        except BaseException:
            page.context.close()
            raise
        try:
            page.goto("about:blank")
        except Error:
            page.context.close()
        else:
            self.kept[key] = page


# While the browser is open, an event loop runs in this thread, and tests of asyncio
# fail.
@pytest.fixture(scope="package")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=program("chromium", "chromium-browser", "google-chrome"),
            args=["--no-sandbox"],
        )
        yield OpenPages(chromium)
        chromium.close()
