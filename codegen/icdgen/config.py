"""``icdgen.toml``: what a project generates, so that its build step is just ``icdgen``. See docs/reference/configuration.md.

name = "thruster"                # of the project, and of its Python package and Rust crate
icds = ["icd/thruster.yaml"]     # files or folders, relative to this file
lang = ["c", "python"]
out = "generated"

[rust]
crate = "thruster_icd"
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
_KEYS = {"name": str, "icds": list, "lang": list, "out": str, "templates": str}
PACKAGES = {"python": "package", "rust": "crate", "c": "prefix"}  # section -> its key, the name in generated code


@dataclass(eq=False, repr=False)
class Config:
    """What the file at ``path`` says, which has the ``text``; ``looked_at`` names every place where it was or might have been."""

    path: Path | None = None
    text: str = ""
    icds: list[Path] = field(default_factory=list)
    lang: list[str] = field(default_factory=list)
    out: Path | None = None
    templates: Path | None = None
    name: str = ""  # of the project
    packages: dict[str, str] = field(default_factory=dict)  # by section of `PACKAGES`, as far as they are given
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

    def place_of_key(self, section: str, key: str) -> Place:
        """Where a key of a section stands; the empty section is the beginning of the file."""
        return _place(self.path or Path(NAME), self.text, section, key)


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
        where = re.search(r" \(at line (\d+), column (\d+)\)$", str(error))
        place = f"{path}:{where[1]}:{where[2]}" if where else str(path)
        raise UserError(
            f"{place}: not TOML: {str(error)[: where.start() if where else None]}", "see https://toml.io"
        ) from None
    packages = {}
    for key, value in data.items():
        if key in PACKAGES:
            packages[key] = _package(path, text, key, value)
        elif key not in _KEYS:
            known = f"known keys: {', '.join(_KEYS)}, and the sections {', '.join(f'[{one}]' for one in PACKAGES)}"
            raise _wrong(path, text, "", key, f"unknown key `{key}`", known)
        else:
            _check_value(path, text, "", key, value, _KEYS[key])
    base = path.parent
    return Config(
        path,
        text,
        icds=[base / item for item in data.get("icds", [])],
        lang=data.get("lang", []),
        out=base / data["out"] if "out" in data else None,
        templates=base / data["templates"] if "templates" in data else None,
        name=data.get("name", ""),
        packages={section: name for section, name in packages.items() if name},
    )


def _package(path: Path, text: str, section: str, value: object) -> str:
    """The name that a section gives; empty if it gives none. Raises `UserError`."""
    key = PACKAGES[section]
    if not isinstance(value, dict):
        raise _wrong(
            path, text, "", section, f"`{section}` must be a section", f'[{section}], and below it {key} = "..."'
        )
    for one, name in value.items():
        if one != key:
            raise _wrong(path, text, section, one, f"unknown key `{one}` in [{section}]", f"known key: {key}")
        _check_value(path, text, section, key, name, str)
    return str(value.get(key, ""))


def _check_value(path: Path, text: str, section: str, key: str, value: object, kind: type) -> None:
    given = value if isinstance(value, list) else [value]
    texts = [one for one in given if isinstance(one, str)]
    if not isinstance(value, kind) or len(texts) != len(given):
        what, example = ("a list of texts", '["..."]') if kind is list else ("a text", '"..."')
        raise _wrong(path, text, section, key, f"`{key}` must be {what}", f"for instance {key} = {example}")
    if any(not one or "\0" in one for one in texts):
        help = "write a path or a name, or take it out"
        raise _wrong(path, text, section, key, f"`{key}` holds an empty text, or a NUL character", help)


def _wrong(path: Path, text: str, section: str, key: str, message: str, help: str) -> UserError:
    place = _place(path, text, section, key)
    return UserError(f"{path}:{place.line}:{place.column}: {message}", help)


def _place(path: Path, text: str, section: str, key: str) -> Place:
    """The line and column of a key, also where it is written as `section.key`; of the first line if it is not found."""
    names = rf"""["']?{re.escape(key)}["']?"""
    dotted = rf"""["']?{re.escape(section)}["']?\s*\.\s*{names}""" if section else names
    inside = ""
    for number, line in enumerate(text.splitlines(), 1):
        head = re.match(r"""\s*\[\s*["']?([^"'\]]*?)["']?\s*\]""", line)
        if head:
            inside = head[1]
            if not section and inside == key:
                return Place(str(path), number, head.start(1) + 1, len(key))
        match = (
            re.match(rf"\s*({names if inside == section else dotted})\s*[=.]", line)
            if inside in ("", section)
            else None
        )
        if match:
            return Place(str(path), number, match.start(1) + 1, len(match[1]))
    return Place(str(path))
