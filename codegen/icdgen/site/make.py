"""From ICD files to the files of the site."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from icdgen.backends.html import HtmlBackend
from icdgen.checked import load_checked
from icdgen.diagnostics import Finding
from icdgen.generation.write import Plan, apply, plan
from icdgen.render import Renderer


@dataclass
class Site:
    """``files`` by path from the top of the site; none if the ICDs have errors."""

    ok: bool
    findings: list[Finding]
    texts: dict[str, str]
    files: dict[str, str] = field(default_factory=dict)
    inputs: dict[Path, str] = field(default_factory=dict)  # what decides the site -> its `memo.fingerprint` when read


def make(icds: list[Path], previous: Path | None = None, templates: Path | None = None) -> Site:
    """Loads, checks and renders. Raises `UserError` where a file can't be read or a template is bad."""
    loaded = load_checked(icds)
    older = load_checked([previous]) if loaded.ok and previous is not None else None
    sources = [loaded] if older is None else [loaded, older]
    made = Site(
        ok=all(source.ok for source in sources),
        findings=[finding for source in sources for finding in source.findings],
        texts={name: text for source in sources for name, text in source.texts.items()},
        inputs={path: seen for source in sources for path, seen in source.inputs.items()},
    )
    if made.ok:
        render = Renderer(HtmlBackend.name, templates)
        backend = HtmlBackend(older.icd if older else None)
        made.files = {str(path): text for path, text in backend.files(loaded.icd, render)}
        made.inputs |= render.looked_at
    return made


def write(site: Site, out: Path, check: bool = False) -> Plan:
    """Brings a folder to the state of the site; with ``check`` only compares. Raises `UserError`."""
    made = plan(out, HtmlBackend.name, ((PurePosixPath(name), text) for name, text in site.files.items()))
    if not check:
        apply(made)
    return made
