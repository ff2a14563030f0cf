"""A run of the generator: load, check, render, compare and write.

`run` takes a `Job` from the command and returns a `GenerationOutcome`; `remember`
stores it, so that an equal run ends at once.
"""

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

# Path below the folder of a language, and content.
Files = Iterable[tuple[PurePosixPath, str | bytes]]


@dataclass(eq=False, repr=False)
class Job:
    """Options of a run.

    With several languages, each has its own subfolder of ``out``.
    """

    languages: list[str]
    out: Path
    icds: list[Path]
    templates: Path | None = None
    depfile: Path | None = None
    check: bool = False
    measured: Path | None = None  # folder of measurements for the verification package
    packages: Packages = field(default_factory=Packages)
    # Fingerprints of configuration files that exist or were absent.
    configs: dict[Path, str] = field(default_factory=dict)
    # Passes generated files on, for example to show the progress.
    watch: Callable[[Files], Files] = iter


@dataclass(eq=False, repr=False)
class GenerationOutcome:
    """Result of a run."""

    loaded: Loaded
    # The output depends only on `inputs` and on icdgen itself.
    may_be_remembered: bool = True
    plans: list[write.WritePlan] = field(default_factory=list)
    # Fingerprint of each file that the output depends on.
    inputs: dict[Path, str] = field(default_factory=dict)

    @property
    def changes(self) -> bool:
        """Whether a file is written or removed."""
        return any(plan.changes for plan in self.plans)


def run(job: Job) -> GenerationOutcome:
    """Generate.

    Writes nothing if the ICDs have errors or if ``job.check`` is set. Raises
    `UserError`.
    """
    chosen = [backends.get(name) for name in dict.fromkeys(job.languages)]
    if job.templates is not None and not os.path.isdir(job.templates):
        raise UserError(
            f"there is no folder {job.templates}",
            "--templates names a folder of templates",
        )
    if job.measured is not None and not any(
        hasattr(backend, "measured") for backend in chosen
    ):
        help = "add `--lang assurance`, or leave --measured out"
        raise UserError("measurements go into the assurance pack only", help)
    # A plug-in can read other files, and a backend can need the places of lines, which
    # a cached model lacks.
    plug_ins = [backend for backend in chosen if backend.name not in backends.names()]
    lined = any(getattr(backend, "needs_lines", False) for backend in chosen)
    outcome = GenerationOutcome(
        load_checked(job.icds, backends.named_in(chosen), plug_ins, lined),
        may_be_remembered=not plug_ins and not lined,
    )
    if not outcome.loaded.ok:
        return outcome
    outcome.inputs = outcome.loaded.inputs | job.configs
    for backend in chosen:
        render = Renderer.of_backend(backend, job.templates)
        if hasattr(backend, "measured"):
            backend.measured = job.measured
        if hasattr(backend, "packages"):
            backend.packages = job.packages
        out = job.out / backend.name if len(chosen) > 1 else job.out
        outcome.plans.append(
            write.plan(
                out, backend.name, job.watch(backend.files(outcome.loaded.icd, render))
            )
        )
        outcome.inputs |= render.looked_at
    if not job.check:
        for plan in outcome.plans:
            write.apply(plan)
        if job.depfile is not None:
            _write_depfile(job.depfile, outcome)
    return outcome


def _depfile(outcome: GenerationOutcome) -> tuple[bytes, set[str]]:
    """Return the content of a dependency file in the syntax of Make, and the files that
    it names.
    """
    targets = [
        os.path.join(plan.out, name) for plan in outcome.plans for name in plan.files
    ]
    needs = [str(path) for path in outcome.inputs if path.is_file()]
    separator = " \\\n  "  # one path per line
    left, right = (separator.join(map(_escape, side)) for side in (targets, needs))
    text = f"{left}:{separator}{right}\n"
    named = {os.path.realpath(path) for path in (*targets, *needs)}
    return text.encode("utf-8", "surrogateescape"), named


def _write_depfile(path: Path, outcome: GenerationOutcome) -> None:
    """Write the dependency file.

    Raises `UserError` if it is also an input or an output.
    """
    data, named = _depfile(outcome)
    depfile = Path(os.path.realpath(path))
    if str(depfile) in named:
        raise UserError(
            f"{path} is an input or an output",
            "give the dependency file a name of its own",
        )
    # Build tools compare times, so an equal file is not written again.
    if write.read_if_exists(depfile) != data:
        try:
            write.replace(depfile, data)
        except OSError as error:
            raise UserError(
                f"cannot write {path}: {error.strerror}", "choose another place for it"
            ) from None


def _escape(path: str) -> str:
    """Return a path in the syntax of Make.

    Raises `UserError` for a path with a line break.
    """
    if "\n" in path:
        raise UserError(
            f"{path} cannot be named in a dependency file",
            "rename what has a line end in its name",
        )
    return (
        # First the backslash, because the other replacements add backslashes.
        path.replace("\\", "\\\\")
        .replace(" ", "\\ ")
        .replace("#", "\\#")
        .replace("$", "$$")
        .replace(":", "\\:")
    )


def remember(name: str, note: str, job: Job, outcome: GenerationOutcome) -> None:
    """Store a record of the run, with which the same command ends at once if its inputs
    and outputs are unchanged.

    ``note`` is the text that the command then prints.
    """
    if not name or outcome.loaded.findings or not outcome.may_be_remembered:
        return
    files = {
        os.path.abspath(path): fingerprint
        for path, fingerprint in outcome.inputs.items()
    }
    # The record is valid only while all outputs, manifests and the dependency file are
    # unchanged, too.
    for plan in outcome.plans:
        out = os.path.abspath(plan.out)
        for file, digest in plan.digests.items():
            files[os.path.join(out, file)] = digest
        files[os.path.abspath(manifest.path(plan.out, plan.language))] = (
            manifest.digest(plan.manifest.encode())
        )
    if job.depfile is not None and not job.check:
        files[os.path.abspath(job.depfile)] = manifest.digest(_depfile(outcome)[0])
    cache.remember("runs", name, note.encode("utf-8", "surrogateescape"), files)
