"""One generation run: load, check, render, compare, write."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

from icdgen import backends, memo
from icdgen.checked import load_checked
from icdgen.errors import UserError
from icdgen.generation import manifest, write
from icdgen.icd.loaded import Loaded
from icdgen.render import Renderer


@dataclass
class Job:
    """What is asked for. With several languages each goes into a folder of its own below ``out``."""

    languages: list[str]
    out: Path
    icds: list[Path]
    templates: Path | None = None
    depfile: Path | None = None
    check: bool = False
    configs: list[Path] = field(default_factory=list)  # configuration files that were read or looked for


@dataclass
class Outcome:
    loaded: Loaded
    plans: list[write.Plan] = field(default_factory=list)

    @property
    def changes(self) -> bool:
        return any(plan.changes for plan in self.plans)


def run(job: Job) -> Outcome:
    """Writes nothing if the ICDs have errors or ``job.check`` is set. Raises `UserError`, `backends.UnknownBackend`."""
    chosen = [backends.get(name) for name in dict.fromkeys(job.languages)]
    if job.templates is not None and not job.templates.is_dir():
        raise UserError(f"there is no folder {job.templates}", "--templates names a folder of templates")
    outcome = Outcome(load_checked(job.icds))
    if not outcome.loaded.ok:
        return outcome
    top = memo.folder()
    for backend in chosen:
        cache = Path(top) / "templates" if top else None
        render = Renderer(backend.name, job.templates, cache)
        out = job.out / backend.name if len(chosen) > 1 else job.out
        outcome.plans.append(write.plan(out, backend.name, backend.files(outcome.loaded.icd, render)))
    if not job.check:
        for plan in outcome.plans:
            write.apply(plan)
        if job.depfile is not None:
            _write_depfile(job, outcome)
    return outcome


def _write_depfile(job: Job, outcome: Outcome) -> None:
    targets = [os.path.join(plan.out, name) for plan in outcome.plans for name in plan.files]
    needs = [str(path) for path in _inputs(job, outcome) if path.is_file()]
    text = " \\\n  ".join(map(_escape, targets)) + ": \\\n  " + " \\\n  ".join(map(_escape, needs)) + "\n"
    if not job.depfile.exists() or job.depfile.read_text(encoding="utf-8") != text:
        try:
            write.replace(job.depfile, text.encode("utf-8"))
        except OSError as error:
            raise UserError(f"cannot write {job.depfile}: {error.strerror}") from None


def _inputs(job: Job, outcome: Outcome) -> list[Path]:
    found = list(outcome.loaded.inputs)
    found += job.configs
    if job.templates is not None:
        found += sorted(path for path in job.templates.rglob("*"))
        found.append(job.templates)
    found += [path for path in job.icds if path.is_dir()]
    return found


def _escape(path: str) -> str:
    return path.replace("\\", "\\\\").replace(" ", "\\ ").replace("#", "\\#").replace("$", "$$").replace(":", "\\:")


def remember(name: str, note: str, job: Job, outcome: Outcome) -> None:
    """So that the same command over the same files, with its outputs still in place, ends at once."""
    if not name or outcome.loaded.findings or set(job.languages) - set(backends.names()):
        return
    files = {os.path.abspath(path): memo.fingerprint(str(path)) for path in _inputs(job, outcome)}
    for plan in outcome.plans:
        for file, data in plan.files.items():
            files[os.path.abspath(plan.out / file)] = manifest.digest(data)
        path = manifest.path(plan.out, plan.language)
        files[os.path.abspath(path)] = memo.fingerprint(str(path))
    if job.depfile is not None:
        files[os.path.abspath(job.depfile)] = memo.fingerprint(str(job.depfile))
    memo.remember("runs", name, note, files)
