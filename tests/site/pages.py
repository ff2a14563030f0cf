"""A page of each kind of the shipped site."""

from __future__ import annotations

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
    "guide": "icdgen-docs/wire.html",
    "units": "units.html",
    "errata": "errata.html",
    "changes": "changes.html",
    "print": "cubewheel/all-messages.html",
}
