"""``python -m tests.site.measure [SITE]``: what is cut or too long on any page, at each
width.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from tests.site.conftest import program, tool
from tests.site.pages import shipped

WIDTHS = (1440, 768, 390)
HIGHEST = 8000  # pixels of a page before anything is unfolded
SCHEMES = ("light", "dark")

# Elements that reach beyond the screen and do not stand in something that scrolls.
_CUT = """() => [...document.querySelectorAll("body *")].filter((one) => {
    const box = one.getBoundingClientRect();
    const hidden = one.closest(".scroll, pre, .hidden, .skip, legend, details:not([open]) > :not(summary), svg, .local, .tabs");
    return !hidden && box.width > 0 && box.right > innerWidth + 1;
}).map((one) => one.outerHTML.slice(0, 80))"""


def faults(page, width: int) -> list[str]:
    """What is wrong with the open page at its width."""
    wide, high = page.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    found = [f"cut: {one}" for one in page.evaluate(_CUT)]
    found += [f"{wide} pixels wide"] if wide > width else []
    return found + ([f"{high} pixels high"] if high > HIGHEST else [])


def broken_rules(page) -> list[str]:
    """What axe finds on the open page."""
    page.evaluate(tool("axe-core/axe.min.js").read_text("utf-8"))
    found = page.evaluate("axe.run({ resultTypes: ['violations'], preload: false })")
    return [
        f"{one['id']}: {[node['target'] for node in one['nodes']][:5]}"
        for one in found["violations"]
    ]


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.site.measure", description=__doc__
    )
    parser.add_argument(
        "site",
        type=Path,
        nargs="?",
        help="folder of the site (default: that of the shipped ICDs)",
    )
    parser.add_argument("--every", type=int, default=1, help="only each n-th page")
    parser.add_argument(
        "--axe",
        action="store_true",
        help="ask axe of it, in light and dark, instead of measuring",
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        site = options.site or Path(folder)
        if options.site is None:
            with tempfile.TemporaryDirectory() as old:
                shipped(site, Path(old))
        pages = sorted(site.resolve().rglob("*.html"))[:: options.every]
        browser = playwright.chromium.launch(
            executable_path=program("chromium"), args=["--no-sandbox"]
        )
        looks = (
            [{"color_scheme": scheme} for scheme in SCHEMES]
            if options.axe
            else [{"viewport": {"width": width, "height": 900}} for width in WIDTHS]
        )
        wrong = 0
        for look in looks:
            page = browser.new_page(**look)
            for path in pages:
                page.goto(path.as_uri())
                found = (
                    broken_rules(page)
                    if options.axe
                    else faults(page, look["viewport"]["width"])
                )
                wrong += bool(found)
                for one in found:
                    print(f"{path.relative_to(site.resolve())} {look}: {one}")
            page.close()
    print(f"{len(pages)} pages, {len(looks)} looks, {wrong} with faults")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
