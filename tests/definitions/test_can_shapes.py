"""Features of public CAN databases: the imported ICD reads the same values as cantools
from the same frames. The databases are our own.
"""

from __future__ import annotations

import contextlib
import random

import pytest

from icdgen import codec
from icdgen.definitions import can, run
from icdgen.icd import wire_ids
from icdgen.icd.fmt import emit
from icdgen.icd.frames import frame_fields
from icdgen.loading import load
from tests.definitions.test_can import FILES

HEAD = 'VERSION ""\n\nBU_: Engine Gateway Display\n\n'


def imported(text: str, folder) -> run.ReadDefinitions:
    path = folder / "network.dbc"
    path.write_text(text)
    return run.read(path, can.Dbc())


def tree_of(read: run.ReadDefinitions) -> dict:
    (tree,) = read.trees.values()
    return tree


def message(read: run.ReadDefinitions, name: str) -> dict:
    return next(
        message for message in tree_of(read)["messages"] if message["name"] == name
    )


def field(read: run.ReadDefinitions, owner: str, name: str) -> dict:
    return next(
        field for field in message(read, owner)["fields"] if field["name"] == name
    )


def model(read: run.ReadDefinitions, folder):
    """Return the ICD as `icdgen check` loads it, without a finding."""
    path = folder / f"{next(iter(read.trees))}.yaml"
    path.write_text(emit.canonical_yaml(tree_of(read)), encoding="utf-8")
    loaded = load([path])
    assert [finding.message for finding in loaded.findings] == []
    return loaded.icd.nodes[0]


@pytest.fixture(scope="module")
def shapes():
    return run.read(FILES / "shapes.dbc", can.Dbc())


def assert_values_are_those_of_cantools(
    read: run.ReadDefinitions, text: str, folder
) -> int:
    """Compare raw and physical values of random frames of each message. Returns the
    number of values.
    """
    import cantools
    from cantools.database.errors import DecodeError

    node, compared, dice = model(read, folder), 0, random.Random(34)
    database = cantools.database.load_string(text, "dbc", strict=False)
    for ours in node.messages:
        flag = (
            wire_ids.CAN_EXTENDED_FLAG
            if node.id_bits == 32 and ours.telemetry_id & wire_ids.CAN_EXTENDED_FLAG
            else 0
        )
        theirs = next(
            message
            for message in database.messages
            if message.frame_id == ours.telemetry_id - flag
            and (node.id_bits != 32 or message.is_extended_frame == bool(flag))
        )
        selectors = {signal.multiplexer_signal for signal in theirs.signals} - {None}
        for _ in range(40):
            frame = dice.randbytes(ours.length)
            raw = codec.decode(node, ours, frame)
            for name in selectors:  # often a value that selects a field
                fields = frame_fields(ours.layout, node.orders)
                chosen = next(field for field in fields if field.name == name)
                values = [
                    value
                    for field in fields
                    for need in field.conditions
                    for value in need.values
                ]
                if dice.random() < 0.7 and values:
                    frame = codec.with_numbers(frame, {chosen: dice.choice(values)})
                    raw = codec.decode(node, ours, frame)
            for scaled in (False, True):
                # cantools raises for a value of the multiplexer without a signal.
                with contextlib.suppress(DecodeError):
                    for name, value in theirs.decode(
                        frame, decode_choices=False, scaling=scaled
                    ).items():
                        mine = next(
                            (field for field in ours.fields if field.name == name), None
                        )
                        assert mine is not None and name in raw, (
                            f"{ours.name}.{name} is there in {frame.hex()}"
                        )
                        exact = codec.physical(mine, raw[name]) if scaled else None
                        expected = raw[name] if exact is None else exact
                        assert value == pytest.approx(float(expected), rel=1e-14), (
                            f"{ours.name}.{name} of {frame.hex()}"
                        )
                        compared += 1
    return compared


def test_values_of_all_shapes_equal_those_of_cantools(shapes, tmp_path):
    assert (
        assert_values_are_those_of_cantools(
            shapes, (FILES / "shapes.dbc").read_text(), tmp_path
        )
        > 500
    )


def test_a_signed_signal_with_a_name_keeps_its_sign(shapes, tmp_path):
    temperature = field(shapes, "Engine", "Temperature")
    assert temperature["type"] == "int" and temperature["special"] == [
        {"value": 127, "meaning": "Invalid"}
    ]
    node = model(shapes, tmp_path)
    engine = next(message for message in node.messages if message.name == "Engine")
    assert (
        codec.decode(node, engine, bytes.fromhex("00f6000000000000"))["Temperature"]
        == -10
    )


def test_a_quantity_with_a_name_for_not_available_keeps_unit_and_limits(shapes):
    speed = field(shapes, "Engine", "Speed")
    assert (speed["type"], speed["unit"], speed["max"]) == ("uint", "km/h", 254)
    assert speed["special"] == [{"value": 255, "meaning": "SNA"}]
    torque = field(shapes, "Engine", "Torque")
    assert (torque["type"], torque["min"], torque["max"], len(torque["special"])) == (
        "int",
        -100,
        100,
        2,
    )


def test_named_values_without_unit_or_for_all_values_become_enumerations(
    shapes,
):
    kinds = {
        name: field(shapes, "Engine", name)["type"]
        for name in ("Gear", "Level", "Trim", "Range")
    }
    assert set(kinds.values()) == {"enum"}
    members = {
        enum["name"]: [each["value"] for each in enum["members"]]
        for enum in tree_of(shapes)["enums"]
    }
    assert members == {
        "Gear": [0, 1, 7],
        "Level": [0, 1, 2],
        "Trim": [-2, -1, 0, 1],
        "Range": [1],
    }


def test_standard_and_extended_frames_of_one_number_are_two_messages(shapes):
    ids = {
        message["name"]: int(message["id"]) for message in tree_of(shapes)["messages"]
    }
    assert tree_of(shapes)["node"]["id_bits"] == 32
    assert ids == {"Engine": 0x100, "Diagnosis": 0x8000_0100, "Short": 0x101}


def test_fields_depend_on_a_signed_multiplexer(shapes):
    whens = {
        field["name"]: field.get("when")
        for field in message(shapes, "Diagnosis")["fields"]
    }
    assert whens == {"Page": None, "Current": {"Page": 0}, "Voltage": {"Page": 127}}


@pytest.mark.parametrize(("bits", "sign", "value", "is_held"), [
    (2, "+", 3, True), (2, "+", 4, False), (2, "-", 1, True), (2, "-", 2, False), (8, "+", 255, True), (8, "+", 256, False),
])  # fmt: skip
def test_a_value_that_the_multiplexer_cannot_have_selects_nothing(
    bits, sign, value, is_held, tmp_path
):
    text = (
        f'{HEAD}BO_ 1 Status: 4 Engine\n SG_ Page M : 0|{bits}@1{sign} (1,0) [0|0] "" Display\n'
        f' SG_ Speed m{value} : 8|8@1+ (1,0) [0|0] "" Display\n'
    )
    read = imported(text, tmp_path)
    assert (
        "Speed" in [field["name"] for field in message(read, "Status")["fields"]]
    ) == is_held
    messages = [
        finding.message
        for finding in read.definitions.import_findings
        if finding.code == "IMP091"
    ]
    assert messages == (
        []
        if is_held
        else [
            "message `Status`, `Speed` is left out: it depends on values of `Page` that it cannot have"
        ]
    )


def test_long_names_of_messages_signals_and_multiplexers_are_imported(
    tmp_path,
):
    long = "Temperature_of_the_cooling_water_behind_the_second_heat_exchanger"
    text = (
        f'{HEAD}BO_ 1 Stat: 4 Engine\n SG_ Pg M : 0|8@1+ (1,0) [0|0] "" Display\n'
        ' SG_ T1 m1 : 8|8@1+ (1,0) [0|0] "" Display\n SG_ T2 m2 : 8|8@1+ (1,0) [0|0] "" Display\n'
        ' SG_ T3 : 16|8@1+ (1,0) [0|0] "" Display\n\n'
        'BA_DEF_ SG_ "SystemSignalLongSymbol" STRING ;\nBA_DEF_ BO_ "SystemMessageLongSymbol" STRING ;\n'
        'BA_DEF_ "DBName" STRING ;\nBA_DEF_DEF_ "SystemSignalLongSymbol" "";\nBA_DEF_DEF_ "SystemMessageLongSymbol" "";\n'
        'BA_DEF_DEF_ "DBName" "";\nBA_ "DBName" "";\n'
        f'BA_ "SystemMessageLongSymbol" BO_ 1 "Status_of_the_engine";\nBA_ "SystemSignalLongSymbol" SG_ 1 Pg "{long}_page";\n'
        f'BA_ "SystemSignalLongSymbol" SG_ 1 T1 "{long}_inlet";\nBA_ "SystemSignalLongSymbol" SG_ 1 T2 "{long}_outlet";\n'
        'BA_ "SystemSignalLongSymbol" SG_ 1 T3 "";\n'
    )
    read = imported(text, tmp_path)
    assert {field["name"]: field.get("when") for field in message(read, "Status_of_the_engine")["fields"]} == {
        f"{long}_page": None, f"{long}_inlet": {f"{long}_page": 1}, f"{long}_outlet": {f"{long}_page": 2}, "T3": None,
    }  # fmt: skip
    assert read.identifiers == [], (
        "a limit of C is solved in C, not by other names for all languages"
    )


def test_many_names_that_are_no_identifiers_lose_no_message(tmp_path):
    names = [
        "class",
        "CLASS",
        "Class",
        "cLASS",
        "int",
        "INT",
        "Int_",
        "_int",
        "Speed",
        "speed",
        "SPEED",
        "Spe_ed",
        "SPE_ED",
    ]
    blocks = [
        f"BO_ {id} {name}{id % 2}: 8 Engine\n"
        + "".join(
            f' SG_ {name} : {4 * at}|4@1+ (1,0) [0|0] "" Display\n'
            for at, name in enumerate(names)
        )
        for id, name in enumerate(
            ("Status", "STATUS", "status", "STATus", "class", "Class"), 1
        )
    ]
    read = imported(HEAD + "\n".join(blocks), tmp_path)
    assert (read.imported, read.definitions.total) == (6, 6)
    assert all(
        len(message["fields"]) == len(names) for message in tree_of(read)["messages"]
    )
    assert [
        finding
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    ] == []
    model(read, tmp_path)


def test_enumerations_of_messages_and_fields_that_are_left_out_are_left_out_too(
    tmp_path,
):
    text = (
        f'{HEAD}BO_ 1 Twin: 8 Engine\n SG_ Mode : 0|8@1+ (1,0) [0|0] "" Display\n\n'
        'BO_ 1 Other: 8 Engine\n SG_ State : 0|8@1+ (1,0) [0|0] "" Display\n\n'
        'BO_ 2 Kept: 1 Engine\n SG_ Far : 8|8@1+ (1,0) [0|0] "" Display\n\n'
        'VAL_ 1 Mode 0 "Off" 1 "On" ;\nVAL_ 2 Far 0 "Near" 1 "Far" ;\n'
    )
    read = imported(text, tmp_path)
    used = {
        field["enum"]
        for each in tree_of(read)["messages"]
        for field in each.get("fields", ())
        if "enum" in field
    }
    assert {enum["name"] for enum in tree_of(read).get("enums", ())} == used
    assert "Far" not in used


def test_start_values_cycle_times_and_further_senders_arrive(tmp_path):
    text = (
        f'{HEAD}BO_ 1 Status: 2 Engine\n SG_ Speed : 0|8@1+ (0.5,0) [0|0] "" Display\n'
        ' SG_ Gear : 8|8@1+ (1,0) [0|0] "" Display\n\n'
        'BO_TX_BU_ 1 : Engine,Gateway;\nCM_ BO_ 1 "What the engine does";\nCM_ SG_ 1 Speed "How fast";\n'
        'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 10000;\nBA_DEF_ SG_ "GenSigStartValue" FLOAT 0 1000;\n'
        'BA_DEF_DEF_ "GenMsgCycleTime" 0;\nBA_DEF_DEF_ "GenSigStartValue" 0;\n'
        'BA_ "GenMsgCycleTime" BO_ 1 20;\nBA_ "GenSigStartValue" SG_ 1 Speed 7;\n'
    )
    read = imported(text, tmp_path)
    assert message(read, "Status")["group"] == "Engine"
    assert message(read, "Status")["period_ms"] == 20
    assert (
        message(read, "Status")["summary"]
        == "What the engine does. Also sent by Gateway."
    )
    assert (
        field(read, "Status", "Speed")["summary"] == "How fast. Start value: 7 (raw)."
    )


def test_statements_that_an_icd_cannot_represent_are_reported_with_name_and_line(
    tmp_path,
):
    text = (
        f"{HEAD.replace(chr(34) * 2, chr(34) + '1.2' + chr(34))}BO_ 1 Status: 2 Engine\n"
        ' SG_ Speed : 0|8@1+ (1,0) [0|0] "" Display\n\n'
        'EV_ Lamp: 0 [0|1] "" 0 1 DUMMY_NODE_VECTOR0 Engine;\nCM_ "EV_ of a text is none";\n'
        'BA_DEF_ BO_ "GenMsgDelayTime" INT 0 10000;\nBA_DEF_DEF_ "GenMsgDelayTime" 0;\nBA_ "GenMsgDelayTime" BO_ 1 20;\n'
        "SIG_GROUP_ 1 Pair 1 : Speed;\n"
    )
    read = imported(text, tmp_path)
    findings = {
        (finding.message, finding.spot.line)
        for finding in read.definitions.import_findings
        if finding.code == "IMP085"
    }
    assert {
        ("`VERSION` is not used", 1),
        ("`EV_` is not used", 8),
        ("`text of the network` of `CM_` is not used", 9),
        ("`GenMsgDelayTime` of `BA_` is not used (`BO_ 1`)", 12),
        ("`SIG_GROUP_` is not used", 13),
        ("`receivers` of `signal` is not used (message `Status`, `Speed`)", None),
    } <= findings


def test_a_database_that_is_used_completely_has_no_finding(tmp_path):
    text = f'{HEAD}BO_ 1 Status: 1 Engine\n SG_ Speed : 0|8@1+ (1,0) [0|0] "" Vector__XXX\n'
    assert imported(text, tmp_path).definitions.import_findings == []


def test_a_truncated_database_is_a_finding(tmp_path):
    text = (FILES / "shapes.dbc").read_text()
    message_count = len(
        [
            finding
            for finding in run.read(
                FILES / "shapes.dbc", can.Dbc()
            ).definitions.import_findings
            if finding.code != "IMP085"
        ]
    )
    from icdgen.diagnostics import Findings

    begin = text.index(" SG_ Speed")
    for end in range(begin, len(text) - 1, 7):
        cut = text[:end]
        try:
            read = imported(cut, tmp_path)
        except Findings:
            continue
        is_complete = cut.endswith((";", "\n")) or not cut.rsplit("\n", 1)[-1].strip()
        lines = {
            finding.spot.line
            for finding in read.definitions.import_findings
            if finding.code == "IMP075"
        }
        assert is_complete or lines & {
            cut.count("\n") + 1,
            cut.rstrip().count("\n") + 1,
        }, cut[-60:]
    assert message_count == 3


def test_a_statement_that_cantools_refuses_removes_only_its_message(tmp_path):
    text = (
        f'{HEAD}BO_ 1 Good: 1 Engine\n SG_ Speed : 0|8@1+ (1,0) [0|0] "" Display\n\n'
        'BO_ 2 Bad: 1 Engine\n SG_ Mode : 0|8@1+ (1,0) [0|0] "" Display\n\n'
        'BA_DEF_ SG_ "GenSigStartValue" STRING ;\nBA_DEF_DEF_ "GenSigStartValue" "";\nBA_ "GenSigStartValue" SG_ 2 Mode "high";\n'
    )
    read = imported(text, tmp_path)
    assert [message["name"] for message in tree_of(read)["messages"]] == [
        "Good"
    ] and read.definitions.total == 2
    (error,) = [
        finding
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    ]
    assert (
        error.code == "IMP070"
        and "message `Bad` is not imported" in error.message
        and error.spot.line == 8
    )


def test_messages_with_equal_names_are_renamed_by_sender_or_id(tmp_path):
    text = HEAD + "".join(
        f'BO_ {id} Status: 1 {sender}\n SG_ Level : 0|8@1+ (1,0) [0|0] "" Display\n\n'
        for id, sender in ((256, "Engine"), (257, "Gateway"))
    )
    read = imported(text, tmp_path)
    assert [message["name"] for message in tree_of(read)["messages"]] == [
        "Engine Status",
        "Gateway Status",
    ]
    assert "IMP092" in [finding.code for finding in read.definitions.import_findings]

    read = imported(text.replace("1 Gateway", "1 Engine"), tmp_path)
    assert [message["name"] for message in tree_of(read)["messages"]] == [
        "Status 0x100",
        "Status 0x101",
    ]
    model(read, tmp_path)


def test_values_that_the_multiplexer_cannot_have_are_reported(tmp_path):
    read = imported(
        f'{HEAD}BO_ 1 Status: 4 Engine\n SG_ Page M : 0|2@1+ (1,0) [0|0] "" Display\n'
        ' SG_ Speed m1 : 8|8@1+ (1,0) [0|0] "" Display\n\nSG_MUL_VAL_ 1 Speed Page 1-1, 3-9;\n',
        tmp_path,
    )
    assert field(read, "Status", "Speed")["when"] == {"Page": [1, 3]}
    assert [
        (finding.code, finding.severity, finding.message)
        for finding in read.definitions.import_findings
        if finding.code != "IMP085"
    ] == [
        (
            "IMP076",
            "warning",
            "message `Status`, `Speed`: it depends on `Page`, which never has the value 4, 5, 6, 7, 8 ...",
        )
    ]
    model(read, tmp_path)


def test_limits_of_floats_depend_on_their_size(tmp_path):
    limits = {
        "Far": (64, "-1E+30|2.5E+37"),
        "Near": (32, "-1E+30|2.5E+37"),
        "Beyond": (64, "-1E+38|1E+200"),
        "Full": (64, "-1.7E+308|1.7E+308"),
        "Whole": (32, "-3.4E+38|3.4E+38"),
    }
    text = HEAD + "".join(
        f'BO_ {id} {name}: 8 Engine\n SG_ Value : 0|{bits}@1- (1,0) [{ends}] "" Display\n\n'
        for id, (name, (bits, ends)) in enumerate(limits.items(), 1)
    )
    for id, (bits, _) in enumerate(limits.values(), 1):
        text += f"SIG_VALTYPE_ {id} Value : {bits // 32};\n"
    read = imported(text, tmp_path)
    keys = {
        name: {
            key: value
            for key, value in field(read, name, "Value").items()
            if key in ("min", "max")
        }
        for name in limits
    }
    stated = {"min": -(10**30), "max": 25 * 10**36}
    assert keys == {
        "Far": stated,
        "Near": stated,
        "Beyond": {},
        "Full": {},
        "Whole": {},
    }
    assert [
        finding.message
        for finding in read.definitions.import_findings
        if "limit" in finding.message
    ] == [
        "message `Beyond`, `Value`: the limit -1e+38 is not used",
        "message `Beyond`, `Value`: the limit 1e+200 is not used",
    ]
    model(read, tmp_path)


def test_equal_signals_with_other_value_names_stay_two_fields(tmp_path):
    pages = "\n".join(
        f"[Status]\n{head}Len=2\nMux=Page{value} 0,8 {value}h\nVar=Mode unsigned 8,8 /e:{enum}\n"
        for value, enum, head in (
            (1, "Power", "ID=100h\n"),
            (2, "Heat", ""),
            (3, "Power", ""),
        )
    )
    path = tmp_path / "status.sym"
    path.write_text(
        'FormatVersion=6.0 // Do not edit this line!\nTitle="Status"\n\n{ENUMS}\n'
        'Enum=Power(0="off", 1="on")\nEnum=Heat(0="cold", 1="hot")\n\n{SENDRECEIVE}\n\n'
        + pages
    )
    read = run.read(path, can.Sym())
    names = {
        enum["name"]: [member["name"] for member in enum["members"]]
        for enum in tree_of(read)["enums"]
    }
    assert [
        (field["name"], field["when"], names[field["enum"]])
        for field in message(read, "Status")["fields"]
        if "when" in field
    ] == [
        ("Mode", {"Page1": [1, 3]}, ["off", "on"]),
        ("Mode Page1 2", {"Page1": 2}, ["cold", "hot"]),
    ]
    assert [
        (finding.code, finding.severity) for finding in read.definitions.import_findings
    ] == [("IMP092", "note")]
    model(read, tmp_path)


KCD = """\
<NetworkDefinition xmlns="http://kayak.2codeornot2code.org/1.0">
  <Document name="Vehicle"/>
  <Node id="1" name="Engine"/>
  <Bus name="Drive" baudrate="500000">
    <Message id="0x100" name="Status" length="2" count="3">
      <Producer><NodeRef id="1"/></Producer>
      <Signal name="Level" offset="0" length="8">
        <LabelSet><Label name="Low" value="0"/><LabelGroup name="High" from="1" to="9"/></LabelSet>
      </Signal>
    </Message>
  </Bus>
</NetworkDefinition>
"""
SYM = """\
FormatVersion=6.0 // Do not edit this line!
Title="Vehicle"

{SENDRECEIVE}
[Status]
ID=100h
Len=8
Timeout=500
Var=Level unsigned 0,8 /u:"/x:" /d:3 // "was" /h:2 /e:
Var=Serial string 8,32 /ln:"serial number"
"""
ARXML = """\
<?xml version="1.0" encoding="UTF-8"?>
<AUTOSAR xmlns="http://autosar.org/schema/r4.0">
  <AR-PACKAGES>
    <AR-PACKAGE>
      <SHORT-NAME>Vehicle</SHORT-NAME>
      <ELEMENTS>
        <SYSTEM><SHORT-NAME>Car</SHORT-NAME></SYSTEM>
        <LIN-CLUSTER><SHORT-NAME>Doors</SHORT-NAME></LIN-CLUSTER>
      </ELEMENTS>
    </AR-PACKAGE>
  </AR-PACKAGES>
</AUTOSAR>
"""


@pytest.mark.parametrize(
    ("reader", "text", "unused"),
    [
        (
            can.Kcd(),
            KCD,
            [
                ("`baudrate` of `Bus` is not used (`Drive`)", 4),
                ("`count` of `Message` is not used (`Status`)", 5),
                ("`LabelGroup` of `LabelSet` is not used", 8),
            ],
        ),
        (
            can.Sym(),
            SYM,
            [
                ("`Timeout` is not used (`Status`)", 8),
                ("`/d:` of `Var` is not used (`Status`)", 9),
                ("`/ln:` of `Var` is not used (`Status`)", 10),
                ("`type string` of `Var` is not used (`Status`)", 10),
            ],
        ),
        (
            can.Arxml(),
            ARXML,
            [("`LIN-CLUSTER` of `ELEMENTS` is not used (`Doors`)", 8)],
        ),
    ],
    ids=["kcd", "sym", "arxml"],
)
def test_what_cantools_drops_of_a_file_is_reported(reader, text, unused):
    definitions = reader.read("vehicle", text.encode())
    findings = [
        (finding.message, finding.spot.line)
        for finding in definitions.import_findings
        if finding.code == "IMP085"
    ]
    assert [finding for finding in findings if finding[1] is not None] == unused
