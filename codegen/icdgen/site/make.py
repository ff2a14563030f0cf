"""Rendering of the documentation site from ICD files.

`make_site` loads and checks the ICDs and renders all pages in memory; `write_site` writes
them to a folder, and `icdgen.site.serve` serves them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends.html import HtmlBackend
from icdgen.backends.packages import Packages
from icdgen.diagnostics import Finding
from icdgen.generation.generate import Files
from icdgen.generation.write import WritePlan, apply, plan
from icdgen.model_cache import load_checked
from icdgen.render import Renderer

if TYPE_CHECKING:
    from icdgen.diff.inputs.side import ComparisonSide


@dataclass
class Site:
    """A rendered site. If the ICDs have errors, it has no files."""

    ok: bool
    findings: list[Finding]
    texts: dict[str, str]
    # By path relative to the top of the site.
    files: dict[str, str] = field(default_factory=dict)
    # Fingerprint of each file that the site depends on.
    inputs: dict[Path, str] = field(default_factory=dict)


def make_site(
    icds: list[Path],
    previous: str | None = None,
    templates: Path | None = None,
    packages: Packages | None = None,
    watch: Callable[[Files], Files] = iter,
) -> Site:
    """Load and check ICDs, and render the site.

    ``previous`` is an older release to compare with, in the syntax of
    `icdgen.diff.inputs`. ``watch`` passes the files on, for example to show the
    progress. Raises `UserError` if a file cannot be read or a template has an error.
    """
    loaded = load_checked(icds, HtmlBackend.named_in)
    site = Site(
        loaded.ok, list(loaded.findings), dict(loaded.texts), inputs=dict(loaded.inputs)
    )
    older = _older(site, previous, icds) if site.ok and previous is not None else None
    if site.ok:
        render = Renderer(HtmlBackend.name, templates)
        backend = HtmlBackend(older)
        backend.packages = packages or Packages()
        site.files = {
            str(path): page
            for path, page in watch(backend.files(loaded.icd, render))
            if isinstance(page, str)
        }
        site.inputs |= render.looked_at
    return site


def _older(site: Site, previous: str, icds: list[Path]) -> ComparisonSide:
    """Load the older release; if it has errors, the site has its findings and is not
    rendered.
    """
    from icdgen.diff import inputs

    side = inputs.one_side(previous, icds)
    if not side.is_comparable():
        site.ok = False
        site.findings += side.findings
        site.texts.update(side.texts)
    return side


def write_site(site: Site, out: Path, check: bool = False) -> WritePlan:
    """Write the site to a folder, or only compare with ``check``.

    Returns the changes. Raises `UserError`.
    """
    changes = plan(
        out,
        HtmlBackend.name,
        ((PurePosixPath(name), text) for name, text in site.files.items()),
    )
    if not check:
        apply(changes)
    return changes
