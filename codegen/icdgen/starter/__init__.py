"""First ICD of a project, for ``icdgen init``: a commented device that is ready to
check, generate and simulate.

`write` fills templates of ``templates/init`` with the name of the device. It writes the
ICD, its errata file, the schema and ``icdgen.toml``, never over an existing file, and
returns their paths. ``style`` takes links and byte order from another node.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from icdgen import config, shipped
from icdgen.backends import packages
from icdgen.errors import UserError
from icdgen.generation.write import replace
from icdgen.icd import schema
from icdgen.naming import latin

if TYPE_CHECKING:
    from icdgen.starter.style import Style

# Link of the device -> template of its first ICD.
TEMPLATES = {"uart": "device.yaml", "framed": "framed.yaml"}

_NAME = re.compile(r"[a-z][a-z0-9_]{0,63}")
_CONFIG = """\
name = "{name}"  # of the project, and of what is installed: the Python package, the Rust crate
icds = ["icd"]
out = "generated"

[python]
package = "{package}"  # the name in `import {package}.{name}`

[rust]
crate = "{package}"  # the name in `use {package}::{name}`

[c]
# prefix = "{package}"  # before the name of the node, where programs of several projects are linked together
"""


def write(
    folder: Path,
    name: str,
    style: Style | None = None,
    origin: str = "",
    link: str = "uart",
) -> list[Path]:
    """Write ``icd/NAME.yaml``, its errata file and, if they do not exist, the schema
    and ``icdgen.toml``.

    Returns the paths of the written files, relative to ``folder``. With a ``style``,
    the ICD has the style of the node ``origin``. ``link`` is a key of `TEMPLATES`.
    Raises `UserError`, before anything is written, if the name is invalid or a file of
    this name exists.
    """
    if not _NAME.fullmatch(name):
        proposal = re.sub(r"[^a-z0-9]+", "_", latin(name).lower()).strip("_")
        proposal = proposal.lstrip("0123456789_")[:64]
        help = f"for instance `icdgen init {proposal or 'battery'}`"
        raise UserError(
            f"`{name}` cannot name a node: lower-case letters, digits and _, a letter first",
            help,
        )
    device = _filled(TEMPLATES[link], name)
    if style is not None:
        from icdgen.starter.style import in_style

        device = in_style(device, style, origin)
    files = {
        folder / "icd" / f"{name}.yaml": device,
        folder / "icd" / "errata" / f"{name}.yaml": _filled("errata.yaml", name),
    }
    for path in files:
        if os.path.lexists(path):
            raise UserError(
                f"{path.relative_to(folder)} already exists",
                "take another name, or move the file away",
            )
    if not os.path.lexists(folder / config.NAME):
        files[folder / config.NAME] = _CONFIG.format(name=name, package=_package(name))
    if not os.path.lexists(folder / "icd" / schema.COPY):
        files[folder / "icd" / schema.COPY] = schema.PATH.read_text(encoding="utf-8")
    for path, text in files.items():
        replace(path, text.encode())
    return [path.relative_to(folder) for path in files]


def _package(name: str) -> str:
    """Return the name of the package: the name of the project, or with the suffix
    `_icd` if a language does not allow it.
    """
    try:
        packages.of_project(config.Config(name=name))
    except UserError:
        return f"{name[:36]}_icd"
    return name


def _filled(template: str, name: str) -> str:
    """Return a template of `icdgen init` for a device."""
    text = (shipped.templates() / "init" / template).read_text(encoding="utf-8")
    return text.replace("{{ name }}", name).replace(
        "{{ title }}", name.replace("_", " ").capitalize()
    )
