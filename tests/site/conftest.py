"""The site of the shipped ICDs, made once, a site of hostile names, and a browser to
look at them.
"""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from http.server import ThreadingHTTPServer
from pathlib import Path

import pytest

from icdgen.loading import load
from icdgen.site import make_site, write_site
from icdgen.site.serve import HOST, SiteSource, handler
from tests.conftest import ROOT
from tests.site import hostile, pages

TOOLS = Path(__file__).parent / "npm" / "node_modules"


def program(*names: str) -> str:
    """The first of the programs that is there; scripts/test installs them."""
    found = next((path for name in names if (path := shutil.which(name))), None)
    assert found, f"scripts/test installs {names[0]}"
    return found


def tool(path: str) -> Path:
    """A file of an npm package of ``npm/``."""
    found = TOOLS / path
    assert found.exists(), "scripts/test installs it: npm ci --prefix tests/site/npm"
    return found


@pytest.fixture(scope="session")
def site(tmp_path_factory) -> Path:
    """A folder with the site of the shipped ICDs, compared with an older release."""
    out = tmp_path_factory.mktemp("site")
    pages.shipped(out, tmp_path_factory.mktemp("old"))
    return out


@pytest.fixture(scope="session")
def shipped():
    return load([ROOT / "icd"]).icd


@pytest.fixture(scope="session")
def strange(tmp_path_factory) -> Path:
    """A folder with the site of ICDs that try to break it."""
    folder = tmp_path_factory.mktemp("strange")
    made = make_site([hostile.write(folder / "icd")])
    assert made.ok, made.findings
    write_site(made, folder / "site")
    return folder / "site"


@pytest.fixture(scope="session")
def served() -> Iterator[str]:
    """Address of a server of the shipped site."""
    server = ThreadingHTTPServer((HOST, 0), handler(SiteSource([ROOT / "icd"])))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


@pytest.fixture(
    scope="package"
)  # while it is open, an event loop runs in this thread, and tests of asyncio fail
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        found = playwright.chromium.launch(
            executable_path=program("chromium", "chromium-browser", "google-chrome"),
            args=["--no-sandbox"],
        )
        yield found
        found.close()
