"""Names of generated packages: Python package, Rust crate, prefix of C names.

`of_project` reads them from ``icdgen.toml``: explicit names, or names derived from the
name of the project. It refuses names that a language reserves.
"""

from __future__ import annotations

import keyword
import re
import sys

from icdgen.config import PACKAGES, Config
from icdgen.errors import UserError
from icdgen.frozen import dataclass

_LOWER = re.compile(r"[a-z][a-z0-9_]*")
_PROJECT = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
# C compilers distinguish at least the first 63 of a name (C11 5.2.4.1)
_LONGEST = 40
_FORM = "lower-case letters, digits and _, a letter first"
_OURS = ("icdgen", "icdgen_runtime")
# Crates that are part of the compiler
_CRATES = ("alloc", "core", "proc_macro", "std", "test")


@dataclass(frozen=True)
class Packages:
    """Names of the packages; the defaults apply to ICDs without a project name."""

    python: str = "icdgen_messages"
    rust: str = "icd"
    c: str = ""  # prefix of each node's name, joined by `_`

    @property
    def c_prefix(self) -> str:
        """Prefix of a node's name in C."""
        return f"{self.c}_" if self.c else ""


def of_project(config: Config) -> Packages:
    """Return the names in ``icdgen.toml``: explicit ones, or for Python and Rust the
    project name.

    Raises `UserError`.
    """
    names = dict(config.packages)
    for section, name in names.items():
        if problem := _problem(section, name):
            raise _refused(config, section, PACKAGES[section], name, problem)
    if config.name:
        if not _PROJECT.fullmatch(config.name):
            problem = "takes letters, digits, - and _, a letter first"
            raise _refused(config, "", "name", config.name, problem)
        # Distribution names contain hyphens, module names cannot.
        derived = config.name.replace("-", "_").lower()
        for section in ("python", "rust"):
            if section not in names and (problem := _problem(section, derived)):
                key = PACKAGES[section]
                problem += f"; give `{key}` in [{section}], which is derived from the project's name"
                raise _refused(config, "", "name", config.name, problem)
            names.setdefault(section, derived)
    return Packages(**names)


def _refused(
    config: Config, section: str, key: str, name: str, problem: str
) -> UserError:
    place = config.place_of_key(section, key)
    shown = name[:60]
    help = f'for instance {key} = "battery_icd"'
    return UserError(
        f"{place.file}:{place.line}:{place.column}: `{key}` cannot be `{shown}`: it {problem}",
        help,
    )


def _problem(section: str, name: str) -> str:
    """Return the reason why a name is invalid in a language; empty if it is valid."""
    if not _LOWER.fullmatch(name):
        return f"takes {_FORM}"
    if len(name) > _LONGEST:
        return f"has more than {_LONGEST} characters"
    if name in _OURS:
        return "is a name of icdgen itself"
    if section == "python":
        if keyword.iskeyword(name):
            return "is a reserved word of Python"
        if name in sys.stdlib_module_names:
            return "is a module of Python's standard library, which it would hide"
    if section == "rust":
        from icdgen.backends.rust.names import RESERVED

        if name in RESERVED:
            return "is a reserved word of Rust"
        if name in _CRATES:
            return "is a crate that comes with the compiler"
    if section == "c" and (name == "icd" or name.endswith("_")):
        return (
            "is the beginning of the names of the support layer"
            if name == "icd"
            else "ends with _, which is added"
        )
    return ""
