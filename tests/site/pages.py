"""The site under test, and one page of each kind."""

from __future__ import annotations

import shutil
from pathlib import Path

from icdgen.site import make_site, write_site
from tests.conftest import ROOT

KINDS = {
    "home": "index.html",
    "node": "cubeacp/index.html",
    "message": "cubeacp/current_adcs_state.html",
    "numbers": "cubeacp/estimated_attitude_angles.html",
    "without fields": "bootloader/clear_error_flags.html",
    "enumeration": "cubeacp/enum-con_mode_select.html",
    "composite": "cubeacp/adcs_state.html",
    "long": "cubeacp/adcs_system_configuration.html",
    "protocol": "cubeacp/protocol.html",
    "guide": "icdgen-docs/reference/wire.html",
    "units": "units.html",
    "errata": "errata.html",
    "changes": "changes.html",
    "print": "cubewheel/all-messages.html",
}


def shipped(out: Path, old: Path) -> None:
    """Write the site of the shipped ICDs, compared with an older release that is
    generated in ``old``.
    """
    shutil.copytree(ROOT / "icd", old / "icd")
    acp = old / "icd" / "cubeacp.yaml"
    acp.write_text(
        acp.read_text("utf-8")
        .replace("name: Estimated Roll Angle,", "name: Roll Angle,")
        .replace("name: Emulation", "name: Simulation"),
        "utf-8",
    )
    write_site(make_site([ROOT / "icd"], str(old / "icd")), out)
