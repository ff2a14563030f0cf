"""Configuration file ``icdgen.toml`` of a project: finds, reads and checks it.

``docs/reference/configuration.md`` describes the keys. An example::

    name = "thruster"             # of the project, and of what it generates
    icds = ["icd/thruster.yaml"]  # files or folders, relative to this file
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
# Key of each section, which has the name of the package in generated code.
PACKAGES = {"python": "package", "rust": "crate", "c": "prefix"}


@dataclass(eq=False, repr=False)
class Config:
    """Content of a configuration file."""

    path: Path | None = None  # None if there is no file
    text: str = ""
    icds: list[Path] = field(default_factory=list)
    lang: list[str] = field(default_factory=list)
    out: Path | None = None
    templates: Path | None = None
    name: str = ""  # of the project
    # By section of `PACKAGES`, if given.
    packages: dict[str, str] = field(default_factory=dict)
    # Fingerprints of the file, and of all paths tried before it.
    looked_at: dict[Path, str] = field(default_factory=dict)

    def place_of(self, icd: Path) -> Place:
        """Return the place of one of ``icds`` in the file."""
        path = self.path or Path(NAME)
        base = path.parent
        named = icd.relative_to(base) if icd.is_relative_to(base) else icd
        entry = re.compile(
            rf"""(?<=["'])(?:\./)*{re.escape(named.as_posix())}/*(?=["'])"""
        )
        for number, line in enumerate(self.text.splitlines(), 1):
            if match := entry.search(line):
                return Place(
                    str(path), number, match.start() + 1, len(match.group()) or 1
                )
        return Place(str(path))

    def place_of_key(self, section: str, key: str) -> Place:
        """Return the place of a key of a section; the empty section is the top level."""
        return _place(self.path or Path(NAME), self.text, section, key)


def find(start: Path) -> Config:
    """Return the configuration of a folder, or of the nearest parent folder that has
    one, up to the root of the repository.

    Raises `UserError` if the file cannot be read.
    """
    looked_at = {}
    for folder in (start, *start.parents):
        path = folder / NAME
        looked_at[path] = fingerprints.of_path(str(path))
        if os.path.isfile(path):
            config = _read(path)
            config.looked_at = looked_at
            return config
        # The configuration of another repository around this one does not apply.
        if os.path.exists(folder / ".git"):
            break
    return Config(looked_at=looked_at)


def _read(path: Path) -> Config:
    """Read and check a configuration file. Raises `UserError`."""
    import tomllib

    try:
        text = path.read_text(encoding="utf-8")
        data = tomllib.loads(text)
    except OSError as error:
        raise UserError(
            f"{path}: cannot be read: {error.strerror}", "make it readable"
        ) from None
    except UnicodeDecodeError as error:
        raise UserError(
            f"{path}: cannot be read ({error})", "save it as UTF-8"
        ) from None
    except tomllib.TOMLDecodeError as error:
        where = re.search(r" \(at line (\d+), column (\d+)\)$", str(error))
        place = f"{path}:{where[1]}:{where[2]}" if where else str(path)
        raise UserError(
            f"{place}: not TOML: {str(error)[: where.start() if where else None]}",
            "see https://toml.io",
        ) from None
    packages = {}
    for key, value in data.items():
        if key in PACKAGES:
            packages[key] = _package(path, text, key, value)
        elif key not in _KEYS:
            sections = ", ".join(f"[{section}]" for section in PACKAGES)
            help = f"known keys: {', '.join(_KEYS)}, and the sections {sections}"
            raise _wrong(path, text, "", key, f"unknown key `{key}`", help)
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
    """Return the name of the package in a section; empty without a name.

    Raises `UserError`.
    """
    key = PACKAGES[section]
    if not isinstance(value, dict):
        raise _wrong(
            path,
            text,
            "",
            section,
            f"`{section}` must be a section",
            f'[{section}], and below it {key} = "..."',
        )
    for own_key, name in value.items():
        if own_key != key:
            raise _wrong(
                path,
                text,
                section,
                own_key,
                f"unknown key `{own_key}` in [{section}]",
                f"known key: {key}",
            )
        _check_value(path, text, section, key, name, str)
    return str(value.get(key, ""))


def _check_value(
    path: Path, text: str, section: str, key: str, value: object, kind: type
) -> None:
    """Raise `UserError` unless a value is a text, or a list of texts if ``kind`` is
    list.
    """
    values = value if isinstance(value, list) else [value]
    texts = [item for item in values if isinstance(item, str)]
    if not isinstance(value, kind) or len(texts) != len(values):
        expected, example = (
            ("a list of texts", '["..."]') if kind is list else ("a text", '"..."')
        )
        raise _wrong(
            path,
            text,
            section,
            key,
            f"`{key}` must be {expected}",
            f"for instance {key} = {example}",
        )
    if any(not item or "\0" in item for item in texts):
        help = "write a path or a name, or take it out"
        raise _wrong(
            path,
            text,
            section,
            key,
            f"`{key}` holds an empty text, or a NUL character",
            help,
        )


def _wrong(
    path: Path, text: str, section: str, key: str, message: str, help: str
) -> UserError:
    """Return the error about a key, with its place in the file."""
    place = _place(path, text, section, key)
    return UserError(f"{path}:{place.line}:{place.column}: {message}", help)


def _place(path: Path, text: str, section: str, key: str) -> Place:
    """Return the place of a key, also in the form `section.key`; the start of the file
    if the key is not found.

    `tomllib` does not report positions.
    """
    names = rf"""["']?{re.escape(key)}["']?"""
    dotted = rf"""["']?{re.escape(section)}["']?\s*\.\s*{names}""" if section else names
    inside = ""
    for number, line in enumerate(text.splitlines(), 1):
        head = re.match(r"""\s*\[\s*["']?([^"'\]]*?)["']?\s*\]""", line)
        if head:
            inside = head[1]
            if not section and inside == key:
                return Place(str(path), number, head.start(1) + 1, len(key))
        if inside not in ("", section):
            continue
        pattern = names if inside == section else dotted
        match = re.match(rf"\s*({pattern})\s*[=.]", line)
        if match:
            return Place(str(path), number, match.start(1) + 1, len(match[1]))
    return Place(str(path))
