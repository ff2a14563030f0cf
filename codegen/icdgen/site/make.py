"""From ICD files to the files of the site."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends.html import HtmlBackend
from icdgen.backends.packages import Packages
from icdgen.diagnostics import Finding
from icdgen.generation.generate import Files
from icdgen.generation.write import Plan, apply, plan
from icdgen.model_cache import load_checked
from icdgen.render import Renderer

if TYPE_CHECKING:
    from icdgen.diff.inputs.side import Side


@dataclass
class Site:
    """``files`` by path from the top of the site; none if the ICDs have errors."""

    ok: bool
    findings: list[Finding]
    texts: dict[str, str]
    files: dict[str, str] = field(default_factory=dict)
    inputs: dict[Path, str] = field(default_factory=dict)  # what decides the site -> its fingerprint when read


def make(
    icds: list[Path],
    previous: str | None = None,
    templates: Path | None = None,
    packages: Packages | None = None,
    watch: Callable[[Files], Files] = iter,
) -> Site:
    """Loads, checks and renders. ``previous`` is an older release, as `icdgen.diff.inputs` takes it.

    ``watch`` passes the files on, and can count them.

    Raises `UserError` where a file can't be read or a template is bad.
    """
    loaded = load_checked(icds, HtmlBackend.named_in)
    made = Site(loaded.ok, list(loaded.findings), dict(loaded.texts), inputs=dict(loaded.inputs))
    older = _older(made, previous, icds) if made.ok and previous is not None else None
    if made.ok:
        render = Renderer(HtmlBackend.name, templates)
        backend = HtmlBackend(older)
        backend.packages = packages or Packages()
        made.files = {
            str(path): page for path, page in watch(backend.files(loaded.icd, render)) if isinstance(page, str)
        }
        made.inputs |= render.looked_at
    return made


def _older(site: Site, previous: str, icds: list[Path]) -> Side:
    from icdgen.diff import inputs

    side = inputs.one_side(previous, icds)
    if not side.is_whole():
        site.ok = False
        site.findings += side.findings
        site.texts.update(side.texts)
    return side


def write(site: Site, out: Path, check: bool = False) -> Plan:
    """Brings a folder to the state of the site; with ``check`` only compares. Raises `UserError`."""
    made = plan(out, HtmlBackend.name, ((PurePosixPath(name), text) for name, text in site.files.items()))
    if not check:
        apply(made)
    return made
