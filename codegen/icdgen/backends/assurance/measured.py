"""Measurements that go into a pack: made by commands that run compilers and testers, read here from files.

A measurement is a JSON file. Its ``icd`` is the digest of the set of ICDs that it was made of, ``code`` that of the generated
code that was measured, language by language: a pack takes it only if both are those of what it is itself made of.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from hashlib import sha256
from itertools import chain
from pathlib import Path, PurePosixPath
from typing import Any

from icdgen.errors import UserError
from icdgen.icd.model import Icd

FORMAT = 1
_KEYS = {"icdgen_measurement": int, "name": str, "title": str, "says": list, "icd": str, "code": dict, "made_by": list,
         "facts": list, "columns": list, "rows": list}  # fmt: skip
_AGAIN = "measure again, or leave it out: docs/guides/verification-package.md says how"


@dataclass(frozen=True, slots=True)
class Measurement:
    """What one file says. ``name`` is that of its papers, ``made_by`` the command and the tools."""

    name: str
    title: str
    says: tuple[str, ...]
    code: dict[str, str]  # language -> digest of what was measured
    made_by: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    columns: tuple[str, ...]
    rows: list[list[str]]


def icd_digest(icd: Icd) -> str:
    """The digest of a set of ICDs: over those of its nodes, errata included."""
    return sha256("".join(f"{node.name} {node.digest}\n" for node in icd.nodes).encode()).hexdigest()


def code_digest(files: Iterable[tuple[PurePosixPath, str | bytes]]) -> str:
    """The digest of generated files, by their names and contents."""
    contents = ((path, made.encode() if isinstance(made, str) else made) for path, made in files)
    lines = sorted(f"{path} {sha256(data).hexdigest()}\n" for path, data in contents)
    return sha256("".join(lines).encode()).hexdigest()


def read(folder: Path, icd: Icd, code_of: Callable[[str], str]) -> list[Measurement]:
    """The measurements of a folder by name. ``code_of``: the digest of what is generated now for a language.

    Raises `UserError` for one that can't be read, or that is of other ICDs or of other code.
    """
    try:
        paths = sorted(path for path in folder.iterdir() if path.suffix == ".json" and not path.name.startswith("."))
    except OSError as error:
        text = f"{folder}: cannot be read: {error.strerror}"
        raise UserError(text, "--measured names a folder of measurements") from None
    measurements = []
    for path in paths:
        data = _data(path)
        ours = ("ICDs: the digest", data["icd"], icd_digest(icd))
        code = ((f"code: the digest of `{name}`", there, code_of(name)) for name, there in data["code"].items())
        for what, there, here in chain([ours], code):
            if there != here:
                text = f"{path}: it measures other {what} is {there[:16]} there and {here[:16]} here"
                raise UserError(text, _AGAIN)
        rows = [[str(cell) for cell in row] for row in data["rows"]]
        facts = tuple((str(key), str(value)) for key, value in data["facts"])
        says, made_by, columns = (tuple(map(str, data[key])) for key in ("says", "made_by", "columns"))
        measurements.append(Measurement(data["name"], data["title"], says, data["code"], made_by, facts, columns, rows))
    return sorted(measurements, key=lambda measurement: measurement.name)


def _data(path: Path) -> dict[str, Any]:
    """What a file holds. Raises `UserError` unless it is a measurement."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise UserError(f"{path}: cannot be read: {error}", _AGAIN) from None
    if not isinstance(data, dict) or data.get("icdgen_measurement") != FORMAT:
        text = f"{path}: not a measurement (no `icdgen_measurement: {FORMAT}`)"
        raise UserError(text, "keep only measurements in that folder")
    for key, kind in _KEYS.items():
        if type(data.get(key)) is not kind:
            raise UserError(f"{path}: `{key}` is missing or not of its kind", _AGAIN)
    if any(type(fact) is not list or len(fact) != 2 for fact in data["facts"]):
        raise UserError(f"{path}: `facts` is missing or not of its kind", _AGAIN)
    width = len(data["columns"])
    if any(type(row) is not list or len(row) != width for row in data["rows"]):
        raise UserError(f"{path}: a row has not as many cells as there are columns", _AGAIN)
    if not data["name"].replace("-", "").isalnum() or not data["name"].isascii():
        raise UserError(f"{path}: `name` is no name for a file", "letters, digits and `-`")
    return data
