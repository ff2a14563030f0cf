"""Electronic data sheets become ICDs: messages of components, packages in neighbouring
files, and values that design parameters define.

A reader of bits in tests/devices compares the values of random frames.
"""

from __future__ import annotations

import shutil

import pytest

from icdgen import codec
from icdgen.definitions import eds, eds_interfaces, eds_sheets, eds_types, kinds, run
from icdgen.diagnostics import Findings
from icdgen.icd.fmt import emit
from icdgen.icd.load import load
from tests.definitions.test_can import FILES, field, message
from tests.importer.test_command import icdgen

SHEETS = FILES / "eds"


@pytest.fixture(scope="module")
def camera():
    return imported("camera.xml")


@pytest.fixture(scope="module")
def gyro():
    return imported("gyro.xml")


def imported(name, folder=SHEETS):
    reader = kinds.reader_of_file(folder / name)
    assert isinstance(reader, eds.Eds)
    return run.read(folder / name, reader)


def findings_of(read):
    return [
        (finding.code, finding.message) for finding in read.definitions.import_findings
    ]


def test_interfaces_define_the_messages_and_their_direction(camera):
    (tree,) = camera.trees.values()
    assert [(message["name"], message["kind"]) for message in tree["messages"]] == [
        ("Housekeeping", "telemetry"), ("Picture", "telemetry"), ("Noop", "telecommand"), ("Shoot", "telecommand"),
    ]  # fmt: skip
    assert ("IMP084", "no interface carries 1 container: `Settings`") in findings_of(
        camera
    ) and not camera.failed


def test_the_header_of_space_packets_in_another_file_is_the_header_of_packets(camera):
    (tree,) = camera.trees.values()
    header = tree["protocol"]["link"]["header"]
    assert [(field["bits"], field["role"]) for field in header] == [
        (3, "constant"), (1, "constant"), (1, "flags"), (11, "id"), (2, "type"), (14, "sequence"), (16, "length"),
    ]  # fmt: skip
    assert (
        header[2]["value"] == {"telecommand": 1, "telemetry": 1}
        and tree["node"]["id_bits"] == 11
    )
    assert (
        message(camera, "Noop")["length"] == 2
        and field(camera, "Housekeeping", "Time")["at"] == 0
    )


def test_ids_are_application_processes_or_topics(camera):
    assert [
        message(camera, name)["id"]
        for name in ("Picture", "Housekeeping", "Noop", "Shoot")
    ] == [300, 20, 10, 10]
    assert [field(camera, name, "Code")["const"] for name in ("Noop", "Shoot")] == [
        0,
        1,
    ]
    (process,) = [
        finding
        for finding in camera.definitions.import_findings
        if finding.code == "IMP083"
    ]
    assert (
        process.message
        == "no application process is stated for 3 messages, only `TopicId` of their interfaces"
    )


@pytest.mark.parametrize(
    ("topic", "id"),
    [("3", 2 ^ 0x60), ("${CFE_MISSION/TELECOMMAND_BASE_TOPICID} + 255", 255)],
)
def test_topics_become_application_processes_like_in_cfs(tmp_path, topic, id):
    folder = copied(
        tmp_path, "mission.xml", "${CFE_MISSION/TELECOMMAND_BASE_TOPICID} + 010", topic
    )
    assert message(imported("camera.xml", folder), "Noop")["id"] == id


def test_a_parameter_other_than_a_topic_is_the_application_process(tmp_path):
    attributes = 'parameter="{}" variableRef="Commands"'
    folder = copied(
        tmp_path, "camera.xml", attributes.format("TopicId"), attributes.format("MsgId")
    )
    text = (folder / "mission.xml").read_text()
    (folder / "mission.xml").write_text(
        text.replace("${CFE_MISSION/TELECOMMAND_BASE_TOPICID} + 010", "0x1880")
    )
    assert message(imported("camera.xml", folder), "Noop")["id"] == 0x80


def test_a_container_that_interfaces_carry_by_several_numbers_is_as_many_messages(
    tmp_path,
):
    interface = '<Interface name="{}" type="LINK/PACKETS/Out">'
    folder = copied(
        tmp_path, "camera.xml", interface.format("PICTURES"), interface.format("MORE")
    )
    text = (
        (folder / "camera.xml")
        .read_text()
        .replace('name="Data" type="Picture"', 'name="Data" type="Housekeeping"')
    )
    end = '<ParameterMap interface="MORE" parameter="TopicId" variableRef="Commands"/></ParameterMapSet>'
    (folder / "camera.xml").write_text(text.replace("</ParameterMapSet>", end))
    read = imported("camera.xml", folder)
    assert [
        message(read, name)["id"] for name in ("Housekeeping HK", "Housekeeping MORE")
    ] == [20, 19]


def test_field_names_are_unique_and_containers_in_arrays_become_structs(
    camera,
):
    (tree,) = camera.trees.values()
    assert [field["name"] for field in message(camera, "Housekeeping")["fields"]] == [
        "Time", "Mode", "Ready", "Shutter", "Exposure", "Front Lens", "Front Sensor", "Back Lens", "Back Sensor", "Peaks", "Matrix",
    ]  # fmt: skip
    (peak,) = tree["structs"]
    assert (
        peak["name"],
        peak["length"],
        [field["name"] for field in peak["fields"]],
    ) == (
        "Peak",
        5,
        ["Row", "Column", "Level"],
    )
    assert field(camera, "Housekeeping", "Peaks") == {
        "at": 136,
        "name": "Peaks",
        "struct": "Peak",
        "count": 3,
    }
    assert field(camera, "Housekeeping", "Matrix")["count"] == 6  # three rows of two


def test_units_ranges_and_calibrations_arrive(camera):
    exposure = field(camera, "Shoot", "Exposure")
    assert {key: exposure[key] for key in ("unit", "min", "max")} == {
        "unit": "ms",
        "min": 1,
        "max": 5000,
    }
    assert field(camera, "Housekeeping", "Front Lens")["formula"] == "raw*0.01 - 20"
    sensor = field(camera, "Housekeeping", "Back Sensor")
    assert (sensor["unit"], sensor["points"][2], sensor["outside"]) == (
        "C",
        [400, 125.5],
        "extrapolate",
    )
    assert message(camera, "Picture")["summary"] == "A piece of a picture."


def test_a_list_is_a_variable_length_array_with_its_counter(camera):
    assert field(camera, "Picture", "Piece") == {
        "at": 64, "name": "Piece", "struct": "Peak", "count": "Pieces", "up_to": 20,
    }  # fmt: skip
    log = imported("log.xml")
    assert field(log, "Note", "Words")["size"] == {"field": "Length", "plus": -5}
    assert (
        field(log, "Values", "Value")["up_to"] == 255
        and field(log, "Dump", "Block")["type"] == "bytes"
    )


def test_the_entries_of_a_base_container_surround_those_of_the_derived_one(gyro):
    names = [field["name"] for field in message(gyro, "Serial")["fields"]]
    assert (names[0], names[-1]) == ("Mark", "Crc") and field(gyro, "Serial", "Crc")[
        "at"
    ] == 168
    assert (message(gyro, "State")["id"], message(gyro, "Serial")["id"]) == (16, 17)
    assert field(gyro, "State", "Mark")["const"] == int.from_bytes(b"GYR1", "big")


def test_the_length_of_a_container_is_a_constant_where_it_is_always_the_same(gyro):
    assert field(gyro, "State", "Bits")["const"] == 8 * (
        message(gyro, "State")["length"] - 7
    )
    assert "const" not in field(imported("log.xml"), "Note", "Length")


def test_unsupported_encodings_are_imported_raw_with_a_finding_and_named_values(
    gyro,
):
    raw = {
        name: field(gyro, "State", name)["type"]
        for name in ("Offset", "Scale", "Drift")
    }
    assert raw == {"Offset": "uint", "Scale": "uint", "Drift": "int"}
    texts = [text for code, text in findings_of(gyro) if code == "IMP078"]
    assert "`Offset` (message `State`): it is encoded as onesComplement" in texts
    assert "`Number` (message `Serial`): it is encoded as packedBCD" in texts
    enums = {
        enum["name"]: [member["value"] for member in enum["members"]]
        for enum in gyro.trees["gyro"]["enums"]
    }
    assert enums == {"Sign": [0, 1, 129], "Trend": [-1, 1], "Wide": [0, 1]}
    assert field(gyro, "Serial", "Revision")["const"] == -3


def test_an_error_control_is_a_field_and_unsupported_parts_are_reported_with_their_line(
    gyro,
):
    assert field(gyro, "State", "Crc")["summary"] == "CRC16_CCITT."
    assert ("IMP082", "`Crc` is CRC16_CCITT of what is in the frame") in findings_of(
        gyro
    )
    (missing,) = [
        finding
        for finding in gyro.definitions.import_findings
        if finding.severity == "error"
    ]
    why = "`Extra` is present only on a condition"
    assert (
        missing.message
        == f"message `Sometimes`: from `Extra` on only bytes are imported: {why}"
    )
    lines = (SHEETS / "gyro.xml").read_text().splitlines()
    assert 'name="Sometimes"' in lines[missing.spot.line - 1]


def copied(folder, name, old="", new=""):
    """Copy the data sheets with a replacement in one of them."""
    copy = folder / "sheets"
    shutil.copytree(SHEETS, copy)
    text = (copy / name).read_text()
    assert old in text
    (copy / name).write_text(text.replace(old, new))
    return copy


def test_an_undefined_value_removes_the_objects_that_use_it(tmp_path):
    folder = copied(
        tmp_path, "mission.xml", '<Define name="NAME_LENGTH" value="${WORD} + 4"/>', ""
    )
    read = imported("camera.xml", folder)
    why = "no file in the folder defines `${MISSION/NAME_LENGTH}`"
    assert (
        "IMP081",
        f"message `Shoot`: from `File` on only bytes are imported: {why}",
    ) in findings_of(read)
    assert (
        read.imported == 4 and message(read, "Shoot")["fields"][-1]["type"] == "bytes"
    )
    (folder / "mission.xml").unlink()
    assert "no file in the folder defines `${MISSION/HEADER}`" in why_not(
        "camera.xml", folder
    )


def test_a_missing_package_is_reported(tmp_path):
    folder = copied(tmp_path, "packets.xml")
    (folder / "packets.xml").unlink()
    reason = why_not("camera.xml", folder)
    assert (
        "is of the package `LINK/PACKETS`, which is neither in the file nor in its folder"
        in reason
    )


def test_a_duplicate_package_or_value_is_reported_once(tmp_path):
    folder = copied(tmp_path, "packets.xml")
    shutil.copy(folder / "packets.xml", folder / "packets_old.xml")
    text = (
        (folder / "mission.xml")
        .read_text()
        .replace('name="PEAKS" value="2 ^ 2 - 1"', 'name="PEAKS" value="9"')
    )
    (folder / "mission_old.xml").write_text(text)
    read = imported("camera.xml", folder)
    assert [text for code, text in findings_of(read) if code == "IMP076"] == [
        "package `LINK/PACKETS` is in `packets.xml` and otherwise in `packets_old.xml`",
        "`${MISSION/PEAKS}` is in `mission.xml` and otherwise in `mission_old.xml`",
    ]
    assert field(read, "Housekeeping", "Peaks")["count"] == 3


def test_packets_of_another_version_have_it_in_their_header(tmp_path):
    folder = copied(
        tmp_path,
        "packets.xml",
        'entry="Version" value="0"',
        'entry="Version" value="1"',
    )
    header = imported("camera.xml", folder).trees["camera"]["protocol"]["link"][
        "header"
    ]
    assert header[0] == {"bits": 3, "role": "constant", "value": 1}


BYTE = '<IntegerDataType name="byte"><IntegerDataEncoding sizeInBits="8" encoding="unsigned"/></IntegerDataType>'
WORD = BYTE.replace('"byte"', '"w"').replace('"8"', '"16"')
ENTRY = '<Entry name="P" type="byte"/>'


def container(name, entries=ENTRY, more="", **attributes):
    attribute_text = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return f'<ContainerDataType name="{name}"{attribute_text}>{more}<EntryList>{entries}</EntryList></ContainerDataType>'


def sheet(types, byte=BYTE):
    return (
        '<PackageFile xmlns="http://www.ccsds.org/schema/sois/seds"><Package name="S"><DataTypeSet>'
        f"{byte}{types}</DataTypeSet></Package></PackageFile>"
    )


def entry(type_, name="Q", tag="Entry", inner="", more=""):
    return f'<{tag} name="{name}" type="{type_}"{more}>{inner}</{tag}>'


def array(name, of, size):
    return f'<ArrayDataType name="{name}" dataTypeRef="{of}"><DimensionList><Dimension {size}/></DimensionList></ArrayDataType>'


def constrained(constraint):
    return container("B") + container(
        "A", "", f"<ConstraintSet>{constraint}</ConstraintSet>", baseType="B"
    )


SEVERAL = "<EnumeratedRange><Label>A</Label><Label>B</Label></EnumeratedRange>"


def nested(depth, times):
    return "".join(
        container(f"C{n}", "".join(entry(f"C{n + 1}", f"E{k}") for k in range(times)))
        for n in range(depth)
    )


FLOAT = '<FloatDataType name="f"><FloatDataEncoding sizeInBits="32" encodingAndPrecision="IEEE754_2008_single"/></FloatDataType>'
OPEN = '<StringDataType name="open" length="9" fixedLength="false"{}</StringDataType>'


@pytest.mark.parametrize(
    ("types", "says"),
    [
        (container("A", baseType="A"), "based on each other in a circle, or too deep: A -> A"),
        (container("A", baseType="B") + container("B", baseType="A"), "in a circle, or too deep: A -> B -> A"),
        (container("A", entry("A")) + container("B", baseType="A"), "contain each other in a circle, or too deep: A -> A"),
        (container("A", entry("x/y/nothing")), "of the package `x/y`, which is neither in the file nor in its folder"),
        (container("A", entry("nothing")), "there is no type `nothing`"),
        (container("A", baseType="byte"), "it is based on `byte`, which is not a container"),
        (container("A", ENTRY, abstract="true") + container("B", entry("A")), "`Q` is any container that is based on `A`"),
        (container("A", "<SegmentEntry/>"), "it has a `SegmentEntry`"),
        (container("A", ENTRY * 5001), "it has more than 5000 fields or 65535 bytes"),
        (container("A", '<PaddingEntry sizeInBits="2 ^ 60"/>'), "the size of a padding is `2 ^ 60`"),
        (array("many", "byte", 'size="99999999999"') + container("A", entry("many")), "a dimension of `Q` is `99999999999`"),
        (array("many", "many", 'size="2"') + container("A", entry("many")), "`Q` is an array of "),
        (array("wide", "w", 'size="2000"') + WORD + container("A", entry("wide")), "`Q` is an array of 2,000 elements"),
        (array("many", "byte", 'indexTypeRef="byte"') + container("A", entry("many")), "how many elements `Q` has"),
        (array("odd", "I", 'size="2"') + container("I", '<PaddingEntry sizeInBits="4"/>') + container("A", entry("odd")),
         "`Q` is an array of containers of different or partial bytes"),
        (OPEN.format(">") + container("A", entry("open") + ENTRY), "`P` follows `Q`, whose length is not fixed"),
        (OPEN.format('><StringDataEncoding terminationCharacter="0"/>') + container("A", entry("open")),
         "`open` ends at the character `0`"),
        (container("A", entry("byte", tag="ListEntry", more=' listLengthField="N"')),
         "`Q` is there as often as `N` says, which is not a number"),
        (container("A", entry("byte", tag="FixedValueEntry", more=' fixedValue="256"')), "`Q` is never `256`"),
        (constrained('<ValueConstraint entry="X.Y" value="1"/>'), "it depends on `X.Y`, but it has no such field"),
        (constrained('<ValueConstraint entry="P" value="-1"/>'), "it depends on `P`, which is never `-1`"),
        (constrained('<ValueConstraint entry="P" value="1"/><ValueConstraint entry="P" value="2"/>'), "is both 1 and 2"),
        (constrained(f'<RangeConstraint entry="P">{SEVERAL}</RangeConstraint>'), "`P`, which has one of several values"),
        (constrained('<SizeConstraint entry="P"/>'), "it is constrained by a `SizeConstraint`"),
        (FLOAT + container("A", entry("f", tag="FixedValueEntry", more=' fixedValue="1.5"'))
         + container("C", "", '<ConstraintSet><ValueConstraint entry="Q" value="1"/></ConstraintSet>', baseType="A"),
         "has a value and is of the type float"),
        (nested(20, 3) + container("C20", ENTRY), "it has more than 5000 fields or 65535 bytes"),
        (nested(40, 1) + container("C40", ENTRY), "containers contain each other in a circle, or too deep"),
    ],
)  # fmt: skip
def test_unsupported_and_recursive_containers_are_left_out(types, says, tmp_path):
    assert says in refused(sheet(types), tmp_path)


def ranged(kind, calibration=""):
    """Return a sheet with a byte and a 32-bit float of a range, in one container."""
    range = f'<Range><MinMaxRange rangeType="{kind}" min="1" max="9.5"/></Range>'
    types = (
        BYTE.replace('"byte"', '"B"').replace("</Integer", f"{range}</Integer")
        + FLOAT.replace("</FloatDataType", f"{range}</FloatDataType")
        + container(
            "A", "".join(entry(of, of.upper(), inner=calibration) for of in "Bf")
        )
    )
    return sheet(types)


def limits_of(read):
    """Return the limits of the byte and of the float."""
    return [
        {
            key: field(read, "A", name).get(key)
            for key in ("min", "max", "above", "below")
        }
        for name in "BF"
    ]


def limits(min=None, max=None, above=None, below=None):
    return {"min": min, "max": max, "above": above, "below": below}


@pytest.mark.parametrize(
    ("kind", "of_byte", "of_float"),
    [
        ("inclusiveMinInclusiveMax", limits(1, 9), limits(1, 9.5)),
        ("inclusiveMinExclusiveMax", limits(1, 9), limits(1, below=9.5)),
        ("exclusiveMinInclusiveMax", limits(2, 9), limits(max=9.5, above=1)),
        ("exclusiveMinExclusiveMax", limits(2, 9), limits(above=1, below=9.5)),
        ("atLeast", limits(1), limits(1)),
        ("greaterThan", limits(2), limits(above=1)),
        ("atMost", limits(max=9), limits(max=9.5)),
        ("lessThan", limits(max=9), limits(below=9.5)),
    ],
)
def test_ranges_become_limits_of_numbers_without_a_calibration(
    kind, of_byte, of_float, tmp_path
):
    calibration = '<PolynomialCalibrator><Term coefficient="0.5" exponent="1"/></PolynomialCalibrator>'
    file = tmp_path / "one.xml"
    file.write_text(ranged(kind))
    assert limits_of(run.read(file, eds.Eds())) == [of_byte, of_float]
    # The range is about raw values, limits of an ICD about physical ones.
    file.write_text(ranged(kind, calibration))
    read = run.read(file, eds.Eds())
    assert limits_of(read) == [limits(), limits()]
    assert field(read, "A", "B")["formula"] == "raw*0.5"


LONG = '<IntegerDataType name="long"><IntegerDataEncoding sizeInBits="16" byteOrder="littleEndian"/></IntegerDataType>'


def test_an_error_control_after_a_list_is_imported(tmp_path):
    entries = (
        ENTRY
        + '<ListEntry name="L" type="long" listLengthField="P"/>'
        + '<Entry name="M" type="byte"/>'
        + '<ErrorControlEntry name="CRC" type="long" errorControlType="CRC16_CCITT"/>'
    )
    (tmp_path / "one.xml").write_text(sheet(LONG + container("A", entries)))
    read = run.read(tmp_path / "one.xml", eds.Eds())
    (tree,) = read.trees.values()
    (tmp_path / "one.yaml").write_text(emit.canonical_yaml(tree))
    loaded = load([tmp_path / "one.yaml"])
    assert loaded.ok, loaded.findings
    (node,) = loaded.icd.nodes
    (message,) = node.messages
    frame = bytes.fromhex("02 0100 0200 07 3412")
    raw = codec.decode_frame(node, message, frame)
    assert (raw["L[1]"], raw["M"], raw["CRC"]) == (2, 7, 0x1234)


def integer(encoding):
    return f'<IntegerDataType name="byte"><IntegerDataEncoding {encoding}/></IntegerDataType>'


@pytest.mark.parametrize(
    ("byte", "says"),
    [
        ('<IntegerDataType name="byte"/>', "`P` has a type without an encoding"),
        (integer('sizeInBits="1e9"'), "the size of `P` is `1e9`"),
        (integer('sizeInBits="8" encoding="gray"'), "its `encoding` is `gray`"),
        (integer('sizeInBits="12" byteOrder="littleEndian"'), "byte of `P`, of 12 bits, is sent first"),
        (integer('sizeInBits="99"'), "`P` has 99 bits"),
        ('<FloatDataType name="byte"/>', "`P` has a type without an encoding"),
        ('<SubRangeDataType name="byte" baseType="byte"/>', "the type `byte` is based on itself"),
        ('<StringDataType name="byte" length="0"/>', "the length of a text is `0`"),
        ('<BooleanDataType name="byte"><BooleanDataEncoding sizeInBits="65"/></BooleanDataType>', "the flag `byte` has 65 bits"),
        ('<CoolDataType name="byte"/>', "`P` is a `CoolDataType`"),
        ('<EnumeratedDataType name="byte"><IntegerDataEncoding sizeInBits="2"/><EnumerationList><Enumeration label="A" value="4"/>'
         "</EnumerationList></EnumeratedDataType>", "`P` never has the value `4` of `A`"),
    ],
)  # fmt: skip
def test_unsupported_types_are_reported(byte, says, tmp_path):
    assert says in refused(sheet(container("A"), byte), tmp_path)


BOMB = (
    "<!DOCTYPE x ["
    + "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))
    + '<!ENTITY e0 "ha">]>'
)
ITSELF = '<Define name="A" value="${B}"/><Define name="B" value="${A}"/>'
GROWS = '<Define name="A0" value="word word word word"/>' + "".join(
    f'<Define name="A{n}" value="{f"${{A{n - 1}}} " * 10}"/>' for n in range(1, 15)
)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (BOMB + sheet(container("A", entry("&e9;"))), "the XML has a document type"),
        (sheet(container("A"))[:-20], "not XML: "),
        (sheet(container("A", abstract="true")), "no message can be imported, for none is defined"),
        (sheet(container("A", entry("${A}"))).replace("<DataTypeSet>", f"{ITSELF}<DataTypeSet>"), "` is defined by itself"),
        (sheet(container("A", entry("${A14}"))).replace("<DataTypeSet>", f"{GROWS}<DataTypeSet>"),
         "becomes longer than 2000 characters"),
    ],
)  # fmt: skip
def test_hostile_files_are_refused(text, says, tmp_path):
    assert says in refused(text, tmp_path)


def test_the_size_of_a_file_and_its_neighbours_is_limited(tmp_path, monkeypatch):
    monkeypatch.setattr(eds_types.EdsTypes, "most_steps", 100)
    assert "the file says more than 100 things" in refused(
        sheet(nested(5, 4) + container("C5", ENTRY)), tmp_path
    )
    monkeypatch.setattr(eds_interfaces, "MOST_STEPS", 3)
    assert "its interfaces carry more than 3 containers" in why_not(
        "camera.xml", SHEETS
    )
    monkeypatch.setattr(eds_sheets, "MOST_FILES", 1)
    for name in ("b.xml", "c.xml"):
        (tmp_path / name).write_text(sheet(""))
    assert "its folder has more than 1 data sheets" in refused(
        sheet(container("A")), tmp_path
    )


def test_a_broken_neighbouring_file_is_named_and_other_files_are_ignored(
    tmp_path,
):
    (tmp_path / "other.xml").write_text("<other><unclosed></other>")
    (tmp_path / "good.xml").write_text(sheet(container("A")))
    assert run.read(tmp_path / "good.xml", eds.Eds()).imported == 1
    (tmp_path / "broken.xml").write_text(sheet("")[:-5])
    with pytest.raises(Findings) as raised:
        run.read(tmp_path / "good.xml", eds.Eds())
    assert raised.value.findings[0].place.file.endswith("broken.xml")


def refused(text, folder):
    (folder / "bad.xml").write_text(text)
    return why_not("bad.xml", folder)


def why_not(name, folder):
    with pytest.raises(Findings) as raised:
        run.read(folder / name, eds.Eds())
    (finding,) = raised.value.findings
    assert finding.code == "IMP005"
    return finding.message


def test_a_container_may_contain_another_with_the_same_base(tmp_path):
    inner = container("I", entry("byte", "R"), baseType="X")
    (tmp_path / "one.xml").write_text(
        sheet(
            container("X", abstract="true")
            + inner
            + container("A", entry("I"), baseType="X")
        )
    )
    fields = message(run.read(tmp_path / "one.xml", eds.Eds()), "A")["fields"]
    assert [field["name"] for field in fields] == ["P", "Q P", "R"]


def test_an_id_at_the_start_of_all_messages_is_the_header(tmp_path):
    constraint = (
        '<ConstraintSet><ValueConstraint entry="P" value="{}"/></ConstraintSet>'
    )
    types = "".join(
        container(name, entry("byte", "R"), constraint.format(id), baseType="X")
        for name, id in (("A", 7), ("B", 9))
    )
    (tmp_path / "ids.xml").write_text(sheet(container("X", abstract="true") + types))
    (tree,) = run.read(tmp_path / "ids.xml", eds.Eds()).trees.values()
    assert tree["protocol"]["link"]["header"] == [{"bits": 8, "role": "id"}]
    assert [
        (message["id"], message["length"], message["fields"][0]["name"])
        for message in tree["messages"]
    ] == [
        (7, 1, "R"),
        (9, 1, "R"),
    ]


def test_messages_without_a_discriminator_get_numbers_and_a_finding(tmp_path):
    (tmp_path / "two.xml").write_text(sheet(container("A") + container("B")))
    read = run.read(tmp_path / "two.xml", eds.Eds())
    assert [
        (message["name"], message["id"]) for message in read.trees["two"]["messages"]
    ] == [
        ("A", 1),
        ("B", 2),
    ]
    assert findings_of(read) == [
        ("IMP079", "no parameter tells all 2 messages of telemetry: `A`, `B`")
    ]


def test_the_command_imports_data_sheets_and_prints_the_findings(tmp_path):
    result = icdgen("import", str(SHEETS / "camera.xml"), "--out", "icd", cwd=tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    assert (
        "camera.xml: an electronic data sheet (CCSDS SOIS), 4 of 4 messages imported\n"
        in result.stdout
    )
    assert result.stdout.endswith("`icdgen check icd/camera.yaml`: no findings\n")
    assert icdgen("fmt", "--check", "icd", cwd=tmp_path).returncode == 0
