"""Random ICDs like the ICDs of manuals: long names, gaps, long tables, every type and
kind of formula.
"""

from __future__ import annotations

from hypothesis import strategies as st

_WORDS = (
    "Wheel", "Speed", "Raw", "SD-card", "Error", "Sun", "X", "Y", "of", "the", "Mode", "I2C", "Status/Flags", "(Major)", "2",
    "Battery", "Voltage", "Temperature", "CRC16", "A", "Panel", "Timeout", "Selected", "Loop", "count", "-", "Q3", "AUX.",
)  # fmt: skip
_UNITS = ("deg", "deg/s", "rpm", "mA", "km", "m/s^2", "%", "C", "10ms units")
_FORMULAS = (
    "raw*0.01",
    "raw/10000.0",
    "raw*0.48828125",
    "raw*0.1 - 273.15",
    "(raw - 32)*5/9",
    "raw = value*1000.0",
    "2*raw + 0.5",
)


@st.composite
def name(draw, used: set[str], lead: str = "") -> str:
    """Draw a name that is unique in its scope. It starts and ends with a word."""
    middle = draw(st.lists(st.sampled_from(_WORDS), min_size=0, max_size=4))
    text = " ".join(
        [
            lead or draw(st.sampled_from(_WORDS[:6])),
            *middle,
            draw(st.sampled_from(("Value", "State", "Gain", "Level"))),
        ]
    )
    while text in used:
        text += f" {len(used)}"
    used.add(text)
    return text


@st.composite
def trees(draw) -> dict:
    """Draw an ICD of one node."""
    enums = []
    for number in range(draw(st.integers(1, 3))):
        used: set[str] = set()
        values = draw(
            st.lists(st.integers(0, 255), min_size=1, max_size=30, unique=True)
        )
        enums.append(
            {
                "name": f"Choice{number}Type",
                "members": [
                    {"value": v, "name": draw(name(used))} for v in sorted(values)
                ],
            }
        )
    messages, used = [], set()
    for number in range(draw(st.integers(2, 8))):
        kind = draw(st.sampled_from(("telecommand", "telemetry", "configuration")))
        message: dict = {"name": draw(name(used, f"M{number}")), "kind": kind}
        if kind == "configuration":
            message |= {"set_id": number + 1, "get_id": number + 201}
        else:
            message["id"] = number + 1 if kind == "telecommand" else number + 131
        fields = draw(_fields(enums))
        message["length"] = (
            max((f["at"] + f["bits"] + 7) // 8 for f in fields) if fields else 0
        )
        message["group"] = draw(
            st.sampled_from(("General", "Attitude and Orbit", "Power"))
        )
        if fields:
            message["fields"] = fields
        messages.append(message)
    return {
        "icdgen": 1,
        "node": {"name": "device"},
        "enums": enums,
        "messages": messages,
    }


@st.composite
def _fields(draw, enums: list[dict]) -> list[dict]:
    fields, used, at = [], set(), 0
    for _ in range(draw(st.sampled_from((0, 1, 2, 3, 5, 8, 60)))):
        at += draw(st.sampled_from((0, 0, 0, 0, 3, 8)))
        drawn = draw(_field(enums))
        fields.append(
            {"at": at, "bits": drawn.pop("bits"), "name": draw(name(used)), **drawn}
        )
        at += fields[-1]["bits"]
    return fields


@st.composite
def _field(draw, enums: list[dict]) -> dict:
    kind = draw(st.sampled_from(("uint", "int", "bool", "enum", "float", "bytes")))
    if kind == "bool":
        return {"bits": 1, "type": kind}
    if kind == "enum":
        return {
            "bits": draw(st.sampled_from((4, 8))),
            "type": kind,
            "enum": draw(st.sampled_from(enums))["name"],
        }
    if kind == "bytes":
        return {"bits": 8 * draw(st.integers(1, 20)), "type": kind}
    drawn: dict = {
        "bits": draw(st.sampled_from((32, 64) if kind == "float" else (8, 12, 16, 32))),
        "type": kind,
    }
    if draw(st.booleans()):
        drawn["unit"] = draw(st.sampled_from(_UNITS))
    if kind != "float" and draw(st.booleans()):
        drawn["formula"] = draw(st.sampled_from(_FORMULAS))
        if "=" not in drawn["formula"] and draw(st.integers(0, 3)) == 0:
            drawn["formula_for"] = "raw"
    elif kind == "uint" and draw(st.integers(0, 3)) == 0:
        drawn["const"] = draw(st.integers(0, 255))
    return drawn
