"""Small ICDs with features that the shipped ones lack: other bit orders, unusual
widths, scaled 64-bit fields, difficult names.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.conftest import ROOT

FOLDER = Path(__file__).parent / "odd_icds"
_VARIABLE = ("common", "apart", "open", "mux")


def write(folder: Path) -> Path:
    """Write the ICDs into the folder and return it."""
    shutil.copytree(FOLDER, folder, dirs_exist_ok=True)
    return folder


def variable(folder: Path) -> list[Path]:
    """Return files with variable-length messages, shared ids and conditions: unusual
    ones, and real devices.
    """
    write(folder)
    devices = ROOT / "examples" / "devices"
    return [
        *(folder / f"{name}.yaml" for name in _VARIABLE),
        *(devices / name / f"{name}.yaml" for name in ("mavlink", "ublox")),
    ]
