"""One generation run: load, check, render, compare, write."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from icdgen import backends, cache
from icdgen.backends.packages import Packages
from icdgen.errors import UserError
from icdgen.generation import manifest, write
from icdgen.icd.loaded import Loaded
from icdgen.model_cache import load_checked
from icdgen.render import Renderer

Files = Iterable[tuple[PurePosixPath, str | bytes]]  # path below the folder of a language, and content


@dataclass(eq=False, repr=False)
class Job:
    """What is asked for. With several languages each goes into a folder of its own below ``out``."""

    languages: list[str]
    out: Path
    icds: list[Path]
    templates: Path | None = None
    depfile: Path | None = None
    check: bool = False
    measured: Path | None = None  # folder of measurements, for the papers that have them
    packages: Packages = field(default_factory=Packages)
    configs: dict[Path, str] = field(default_factory=dict)  # configuration files that were read or looked for
    watch: Callable[[Files], Files] = iter  # passes generated files on, and can count them


@dataclass(eq=False, repr=False)
class Outcome:
    """What came of it."""

    loaded: Loaded
    may_be_remembered: bool = True  # nothing but the files of `inputs` and icdgen itself decides
    plans: list[write.Plan] = field(default_factory=list)
    inputs: dict[Path, str] = field(default_factory=dict)  # what decides the output -> its fingerprint when read

    @property
    def changes(self) -> bool:
        return any(plan.changes for plan in self.plans)


def run(job: Job) -> Outcome:
    """Writes nothing if the ICDs have errors or ``job.check`` is set. Raises `UserError`."""
    chosen = [backends.get(name) for name in dict.fromkeys(job.languages)]
    if job.templates is not None and not os.path.isdir(job.templates):
        raise UserError(f"there is no folder {job.templates}", "--templates names a folder of templates")
    if job.measured is not None and not any(hasattr(backend, "measured") for backend in chosen):
        help = "add `--lang assurance`, or leave --measured out"
        raise UserError("measurements go into the assurance pack only", help)
    plug_ins = [backend for backend in chosen if backend.name not in backends.names()]
    lined = any(getattr(backend, "needs_lines", False) for backend in chosen)
    outcome = Outcome(
        load_checked(job.icds, backends.named_in(chosen), plug_ins, lined), may_be_remembered=not plug_ins and not lined
    )
    if not outcome.loaded.ok:
        return outcome
    outcome.inputs = outcome.loaded.inputs | job.configs
    for backend in chosen:
        render = Renderer.of(backend, job.templates)
        if hasattr(backend, "measured"):
            backend.measured = job.measured
        if hasattr(backend, "packages"):
            backend.packages = job.packages
        out = job.out / backend.name if len(chosen) > 1 else job.out
        outcome.plans.append(write.plan(out, backend.name, job.watch(backend.files(outcome.loaded.icd, render))))
        outcome.inputs |= render.looked_at
    if not job.check:
        for plan in outcome.plans:
            write.apply(plan)
        if job.depfile is not None:
            _write_depfile(job.depfile, outcome)
    return outcome


def _depfile(outcome: Outcome) -> tuple[bytes, set[str]]:
    """What a dependency file says, and the files that it names."""
    targets = [os.path.join(plan.out, name) for plan in outcome.plans for name in plan.files]
    needs = [str(path) for path in outcome.inputs if path.is_file()]
    text = " \\\n  ".join(map(_escape, targets)) + ": \\\n  " + " \\\n  ".join(map(_escape, needs)) + "\n"
    return text.encode("utf-8", "surrogateescape"), {os.path.realpath(path) for path in (*targets, *needs)}


def _write_depfile(path: Path, outcome: Outcome) -> None:
    data, named = _depfile(outcome)
    depfile = Path(os.path.realpath(path))
    if str(depfile) in named:
        raise UserError(f"{path} is an input or an output", "give the dependency file a name of its own")
    if write.read(depfile) != data:
        try:
            write.replace(depfile, data)
        except OSError as error:
            raise UserError(f"cannot write {path}: {error.strerror}", "choose another place for it") from None


def _escape(path: str) -> str:
    if "\n" in path:
        raise UserError(f"{path} cannot be named in a dependency file", "rename what has a line end in its name")
    return path.replace("\\", "\\\\").replace(" ", "\\ ").replace("#", "\\#").replace("$", "$$").replace(":", "\\:")


def remember(name: str, note: str, job: Job, outcome: Outcome) -> None:
    """So that the same command over the same files, with its outputs still in place, ends at once."""
    if not name or outcome.loaded.findings or not outcome.may_be_remembered:
        return
    files = {os.path.abspath(path): seen for path, seen in outcome.inputs.items()}
    for plan in outcome.plans:
        out = os.path.abspath(plan.out)
        for file, digest in plan.digests.items():
            files[os.path.join(out, file)] = digest
        files[os.path.abspath(manifest.path(plan.out, plan.language))] = manifest.digest(plan.manifest.encode())
    if job.depfile is not None and not job.check:
        files[os.path.abspath(job.depfile)] = manifest.digest(_depfile(outcome)[0])
    cache.remember("runs", name, note.encode("utf-8", "surrogateescape"), files)
