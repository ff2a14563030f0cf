"""Take pictures of each kind of page: on a desktop, a tablet and a phone, light and
dark, and printed.

Run ``python -m tests.site.pictures FOLDER``.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from tests.conftest import ROOT
from tests.site.conftest import program
from tests.site.pages import KINDS, shipped

WIDTHS = {1440: 1000, 768: 1000, 390: 844}
LOOKS = {
    f"{width}-{scheme}": {
        "viewport": {"width": width, "height": height},
        "color_scheme": scheme,
    }
    for width, height in WIDTHS.items()
    for scheme in ("light", "dark")
}
README = {"viewport": {"width": 1180, "height": 900}, "device_scale_factor": 1.5}


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m tests.site.pictures", description=__doc__
    )
    parser.add_argument("folder", type=Path, help="where the pictures go")
    parser.add_argument(
        "--readme",
        action="store_true",
        help="only the picture of the README, into docs/images",
    )
    options = parser.parse_args()
    site = options.folder / "site"
    with tempfile.TemporaryDirectory() as old:
        shipped(site, Path(old))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program("chromium"), args=["--no-sandbox"]
        )
        if options.readme:
            target = ROOT / "docs" / "images" / "message.png"
            target.parent.mkdir(exist_ok=True)
            page = browser.new_page(**README)
            page.goto((site / KINDS["message"]).as_uri() + "#try=8421ff0f3412")
            page.evaluate("scrollTo(0, 0)")
            page.screenshot(path=target)
            return
        for look, settings in LOOKS.items():
            page = browser.new_page(**settings)
            page.goto((site / KINDS["home"]).as_uri())
            page.fill("#search", "attitude")
            page.wait_for_selector("#results a")
            page.screenshot(path=options.folder / f"search-{look}.png")
            page.close()
        for kind, name in KINDS.items():
            for look, settings in LOOKS.items():
                page = browser.new_page(**settings)
                page.goto((site / name).as_uri())
                page.screenshot(path=options.folder / f"{kind}-{look}.png")
                page.close()
            page = browser.new_page()
            page.goto((site / name).as_uri())
            page.pdf(
                path=options.folder / f"{kind}.pdf",
                prefer_css_page_size=True,
                print_background=True,
            )
            page.close()


if __name__ == "__main__":
    main()
