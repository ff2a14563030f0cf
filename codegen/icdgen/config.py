"""``icdgen.toml``: what a project generates, so that its build step is just ``icdgen``.

icds = ["icd/thruster.yaml"]     # files or folders, relative to this file
lang = ["c", "python"]
out = "generated"
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path

from icdgen import fingerprints
from icdgen.diagnostics import Place
from icdgen.errors import UserError

NAME = "icdgen.toml"
_KEYS = {"icds": list, "lang": list, "out": str, "templates": str}


@dataclass(eq=False, repr=False)
class Config:
    """What the file at ``path`` says, which has the ``text``; ``looked_at`` names every place where it was or might have been."""

    path: Path | None = None
    text: str = ""
    icds: list[Path] = field(default_factory=list)
    lang: list[str] = field(default_factory=list)
    out: Path | None = None
    templates: Path | None = None
    looked_at: dict[Path, str] = field(default_factory=dict)  # fingerprints as of just before it was read

    def place_of(self, icd: Path) -> Place:
        """Where the file names one of ``icds``."""
        path = self.path or Path(NAME)
        base = path.parent
        named = icd.relative_to(base) if icd.is_relative_to(base) else icd
        entry = re.compile(rf"""(?<=["'])(?:\./)*{re.escape(named.as_posix())}/*(?=["'])""")
        for number, line in enumerate(self.text.splitlines(), 1):
            if found := entry.search(line):
                return Place(str(path), number, found.start() + 1, len(found.group()) or 1)
        return Place(str(path))


def find(start: Path) -> Config:
    """The configuration of the nearest folder upwards that has one. Raises `UserError` if it can't be read."""
    looked_at = {}
    for folder in (start, *start.parents):
        path = folder / NAME
        looked_at[path] = fingerprints.of_path(str(path))
        if os.path.isfile(path):
            config = _read(path)
            config.looked_at = looked_at
            return config
        if os.path.exists(folder / ".git"):
            break
    return Config(looked_at=looked_at)


def _read(path: Path) -> Config:
    import tomllib

    try:
        text = path.read_text(encoding="utf-8")
        data = tomllib.loads(text)
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror}", "make it readable") from None
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: cannot be read ({error})", "save it as UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{path}: not TOML: {error}", "see https://toml.io") from None
    for key, value in data.items():
        if key not in _KEYS:
            raise UserError(f"{path}: unknown key `{key}`", f"known keys: {', '.join(_KEYS)}")
        texts = value if isinstance(value, list) else [value]
        if not isinstance(value, _KEYS[key]) or not all(isinstance(one, str) for one in texts):
            kind, example = ("a list of texts", '["..."]') if _KEYS[key] is list else ("a text", '"..."')
            raise UserError(f"{path}: `{key}` must be {kind}", f"for instance {key} = {example}")
        if any(not one or "\0" in one for one in texts):
            help = "write a path or a name, or take it out"
            raise UserError(f"{path}: `{key}` holds an empty text, or a NUL character", help)
    base = path.parent
    return Config(
        path,
        text,
        icds=[base / item for item in data.get("icds", [])],
        lang=data.get("lang", []),
        out=base / data["out"] if "out" in data else None,
        templates=base / data["templates"] if "templates" in data else None,
    )
