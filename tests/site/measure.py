"""List what is cut off or too long on any page at each width: ``python -m
tests.site.measure [SITE]``.
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

# Elements that reach beyond the screen and are not inside a scrolling element.
_CUT = """() => [...document.querySelectorAll("body *")].filter((one) => {
    const box = one.getBoundingClientRect();
    const hidden = one.closest(".scroll, pre, .hidden, .skip, legend, details:not([open]) > :not(summary), svg, .local, .tabs");
    return !hidden && box.width > 0 && box.right > innerWidth + 1;
}).map((one) => one.outerHTML.slice(0, 80))"""


def faults(page, width: int) -> list[str]:
    """Return the layout problems of the open page at its width."""
    wide, high = page.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    )
    problems = [f"cut: {text}" for text in page.evaluate(_CUT)]
    problems += [f"{wide} pixels wide"] if wide > width else []
    return problems + ([f"{high} pixels high"] if high > HIGHEST else [])


def broken_rules(page) -> list[str]:
    """Return the violations that axe reports on the open page."""
    page.evaluate(tool("axe-core/axe.min.js").read_text("utf-8"))
    axe_results = page.evaluate(
        "axe.run({ resultTypes: ['violations'], preload: false })"
    )
    return [
        f"{violation['id']}: {[node['target'] for node in violation['nodes']][:5]}"
        for violation in axe_results["violations"]
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
                problems = (
                    broken_rules(page)
                    if options.axe
                    else faults(page, look["viewport"]["width"])
                )
                wrong += bool(problems)
                for problem in problems:
                    print(f"{path.relative_to(site.resolve())} {look}: {problem}")
            page.close()
    print(f"{len(pages)} pages, {len(looks)} looks, {wrong} with faults")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
