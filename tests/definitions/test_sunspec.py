"""SunSpec models become ICDs: points are fields, repeated groups are structs.

tests/devices compares the values of random blocks with pysunspec2.
"""

from __future__ import annotations

import copy
import json
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen import codec
from icdgen.definitions import kinds, run, sunspec
from icdgen.definitions.model import Definitions
from icdgen.diagnostics import Findings
from icdgen.icd.fmt import emit
from icdgen.icd.load import load
from tests.definitions.test_can import FILES, field, message

MODELS = json.loads((FILES / "charger.json").read_text())


@pytest.fixture(scope="module")
def charger():
    reader = kinds.reader_of_file(FILES / "charger.json")
    assert isinstance(reader, sunspec.SunSpec)
    return run.read(FILES / "charger.json", reader)


def test_models_of_a_device_are_messages_whose_points_follow_each_other(charger):
    (tree,) = charger.trees.values()
    assert tree["node"] | {"name": "", "title": ""} == {
        "name": "", "title": "", "byte_order": "big", "bit_order": "msb0", "id_bits": 16,
    }  # fmt: skip
    assert [(message["name"], message["id"], message["length"]) for message in tree["messages"]] == [
        ("charger", 65001, 64), ("sockets", 65002, 4),
    ]  # fmt: skip
    places = [
        (field["at"] // 16, field["name"])
        for field in message(charger, "charger")["fields"]
    ]
    assert places[:6] == [
        (0, "ID"),
        (1, "L"),
        (2, "W"),
        (3, "W_SF"),
        (4, "Lat"),
        (6, "Wh"),
    ]
    assert places[-3:] == [(29, "Dial Pos"), (30, "Lamp"), (32, "Socket")]
    assert field(charger, "charger", "ID")["const"] == 65001 and "special" not in field(
        charger, "charger", "L"
    )
    assert message(charger, "charger")["summary"] == "A charger with sockets"


def test_a_value_has_its_unit_and_factor_or_a_summary_about_the_register_with_the_factor(
    charger,
):
    lat, power = field(charger, "charger", "Lat"), field(charger, "charger", "W")
    assert (lat["unit"], lat["formula"], lat["summary"]) == (
        "deg",
        "raw*1e-7",
        "Latitude, north is positive",
    )
    assert power["summary"] == "Power. In W times 10 to the power of W_SF."
    assert "unit" not in power and "formula" not in power
    (finding,) = (
        finding
        for finding in charger.definitions.import_findings
        if finding.code == "IMP078"
    )
    assert (
        finding.message
        == "message `charger`: the factors of 1 points are in other registers: `W`"
    )
    assert finding.severity == "note"


def test_the_not_implemented_value_of_each_type_is_a_special_value(charger):
    values = {
        field["name"]: field["special"][0]["value"]
        for field in message(charger, "charger")["fields"]
        if "special" in field
    }
    assert values == {
        "W": -0x8000, "W_SF": -0x8000, "Lat": -0x80000000, "Wh": 0, "St": 0xFFFF, "Evt": 0xFFFFFFFF, "Hz": "nan", "N": 0xFFFF,
        "Dial Pos": 0xFFFF,
    }  # fmt: skip


def test_symbols_become_enumerations_and_symbols_of_bit_fields_flags(charger):
    (tree,) = charger.trees.values()
    named = {
        enum["name"]: [(member["value"], member["name"]) for member in enum["members"]]
        for enum in tree["enums"]
    }
    assert named == {
        "St": [(0, "OFF"), (3, "ON")],
        "Evt": [(1, "HOT"), (1 << 31, "LOST")],
    }
    assert (
        field(charger, "charger", "Nam")["type"],
        field(charger, "charger", "MAC")["type"],
    ) == ("text", "bytes")


def test_repeated_groups_are_structs(charger):
    (tree,) = charger.trees.values()
    assert [(struct["name"], struct["length"], [part["name"] for part in struct["fields"]]) for struct in tree["structs"]] == [
        ("Lamp", 2, ["Lux"]), ("Socket", 4, ["A", "Lock Is"]), ("sockets Socket", 2, ["V"]),
    ]  # fmt: skip
    ends = [message(charger, name)["fields"][-1] for name in ("charger", "sockets")]
    assert [(field["count"], field["up_to"]) for field in ends] == [
        ("N", (2048 - 64) // 4),
        ("rest", (2048 - 4) // 2),
    ]
    assert field(charger, "charger", "Lamp")["count"] == 2


def test_an_unsupported_model_is_reported_with_the_reason_and_the_others_are_imported(
    charger,
):
    (finding,) = (
        finding
        for finding in charger.definitions.import_findings
        if finding.severity == "error"
    )
    assert finding.message == (
        "message `curves` is not imported: "
        "`Pt`, which has any number of repetitions, is inside `Crv`, whose repetitions no point counts"
    )
    assert (charger.imported, charger.definitions.total) == (2, 3)
    assert finding.help == (
        "if your device always has the same number, write it into a copy of the file: "
        "as `count` of `Pt` and as `value` of the point `NPt`"
    )


def test_a_group_in_a_counted_group_is_counted_by_a_point_of_the_model(
    tmp_path,
):
    curves = copy.deepcopy(
        next(model for model in MODELS if model["group"]["name"] == "curves")
    )
    points, (curve,) = curves["group"]["points"], curves["group"]["groups"]
    points.append({"name": "NCrv", "type": "uint16", "size": 1})
    curve["count"] = "NCrv"
    trip = {
        "name": "Trip",
        "points": [{"name": "ActPt", "type": "uint16", "size": 1}],
        "groups": [curve["groups"][0]],
    }
    curve["groups"].append(trip)
    (tmp_path / "curves.json").write_text(json.dumps(curves))
    read = run.read(tmp_path / "curves.json", sunspec.SunSpec())
    assert not read.failed
    (tmp_path / "curves.yaml").write_text(
        emit.canonical_yaml(next(iter(read.trees.values())))
    )
    loaded = load([tmp_path / "curves.yaml"])
    assert loaded.ok
    (node,) = loaded.icd.nodes
    (layout,) = node.messages

    for number in (0, 1, 3):
        rows = [
            (on, *range(on, on + number), 70 + on, *range(on + 9, on + 9 + number))
            for on in (10, 20)
        ]
        registers = (65003, 12, number, 2, *rows[0], *rows[1])
        frame = struct.pack(f">{len(registers)}H", *registers)
        raw = codec.decode_frame(node, layout, frame)
        assert [raw[f"Crv[{index}].Trip ActPt"] for index in (0, 1)] == [80, 90]
        assert [raw[f"Crv[1].Pt[{index}].X"] for index in range(number)] == list(
            range(20, 20 + number)
        )
        assert [raw[f"Crv[1].Trip Pt[{index}].X"] for index in range(number)] == list(
            range(29, 29 + number)
        )
        assert f"Crv[0].Pt[{number}].X" not in raw
        assert codec.encode(node, layout, codec.decode(node, layout, frame)) == frame
        with pytest.raises(codec.LengthError):
            codec.decode(node, layout, frame + bytes(2))


def test_points_and_groups_after_a_repeated_group_are_imported(tmp_path):
    register = {"type": "uint16", "size": 1}
    model = {
        "id": 65004,
        "group": {
            "name": "solar",
            "points": [{"name": name, **register} for name in ("ID", "L", "N", "M")],
            "groups": [
                {"name": "Str", "count": "N", "points": [{"name": "A", **register}]},
                {"name": "Sum", "points": [{"name": "W", **register}]},
                {"name": "Ph", "count": "M", "points": [{"name": "V", **register}]},
                {"name": "End", "points": [{"name": "Evt", **register}]},
            ],
        },
    }
    (tmp_path / "solar.json").write_text(json.dumps(model))
    read = run.read(tmp_path / "solar.json", sunspec.SunSpec())
    assert not read.failed
    (tmp_path / "solar.yaml").write_text(
        emit.canonical_yaml(next(iter(read.trees.values())))
    )
    loaded = load([tmp_path / "solar.yaml"])
    assert loaded.ok
    (node,) = loaded.icd.nodes
    (solar,) = node.messages
    registers = (65004, 9, 2, 3, 10, 11, 70, 20, 21, 22, 90)
    frame = struct.pack(f">{len(registers)}H", *registers)
    raw = codec.decode_frame(node, solar, frame)
    assert (raw["Str[1].A"], raw["Sum W"]) == (11, 70)
    assert (raw["Ph[2].V"], raw["End Evt"]) == (22, 90)


def test_groups_after_a_group_without_a_count_must_have_a_fixed_size(tmp_path):
    register = {"type": "uint16", "size": 1}
    model = {
        "id": 65004,
        "group": {
            "name": "solar",
            "points": [{"name": name, **register} for name in ("ID", "L", "N")],
            "groups": [
                {"name": "Str", "count": 0, "points": [{"name": "A", **register}]},
                {"name": "Ph", "count": "N", "points": [{"name": "V", **register}]},
            ],
        },
    }
    (tmp_path / "solar.json").write_text(json.dumps(model))
    with pytest.raises(Findings) as refused:
        run.read(tmp_path / "solar.json", sunspec.SunSpec())
    (finding,) = refused.value.findings
    assert "`Ph` follows a group whose repetitions no point counts" in finding.message


def test_a_group_in_a_repeated_group_is_imported_with_the_number_of_a_device(tmp_path):
    curves = copy.deepcopy(
        next(model for model in MODELS if model["group"]["name"] == "curves")
    )
    points, (curve,) = curves["group"]["points"], curves["group"]["groups"]
    points.append({"name": "NCrv", "type": "uint16", "size": 1})
    curve["count"] = "NCrv"
    curve["groups"][0]["count"] = 4
    next(point for point in points if point["name"] == "NPt")["value"] = 4
    (tmp_path / "curves.json").write_text(json.dumps(curves))
    read = run.read(tmp_path / "curves.json", sunspec.SunSpec())
    assert not read.failed and field(read, "curves", "NPt")["const"] == 4
    (tmp_path / "curves.yaml").write_text(
        emit.canonical_yaml(next(iter(read.trees.values())))
    )
    loaded = load([tmp_path / "curves.yaml"])
    assert loaded.ok
    (node,) = loaded.icd.nodes
    (layout,) = node.messages

    head = struct.pack(">4H", 65003, 12, 4, 2)
    raw = codec.decode(
        node, layout, head + struct.pack(">10H", 1, *range(10, 14), 0, *range(20, 24))
    )
    assert [raw[f"Crv[{number}].On"] for number in (0, 1)] == [1, 0]
    assert [raw[f"Crv[1].Pt[{number}].X"] for number in range(4)] == [20, 21, 22, 23]
    for other in (3, 5):  # two curves, each with another number of points
        frame = struct.pack(">4H", 65003, 2 + 2 * (1 + other), other, 2) + bytes(
            2 * 2 * (1 + other)
        )
        with pytest.raises(codec.LengthError):
            codec.decode(node, layout, frame)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"type": "fixed16"}, "`W` is of the type `fixed16`"),
        ({"type": "string", "size": 0}, "`W` is of the type `string` and size 0"),
        ({"type": "string", "size": "8"}, "`W` is of the type `string` and size 8"),
    ],
)
def test_a_model_with_an_invalid_point_is_left_out(tmp_path, change, why):
    models = copy.deepcopy(MODELS)
    models[0]["group"]["points"][2] |= change
    (tmp_path / "models.json").write_text(json.dumps(models))
    read = run.read(tmp_path / "models.json", sunspec.SunSpec())
    assert why in [
        finding.message.split(": ", 1)[1]
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    ]
    assert read.imported == 1


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (
            '[\n{"id": 1, "group": {"name": "a", "points": [}}]',
            2,
            "not JSON: Expecting value",
        ),
        (
            '{"group": {"name": "a", "points": []}}',
            1,
            "not a model of SunSpec, nor a list of them",
        ),
        (
            '{"id": 70000, "group": {"name": "a", "points": []}}',
            1,
            "not a model of SunSpec, nor a list of them",
        ),
        ("[]", 1, "the list holds no model"),
        ("[" * 100_000, 1, "not JSON"),
        (
            '{"id": 1, "group": {"name": "a", "points": []}}',
            1,
            "no message can be imported",
        ),
    ],
)
def test_an_invalid_model_is_refused_with_its_line(tmp_path, text, line, message):
    (tmp_path / "wrong.json").write_text(text)
    with pytest.raises(Findings) as refused:
        run.read(tmp_path / "wrong.json", sunspec.SunSpec())
    (finding,) = refused.value.findings
    assert (finding.code, finding.place.line) == (
        "IMP005",
        line,
    ) and finding.message.startswith(message)


def test_groups_nested_too_deeply_are_left_out():
    deep = {"name": "a", "points": []}
    for _ in range(50):
        deep = {"name": "a", "points": [], "groups": [deep]}
    definitions = sunspec.SunSpec().read(
        "deep.json", json.dumps({"id": 1, "group": deep}).encode()
    )
    assert (
        "groups are nested more than 8 deep" in definitions.import_findings[0].message
    )


VALUES = (
    st.none()
    | st.booleans()
    | st.integers(-5, 1 << 40)
    | st.floats()
    | st.text(max_size=5)
    | st.just([])
    | st.just({})
)


@given(st.data())
def test_any_content_of_a_model_is_imported_or_reported(data):
    models = copy.deepcopy(MODELS)
    owners = list(_objects(models))
    for _ in range(data.draw(st.integers(1, 3))):
        owner = data.draw(st.sampled_from(owners))
        owner[data.draw(st.sampled_from([*owner, "count", "sf"]))] = data.draw(VALUES)
    try:
        definitions = sunspec.SunSpec().read("some.json", json.dumps(models).encode())
    except Findings:
        return
    assert isinstance(definitions, Definitions) and definitions.total >= len(
        definitions.networks[0].messages
    )


def _objects(of):
    children = []
    if isinstance(of, dict):
        yield of
        children = of.values()
    elif isinstance(of, list):
        children = of
    for child in children:
        yield from _objects(child)


def points_of(*points):
    """Return the fields of a model with these points."""
    header = [{"name": "ID", "type": "uint16", "size": 1, "value": 9},
              {"name": "L", "type": "uint16", "size": 1}]  # fmt: skip
    listed = [{"name": f"P{at}", **point} for at, point in enumerate(points)]
    model = {
        "id": 9,
        "group": {"name": "m", "points": header + listed},
    }
    definitions = sunspec.SunSpec().read("a.json", json.dumps(model).encode())
    ((made,),) = (network.messages for network in definitions.networks)
    fields = [each for each in made["fields"] if each["name"].startswith("P")]
    return fields, definitions


@pytest.mark.parametrize(
    ("type_", "registers", "form", "none"),
    [
        ("int16", 1, "int", -0x8000), ("int32", 2, "int", -(1 << 31)),
        ("int64", 4, "int", -(1 << 63)), ("uint16", 1, "uint", 0xFFFF),
        ("uint32", 2, "uint", (1 << 32) - 1), ("uint64", 4, "uint", (1 << 64) - 1),
        ("acc16", 1, "uint", 0), ("acc32", 2, "uint", 0), ("acc64", 4, "uint", 0),
        ("enum16", 1, "uint", 0xFFFF), ("enum32", 2, "uint", (1 << 32) - 1),
        ("bitfield16", 1, "uint", 0xFFFF), ("bitfield32", 2, "uint", (1 << 32) - 1),
        ("bitfield64", 4, "uint", (1 << 64) - 1), ("float32", 2, "float", "nan"),
        ("float64", 4, "float", "nan"), ("raw16", 1, "uint", None),
        ("count", 1, "uint", 0xFFFF), ("ipaddr", 2, "bytes", None),
        ("ipv6addr", 8, "bytes", None), ("eui48", 4, "bytes", None),
        ("string", 3, "text", None),
    ],
)  # fmt: skip
def test_a_point_has_the_registers_of_its_type(type_, registers, form, none):
    ((field,), definitions) = points_of({"type": type_, "size": registers})
    assert definitions.import_findings == []
    assert (field["type"], field["bits"]) == (form, 16 * registers)
    assert [each["value"] for each in field.get("special", ())] == (
        [] if none is None else [none]
    )


def test_symbols_are_values_of_32_bits_or_bits_of_64():
    def values(type_, size, *numbers):
        symbols = [{"name": f"S{number}", "value": number} for number in numbers]
        _, definitions = points_of({"type": type_, "size": size, "symbols": symbols})
        (network,) = definitions.networks
        (field,) = (f for f in network.messages[0]["fields"] if f["name"] == "P0")
        named = {m["value"]: m["name"] for e in network.enums for m in e["members"]}
        named |= {each["value"]: each["meaning"] for each in field.get("special", ())}
        return sorted(value for value, name in named.items() if name.startswith("S"))

    assert values("enum32", 2, 0, 1, (1 << 32) - 1, 1 << 32, -1) == [
        0, 1, (1 << 32) - 1,
    ]  # fmt: skip
    assert values("bitfield64", 4, 0, 63, 64) == [1, 1 << 63]
