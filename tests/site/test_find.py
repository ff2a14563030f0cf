"""The search lists the page that a query means first or second."""

from __future__ import annotations

import json

import pytest

from icdgen.backends.c import CBackend
from icdgen.backends.html.links import Links
from icdgen.backends.python import PythonBackend
from icdgen.backends.rust import RustBackend
from icdgen.site import make_site, write_site
from tests.conftest import ROOT
from tests.site.javascript import run_script

P31U = ROOT / "examples" / "devices" / "p31u" / "p31u.yaml"
SCRIPT = ROOT / "templates" / "html" / "find.js"
ANGLES = "cubeacp/estimated_attitude_angles.html"
ROLL = f"{ANGLES}#field-estimated_roll_angle"
MODES = "cubeacp/enum-con_mode_select.html"

QUERIES = {
    # names
    "Estimated Attitude Angles": ANGLES,
    "estimated attitude": ANGLES,
    "attitude angles": ANGLES,
    "adcs state": "cubeacp/adcs_state.html",
    "identification": "common/identification.html",
    "reset": "common/reset.html",
    "ConModeSelect": MODES,
    "CubeWheel": "cubewheel/index.html",
    "bootloader": "bootloader/index.html",
    "wheel speed": "cubeacp/wheel_speed.html",
    "Current Unix Time": "common/current_unix_time.html",
    "roll angle": ROLL,
    "angle roll estimated": ROLL,
    # ids
    "146": ANGLES,
    "0x92": ANGLES,
    "92h": ANGLES,
    "telemetry 190": "cubeacp/adcs_state.html",
    "id 132": "cubeacp/current_adcs_state.html",
    "set 20": "cubeacp/adcs_configuration.html",
    "telemetry 206": "cubeacp/adcs_configuration.html",
    # identifiers
    "cubeacp_estimated_attitude_angles_t": ANGLES,
    "cubeacp_estimated_attitude_angles_decode": ANGLES,
    "CUBEACP_ESTIMATED_ATTITUDE_ANGLES_ID": ANGLES,
    "EstimatedAttitudeAngles": ANGLES,
    "icd::cubeacp::EstimatedAttitudeAngles": ANGLES,
    "estimated_roll_angle_deg": ROLL,
    "cubeacp_estimated_attitude_angles_set_estimated_roll_angle_deg": ROLL,
    "set_estimated_roll_angle_deg": ROLL,
    "CUBEACP_CON_MODE_SELECT_Y_THOMSON_SPIN": f"{MODES}#member-y_thomson_spin",
    "ConModeSelect.Y_THOMSON_SPIN": f"{MODES}#member-y_thomson_spin",
    "YWheelSteadyState": f"{MODES}#member-y_wheel_steady_state",
    # members
    "thomson": f"{MODES}#member-y_thomson_spin",
    "detumbling control": f"{MODES}#member-detumbling_control",
    "Full-state EKF": "cubeacp/enum-estim_mode_select.html#member-full_state_ekf",
    "MEMS gyro EKF": "cubeacp/enum-estim_mode_select.html#member-mems_gyro_ekf",
    # units
    "deg/s": "units.html#unit-deg_per_s",
    "rpm": "units.html#unit-rpm",
    "mA": "units.html#unit-ma",
    "msdos_time": "units.html#unit-msdos_time",
    # tables, errata
    "table 149": "cubeacp/adcs_state.html",
    "Table 192": "cubeacp/adcs_configuration.html",
    "table 78": MODES,
    "table 27": "common/identification.html",
    "acp-066": "errata.html#ACP-066",
    "ACP-066": "errata.html#ACP-066",
    # protocol words
    "baud": "cubeacp/protocol.html#lines",
    "crc": "cubeacp/protocol.html#checksums",
    "escape byte framing": "cubeacp/protocol.html#framing",
    "can identifier": "cubeacp/protocol.html#identifier",
    "error codes": "cubeacp/protocol.html#errors",
    "timeout retries": "cubeacp/protocol.html#times",
    "parity": "cubeacp/protocol.html#lines",
    # misspelt
    "estimted attitude": ANGLES,
    "atittude angles": ANGLES,
    "indentification": "common/identification.html",
    "quaternon": "cubeacp/estimated_quaternion.html",
    "thompson spin": f"{MODES}#member-y_thomson_spin",
    "magnetometr": "cubeacp/magnetometer_configuration.html",
    "wheelspeed": "cubeacp/wheel_speed.html",
    "bootlaoder": "bootloader/index.html",
    "attitudeangles": ANGLES,
    "configuraton adcs": "cubeacp/adcs_configuration.html",
}

# Queries of a user who has not read the manual, and the page that must come first.
FIRST = {
    "detumble": "cubeacp/set_detumbling_control_parameters.html",
    "attitude CAN": ANGLES,
    "star tracker enabled": "cubeacp/set_star_tracker_configuration.html#field-star_tracking_module_enable",
    "deploy": "cubeacp/deploy_magnetometer_boom.html",
    "unix time": "common/current_unix_time.html",
    "error 3": "common/enum-tc_error_reason.html#member-incorrect_parameter",
    "i2c address": "common/protocol.html#lines",
    "timeout": "common/protocol.html#times",
    "log mask": "cubeacp/index.html#log-mask",
}
NOTHING = [
    "",
    "  ",
    "xyzzyqwert",
    "!!!",
    "battery voltage",
    "coffee machine",
    "propulsion",
    "temperature of moon",
    "hyperspace jump",
]


def search_results(site, queries: list[str]) -> list[list[str]]:
    """Return the addresses that each query gives, the best first."""
    code = f"""
        const {{ readFileSync }} = require("node:fs");
        const {{ finder }} = require({json.dumps(str(SCRIPT))});
        (0, eval)(readFileSync({json.dumps(str(site / "search-index.js"))}, "utf8"));
        const find = finder(globalThis.icdgenSearchIndex);
        return argument.map((query) => find(query).map((one) => one.url));
    """
    return run_script(code, queries)


def test_the_wanted_page_is_first_or_second(site):
    results = search_results(site, list(QUERIES))
    wrong = [
        (q, r[:3])
        for (q, url), r in zip(QUERIES.items(), results, strict=True)
        if not fits(url, r[:2])
    ]
    assert len(QUERIES) >= 60 and wrong == []


def fits(url: str, best: list[str]) -> bool:
    """Return whether an address is among the best. For a protocol, the page of any node
    with it counts.
    """
    return url in best or (
        "/protocol" in url
        and any(key.partition("/")[2] == url.partition("/")[2] for key in best)
    )


def test_common_words_list_the_page_of_the_manual_first(site):
    results = search_results(site, list(FIRST))
    assert [
        (q, r[:2])
        for (q, url), r in zip(FIRST.items(), results, strict=True)
        if r[:1] != [url]
    ] == []


def test_a_quantity_finds_the_fields_of_its_units(tmp_path):
    without = tmp_path / "p31u.yaml"
    without.write_text(
        P31U.read_text("utf-8").replace("aliases: [Battery Voltage], ", "")
    )
    write_site(make_site([without]), tmp_path / "site")
    ((first, *_),) = search_results(tmp_path / "site", ["battery voltage"])
    assert first == "p31u/housekeeping.html#field-power_battery"


def test_an_alias_is_listed_before_names_with_its_words(tmp_path):
    text = P31U.read_text("utf-8")
    text = text.replace(
        "  - name: Housekeeping\n",
        "  - name: Housekeeping\n    aliases: [State of Health, Battery Mode]\n",
    )
    text = text.replace(
        "  - name: Tracking\n", "  - name: Tracking\n    aliases: [Operating Point]\n"
    )
    text = text.replace(
        "name: Boot Cause, ", "name: Boot Cause, aliases: [Reason of Restart], "
    )
    (tmp_path / "p31u.yaml").write_text(text)
    write_site(make_site([tmp_path / "p31u.yaml"]), tmp_path / "site")
    wanted = {
        "state of health": "p31u/housekeeping.html",
        "StateOfHealth": "p31u/housekeeping.html",
        "stat of helth": "p31u/housekeeping.html",
        "operating point": "p31u/enum-tracking.html",
        "battery voltage": "p31u/housekeeping.html#field-power_battery",
        "reason of restart": "p31u/housekeeping.html#field-basics_boot_cause",
        "battery mode": "p31u/enum-battery_mode.html",  # a name precedes an alias
    }
    results = search_results(tmp_path / "site", list(wanted))
    assert [
        (q, r[:2])
        for (q, url), r in zip(wanted.items(), results, strict=True)
        if r[:1] != [url]
    ] == []
    page = (tmp_path / "site" / "p31u" / "housekeeping.html").read_text("utf-8")
    assert (
        "Also called State of Health, Battery Mode." in page
        and "Also called Reason of Restart" in page
    )
    assert "Also called Operating Point." in (
        tmp_path / "site" / "p31u" / "enum-tracking.html"
    ).read_text("utf-8")


def test_a_meaningless_query_has_no_results(site):
    assert search_results(site, NOTHING) == [[]] * len(NOTHING)


@pytest.mark.parametrize("backend", [CBackend, PythonBackend, RustBackend])
def test_generated_names_lead_to_the_page_of_their_message(site, shipped, backend):
    """The query is the type of a message as each language declares it."""
    names = {}
    for identifier in backend().identifiers(shipped):
        kind, _, name = identifier.owner.partition(" `")
        if kind == "message":
            names.setdefault(identifier.text, set()).add(name.rstrip("`"))
    unique_names = sorted(name for name, owners in names.items() if len(owners) == 1)
    assert len(unique_names) > 100
    every = [m for node in shipped.nodes for m in node.messages]
    index = {
        m.name: m for m in every if sum(m.name == other.name for other in every) == 1
    }
    links = Links(shipped)
    results = search_results(site, unique_names)
    wrong = []
    for name, urls in zip(unique_names, results, strict=True):
        (owner,) = names[name]
        if owner in index and links.message(index[owner]) not in urls[:2]:
            wrong.append((name, owner, urls[:2]))
    assert wrong == []
