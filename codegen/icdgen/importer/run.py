"""The import as a whole: manual in, files and findings out. Nothing is written before everything is ready."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.errors import UserError
from icdgen.importer import assemble, damage, emit, profile, reading, update
from icdgen.importer.document import CERTAIN, DOUBTFUL, LIKELY, Document, Trouble
from icdgen.importer.understand import survey
from icdgen.importer.understand.survey import Survey

NOTHING = "IMP004"


@dataclass
class Target:
    """A file to be written. ``changes`` is None where there was none before."""

    path: Path
    text: str
    tree: dict
    changes: list[str] | None = None
    same: bool = False


@dataclass
class Result:
    """Everything that an import found."""

    document: Document
    survey: Survey
    targets: list[Target] = field(default_factory=list)

    @property
    def troubles(self) -> list[Trouble]:
        """All findings in the order of the manual, each once."""
        return sorted(
            set(self.survey.troubles), key=lambda t: (t.spot.page or 0, t.spot.line or 0, t.spot.table or 0, t.code)
        )

    @property
    def failed(self) -> bool:
        """Whether something that the manual has is missing from the ICD, or may be wrong in it."""
        return any(t.severity == "error" for t in self.survey.troubles)

    def sureness(self) -> Counter:
        """How many tables were read how surely."""
        return Counter(self.sure_of(one.table) for one in self.survey.found)

    def sure_of(self, table) -> str:
        """How sure the reading of a table is."""
        about = [t for t in self.survey.troubles if t.spot.table == table.number and t.spot.table is not None
                 and t.code != "IMP035"]  # fmt: skip
        what = next((one.what for one in self.survey.found if one.table is table), "")
        if what == survey.UNKNOWN or table.doubts or any(t.severity == "error" or t.sure == DOUBTFUL for t in about):
            return DOUBTFUL
        return LIKELY if any(t.severity == "warning" or t.code in ("IMP020", "IMP021") for t in about) else CERTAIN


def run(
    manual: Path, words: profile.Profile, progress=None, jobs: int | None = None, prose: bool = False
) -> tuple[Result, dict[str, dict]]:
    """Reads a manual. Raises `Findings` for one from which nothing can be read."""
    document = reading.read(manual, words, progress, jobs)
    damage.mend(document, words)
    found = survey.survey(document, words)
    trees = assemble.assemble(document, found, words, prose)
    if not trees:
        count = len(document.tables)
        help = (
            f"none of its {count} tables has headings that the profile knows: add them with --profile, see docs/import.md"
            if count
            else "icdgen finds tables by their rules, their headings and their captions; is this the right document?"
        )
        raise reading._refused(document.file, "no message and no enumeration was found", help, NOTHING)
    return Result(document, found), trees


def aim(result: Result, trees: dict[str, dict], out: Path, over: bool) -> None:
    """Prepares the files. Raises `UserError` where one exists and ``over`` does not allow to update it."""
    taken = [out / f"{name}.yaml" for name in trees if os.path.lexists(out / f"{name}.yaml")]
    if taken and not over:
        raise UserError(
            f"{', '.join(str(p) for p in taken)} already there",
            "--update lays the manual over them and keeps errata, identifiers and summaries; or choose another --out",
        )
    for name, tree in trees.items():
        path = out / f"{name}.yaml"
        if path not in taken:
            result.targets.append(Target(path, emit.text(tree), tree))
            continue
        try:
            old = path.read_text(encoding="utf-8")
        except OSError as error:
            raise UserError(f"cannot read {path}: {error.strerror}", "check the path") from None
        except UnicodeDecodeError:
            raise UserError(f"{path} is not UTF-8", "save it as UTF-8, or move it away") from None
        made = update.update(old, str(path), tree)
        result.targets.append(Target(path, made.text, tree, made.changes, made.text == old))


def write(result: Result) -> None:
    """Writes the files, each as a whole. Raises `UserError` if one can't be written."""
    from icdgen.generation.write import replace

    for target in result.targets:
        if target.same:
            continue
        try:
            replace(Path(os.path.realpath(target.path)), target.text.encode("utf-8"))
        except OSError as error:
            raise UserError(
                f"cannot write {target.path}: {error.strerror}", "choose another folder with --out"
            ) from None
