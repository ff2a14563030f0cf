"""XTCE becomes ICDs: space packets with their header, inheritance, discriminators, and
commands.

tests/devices compares the values of random packets with space-packet-parser.
"""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.definitions import kinds, run, xtce, xtce_types
from icdgen.diagnostics import Findings
from icdgen.icd.fmt import emit
from icdgen.icd.load import load
from tests.definitions.test_can import FILES, field, message

END = "</xtce:ContainerSet></xtce:TelemetryMetaData></xtce:SpaceSystem>"
SPACE = "http://www.omg.org/spec/XTCE/20180204"


@pytest.fixture(scope="module")
def probe():
    return imported("probe.xml")


@pytest.fixture(scope="module")
def lander():
    return imported("lander.xml")


def imported(name):
    reader = kinds.reader_of_file(FILES / name)
    assert isinstance(reader, xtce.Xtce)
    return run.read(FILES / name, reader)


def test_the_primary_header_is_that_of_packets_and_the_application_process_the_id(
    probe,
):
    (tree,) = probe.trees.values()
    header = tree["protocol"]["link"]["header"]
    assert [(field["bits"], field["role"]) for field in header] == [
        (3, "constant"), (1, "constant"), (1, "flags"), (11, "id"), (2, "type"), (14, "sequence"), (16, "length"),
    ]  # fmt: skip
    assert (
        tree["node"]["id_bits"],
        [message["id"] for message in tree["messages"]],
    ) == (
        11,
        [100, 100, 101],
    )


def test_header_values_common_to_a_direction_are_sent(tmp_path):
    comparisons = '<xtce:Comparison parameterRef="SECONDARY" value="1"/><xtce:Comparison parameterRef="APID" value="100"'
    text = (
        (FILES / "probe.xml")
        .read_text()
        .replace('<xtce:Comparison parameterRef="APID" value="100"', comparisons)
    )
    (tmp_path / "probe.xml").write_text(
        text.replace(
            text[text.index('      <xtce:SequenceContainer name="Dumped"') :], END
        )
    )
    read = run.read(tmp_path / "probe.xml", xtce.Xtce())
    header = read.trees["probe"]["protocol"]["link"]["header"]
    assert read.imported == 2 and header[2]["value"] == {
        "telecommand": 0,
        "telemetry": 1,
    }


def test_a_derived_container_has_the_fields_of_its_base_and_its_discriminator(probe):
    assert [field["name"] for field in message(probe, "Housekeeping")["fields"]] == [
        "Time",
        "Mode",
        "Valid",
        "Spare",
    ]
    assert (
        "const" not in field(probe, "Housekeeping", "Mode")
        and field(probe, "Safe", "Mode")["const"] == 5
    )
    assert (
        field(probe, "Safe", "Mode")["enum"] == "Mode"
        and field(probe, "Safe", "Key")["at"] == 176
    )


def test_calibrations_are_formulas_or_tables(probe):
    fields = {
        name: field(probe, "Safe", name)
        for name in ("Temperature", "Pressure", "Level", "Curve", "Rate")
    }
    assert (
        fields["Temperature"]["formula"] == "raw*0.0125 - 40.5"
        and fields["Temperature"]["below"] == 85.5
    )
    assert fields["Pressure"]["formula"] == "raw^2*0.0002 - raw*0.5 + 3"
    assert (
        fields["Level"]["formula"] == "raw*5/12 - 5/2"
        and fields["Rate"]["unit"] == "deg/s"
    )
    assert (
        fields["Curve"]["points"] == [[0.5, "-1e-9"], [10, 5], [90, 6]]
        and fields["Curve"]["unit"] == "V"
    )
    assert (
        fields["Curve"]["outside"] == "refuse"
        and probe.definitions.import_findings == []
    )


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (
            'order="1">',
            'order="0">',
            "it is calibrated by a table of 3 points that are not joined by lines",
        ),
        (
            'raw="0.5"',
            'raw="90"',
            "it is calibrated by a table that cannot be used: raw value 90 occurs twice: list points",
        ),
        ('calibrated="-1e-9"', 'calibrated="much"', "a coefficient is `much`"),
    ],
)
def test_an_unsupported_calibration_is_imported_raw_with_a_finding(
    tmp_path, old, new, why
):
    text = (FILES / "probe.xml").read_text()
    assert text.count(old) == 1
    (tmp_path / "probe.xml").write_text(text.replace(old, new))
    read = run.read(tmp_path / "probe.xml", xtce.Xtce())
    curve = field(read, "Safe", "Curve")
    assert curve.keys().isdisjoint(("points", "outside", "formula", "unit"))
    (import_finding,) = read.definitions.import_findings
    assert import_finding.code == "IMP078" and import_finding.message.startswith(
        f"`Curve` (message `Safe`): {why}"
    )


def test_bytes_with_a_transmitted_size_extend_to_the_end_of_the_packet(probe):
    dump = field(probe, "Dumped", "Dump")
    assert (dump["at"], dump["size"], dump["up_to"], "bits" in dump) == (
        40,
        "rest",
        65_530,
        False,
    )


def test_without_a_packet_header_the_id_is_the_common_discriminator(lander):
    (tree,) = lander.trees.values()
    assert "protocol" not in tree
    assert [(message["name"], message["id"], message["kind"]) for message in tree["messages"]] == [
        ("Power", 7, "telemetry"), ("Clock", 8, "telemetry"), ("Places", 9, "telemetry"), ("Arm Power", 10, "telemetry"),
        ("Stretch", 3, "telecommand"), ("Stop", 4, "telecommand"),
    ]  # fmt: skip


def test_arrays_aggregates_flags_and_times_of_1_1_arrive(lander):
    assert field(lander, "Power", "Cells") | {"summary": ""} == {
        "at": 8, "bits": 16, "name": "Cells", "type": "int", "count": 3, "unit": "mV", "byte_order": "little",
        "summary": "",
    }  # fmt: skip
    assert [
        field(lander, "Arm Power", name)["at"] for name in ("Wind x", "Wind y")
    ] == [8, 24]
    assert (
        field(lander, "Power", "At")["formula"] == "raw*0.001 + 10"
        and field(lander, "Power", "Door")["enum"] == "Door"
    )
    assert (
        field(lander, "Places", "Low")["at"] == 40
        and field(lander, "Places", "Door")["view"] is True
    )


def test_commands_have_the_arguments_of_their_base_with_the_values_that_they_give_them(
    lander,
):
    stretch = message(lander, "Stretch")
    assert (stretch["length"], stretch["hazard"], stretch["group"]) == (
        11,
        "It may hit the mast.",
        "Arm",
    )
    assert [(field["name"], field.get("const")) for field in stretch["fields"]] == [
        ("sync", 0xEB90), ("opcode", 3), ("angle", None),
    ]  # fmt: skip
    assert {key: field(lander, "Stretch", "angle")[key] for key in ("type", "bits", "min", "max")} == {
        "type": "float", "bits": 64, "min": -90, "max": 90,
    }  # fmt: skip


def test_raw_fields_are_reported_with_the_reason(lander):
    assert [
        finding.message
        for finding in lander.definitions.import_findings
        if finding.code == "IMP078"
    ] == ["`Digits` (message `Clock`): an integer is encoded as `BCD`"]


BYTE = '<IntegerParameterType name="byte"><IntegerDataEncoding/></IntegerParameterType>'
FLOAT16 = '<FloatParameterType name="byte"><FloatDataEncoding sizeInBits="16"/></FloatParameterType>'
ENTRY = '<ParameterRefEntry parameterRef="P"/>'


def container(name: str, entries: str = ENTRY, base: str = "", of: str = "") -> str:
    inherits = (
        f'<BaseContainer containerRef="{base}">{of}</BaseContainer>' if base else ""
    )
    return f'<SequenceContainer name="{name}"><EntryList>{entries}</EntryList>{inherits}</SequenceContainer>'


def system(containers: str, types: str = BYTE, more: str = "") -> str:
    return (
        f'<SpaceSystem name="S" xmlns="{SPACE}"><TelemetryMetaData><ParameterTypeSet>{types}</ParameterTypeSet><ParameterSet>'
        f'<Parameter name="P" parameterTypeRef="byte"/></ParameterSet><ContainerSet>{containers}</ContainerSet>'
        f"</TelemetryMetaData>{more}</SpaceSystem>"
    )


def entry(inner: str) -> str:
    return f'<ParameterRefEntry parameterRef="P">{inner}</ParameterRefEntry>'


def type_(kind: str, inner: str) -> str:
    return f'<{kind}ParameterType name="byte">{inner}</{kind}ParameterType>'


INCLUDED = '<ContainerRefEntry containerRef="{}"/>'
NO_SIZE = '<StringDataEncoding><SizeInBits><LeadingSize sizeInBitsOfSizeTag="8"/></SizeInBits></StringDataEncoding>'
LABELS = '<IntegerDataEncoding/><EnumerationList><Enumeration value="0" maxValue="99999999999" label="A"/></EnumerationList>'
MANY = "<RepeatEntry><Count><FixedValue>99999</FixedValue></Count></RepeatEntry>"
ITSELF = '<MemberList><Member name="x" typeRef="byte"/></MemberList>'


def nested(depth: int, times: int) -> str:
    return "".join(
        container(f"C{n}", INCLUDED.format(f"C{n + 1}") * times) for n in range(depth)
    )


GREATER = '<RestrictionCriteria><Comparison parameterRef="P" value="1" comparisonOperator="&gt;"/></RestrictionCriteria>'
MASKED = "<RestrictionCriteria><CustomAlgorithm/></RestrictionCriteria>"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (container("A", base="A"), "in a circle: A -> A"),
        (container("A", base="B") + container("B", base="A"), "in a circle: A -> B -> A"),
        (container("A", INCLUDED.format("B"), "B") + container("B", INCLUDED.format("A")), "in a circle: A -> B -> A"),
        (container("A", base="nothing"), "there is no container `nothing`"),
        (container("A", '<ParameterRefEntry parameterRef="../../../etc"/>'), "there is no parameter `../../../etc`"),
        (container("A", '<ContainerSegmentRefEntry containerRef="A"/>'), "it has a `ContainerSegmentRefEntry`"),
        (container("B") + container("A", base="B", of=GREATER), "it depends on `P > 1`, which is not an equality"),
        (container("B") + container("A", base="B", of=MASKED), "it depends on a `CustomAlgorithm`"),
        (container("A", entry("<IncludeCondition/>")), "`P` is present only on a condition"),
        (container("A", entry(MANY)), "`P` is repeated 99999 times"),
        (container("A", ENTRY * 5001), "it has more than 5000 fields"),
        (nested(40, 2) + container("C40", ""), "the file says more than 1,000,000 things"),
        (nested(99, 1), "more than 50 containers inherit or contain each other"),
    ],
)  # fmt: skip
def test_unsupported_and_recursive_containers_are_left_out(
    text, says, tmp_path, monkeypatch
):
    most = xtce_types.XtceTypes.most_steps if "things" not in says else 20_000
    monkeypatch.setattr(xtce_types.XtceTypes, "most_steps", most)
    assert says.replace("1,000,000", "20,000") in refused(system(text), tmp_path)


def test_a_condition_is_on_the_value_of_a_repeated_parameter_that_was_sent_last(
    tmp_path,
):
    condition = (
        '<IncludeCondition><Comparison parameterRef="P" value="1"/></IncludeCondition>'
    )
    behind = '<LocationInContainerInBits referenceLocation="containerStart"><FixedValue>24</FixedValue></LocationInContainerInBits>'
    (tmp_path / "twice.xml").write_text(
        system(container("A", ENTRY * 2 + entry(condition) + entry(behind)))
    )
    read = run.read(tmp_path / "twice.xml", xtce.Xtce())
    assert [(field["at"], field["name"], field.get("when")) for field in message(read, "A")["fields"]] == [
        (0, "P", None), (8, "P 2", None), (16, "P 3", {"P 2": 1}), (24, "P 4", None),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("types", "says"),
    [
        (BYTE.replace('name="byte"', 'name="byte" baseType="byte"'), "the type `byte` is based on itself"),
        (BYTE.replace("Encoding", 'Encoding sizeInBits="1e9"'), "a size is `1e9`"),
        (BYTE.replace("Encoding", 'Encoding sizeInBits="999"'), "an integer has 999 bits"),
        ('<ArrayParameterType name="byte" arrayTypeRef="byte"/>', "an array of no dimensions"),
        (type_("Aggregate", ITSELF), "has members nested without end"),
        (type_("Enumerated", LABELS), "has a label for the values 0 to 99999999999"),
        (type_("String", NO_SIZE), "it has a length prefix"),
        ("<BinaryParameterType name='byte'/>", "the type `byte` has no encoding"),
    ],
)  # fmt: skip
def test_unsupported_and_recursive_types_are_reported(types, says, tmp_path):
    assert says in refused(system(container("A"), types), tmp_path)


@pytest.mark.parametrize(
    ("types", "bits", "says"),
    [
        (FLOAT16, 16, "a float has 16 bits"),
        (BYTE.replace("Encoding", 'Encoding bitOrder="leastSignificantBitFirst"'), 8, "its least significant bit is sent first"),
        (BYTE.replace("Encoding", 'Encoding sizeInBits="24" encoding="BCD"'), 24, "an integer is encoded as `BCD`"),
    ],
)  # fmt: skip
def test_a_number_of_known_size_and_unknown_encoding_is_imported_raw(
    types, bits, says, tmp_path
):
    (tmp_path / "a.xml").write_text(system(container("A"), types))
    read = run.read(tmp_path / "a.xml", xtce.Xtce())
    (import_finding,) = read.definitions.import_findings
    assert (import_finding.code, import_finding.message) == (
        "IMP078",
        f"`P` (message `A`): {says}",
    ) and "raw bits" in import_finding.help
    assert message(read, "A")["fields"] == [
        {"at": 0, "bits": bits, "name": "P", "type": "uint"}
    ]


def test_a_number_of_unknown_encoding_is_no_discriminator(tmp_path):
    of = '<RestrictionCriteria><Comparison parameterRef="P" value="12"/></RestrictionCriteria>'
    containers = container("A") + container("B", "", "A", of)
    why = refused(
        system(containers, BYTE.replace("Encoding", 'Encoding encoding="BCD"')),
        tmp_path,
    )
    assert (
        "message `B` is not imported: it depends on `P`, of which only the raw bits are imported"
        in why
    )


BOMB = (
    "<!DOCTYPE x ["
    + "".join(f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 10))
    + '<!ENTITY e0 "ha">]>'
)
OUTSIDE = '<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]>'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (BOMB + system(container("A")).replace('name="A"', 'name="&e9;"'), "the XML has a document type"),
        (OUTSIDE + system(container("A", "&e;")), "the XML has a document type"),
        ("<SpaceSystem>", "not XML: no element found"),
        (system("") , "no message can be imported, for none is defined"),
        ('<SpaceSystem name="a">' * 102 + "</SpaceSystem>" * 102, "more than 100 systems are nested"),
    ],
)  # fmt: skip
def test_hostile_files_are_refused(text, says, tmp_path):
    assert says in refused(text, tmp_path)


def refused(text, folder):
    (folder / "bad.xml").write_text(text)
    with pytest.raises(Findings) as raised:
        run.read(folder / "bad.xml", xtce.Xtce())
    (finding,) = raised.value.findings
    assert finding.code == "IMP005"
    return finding.message


def test_messages_without_a_discriminator_get_numbers_and_a_finding(tmp_path):
    (tmp_path / "two.xml").write_text(system(container("A") + container("B")))
    read = run.read(tmp_path / "two.xml", xtce.Xtce())
    assert [
        (message["name"], message["id"]) for message in read.trees["two"]["messages"]
    ] == [
        ("A", 1),
        ("B", 2),
    ]
    assert [
        (finding.code, finding.message) for finding in read.definitions.import_findings
    ] == [("IMP079", "no parameter tells all 2 messages of telemetry: `A`, `B`")]


def test_a_size_that_the_packet_transmits_is_ignored_with_a_finding(tmp_path):
    size = "<SizeInBits><DynamicValue><ParameterInstanceRef parameterRef='P'/></DynamicValue></SizeInBits>"
    types = f"{BYTE}<BinaryParameterType name='data'><BinaryDataEncoding>{size}</BinaryDataEncoding></BinaryParameterType>"
    text = system(
        container("A", f'{ENTRY}<ParameterRefEntry parameterRef="D"/>'), types
    )
    text = text.replace(
        "</ParameterSet>",
        '<Parameter name="D" parameterTypeRef="data"/></ParameterSet>',
    )
    (tmp_path / "one.xml").write_text(text)
    read = run.read(tmp_path / "one.xml", xtce.Xtce())
    assert [
        (finding.code, finding.message) for finding in read.definitions.import_findings
    ] == [("IMP080", "message `A`: `D` is as long as `P` says")]
    assert field(read, "A", "D") == {
        "at": 8,
        "name": "D",
        "type": "bytes",
        "size": "rest",
        "up_to": 65_534,
    }


def counted(dynamic, kind="array"):
    """Return a system whose message has a byte `P` and then an element that `P` counts."""
    if kind == "array":
        end = f"<StartingIndex><FixedValue>0</FixedValue></StartingIndex><EndingIndex>{dynamic}</EndingIndex>"
        dimensions = f"<DimensionList><Dimension>{end}</Dimension></DimensionList>"
        type_ = f"<ArrayParameterType name='data' arrayTypeRef='byte'>{dimensions}</ArrayParameterType>"
        entry = f'{ENTRY}<ArrayParameterRefEntry parameterRef="D"/>'
    else:
        encoding = f"<BinaryDataEncoding><SizeInBits>{dynamic}</SizeInBits></BinaryDataEncoding>"
        type_ = f"<BinaryParameterType name='data'>{encoding}</BinaryParameterType>"
        entry = f'{ENTRY}<ParameterRefEntry parameterRef="D"/>'
    text = system(container("A", entry), BYTE + type_)
    return text.replace(
        "</ParameterSet>",
        '<Parameter name="D" parameterTypeRef="data"/></ParameterSet>',
    )


def value(slope, intercept):
    adjusted = f"<LinearAdjustment slope='{slope}' intercept='{intercept}'/>"
    return f"<DynamicValue><ParameterInstanceRef parameterRef='P'/>{adjusted}</DynamicValue>"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            counted(value(1, -1)),
            {"bits": 8, "type": "uint", "count": "P", "up_to": 255},
        ),
        (
            counted(value(1, 1)),
            {
                "bits": 8,
                "type": "uint",
                "count": {"field": "P", "plus": 2},
                "up_to": 257,
            },
        ),
        (counted(value(8, 0), "bytes"), {"type": "bytes", "size": "P", "up_to": 255}),
        (
            counted(value("8.0", -32), "bytes"),
            {"type": "bytes", "size": {"field": "P", "plus": -4}, "up_to": 251},
        ),
        (
            counted(value(8, 4), "bytes"),
            {"type": "bytes", "size": "rest", "up_to": 65_534},
        ),
        (
            counted(value(8, -8 * 255), "bytes"),
            {"type": "bytes", "size": "rest", "up_to": 65_534},
        ),
        (
            counted(value("x", 0), "bytes"),
            {"type": "bytes", "size": "rest", "up_to": 65_534},
        ),
    ],
)
def test_an_array_counted_by_a_parameter_has_variable_length(text, expected, tmp_path):
    (tmp_path / "one.xml").write_text(text)
    read = run.read(tmp_path / "one.xml", xtce.Xtce())
    assert field(read, "A", "D") == {"at": 8, "name": "D", **expected}


def behind(text, *entries):
    """Return the system with further entries after the counted one: `E` is a
    little-endian word, `F` has four bits.
    """
    order = "bitOrder='mostSignificantBitFirst' byteOrder='leastSignificantByteFirst'"
    types = (
        f"<IntegerParameterType name='word' signed='false'><IntegerDataEncoding sizeInBits='16' {order}/></IntegerParameterType>"
        "<IntegerParameterType name='half' signed='false'><IntegerDataEncoding sizeInBits='4'/></IntegerParameterType>"
    )
    parameters = "".join(
        f'<Parameter name="{name}" parameterTypeRef="{kind}"/>'
        for name, kind in (("E", "word"), ("F", "half"))
    )
    added = "".join(
        entry if entry[0] == "<" else f'<ParameterRefEntry parameterRef="{entry}"/>'
        for entry in entries
    )
    return (
        text.replace("</ParameterTypeSet>", f"{types}</ParameterTypeSet>")
        .replace("</ParameterSet>", f"{parameters}</ParameterSet>")
        .replace("</EntryList>", f"{added}</EntryList>")
    )


def test_fields_after_a_counted_array_are_imported(tmp_path):
    fixed = '<FixedValueEntry binaryValue="00" sizeInBits="8"/>'
    text = behind(counted(value(8, 0), "bytes"), "E", fixed, "E")
    (tmp_path / "one.xml").write_text(text)
    read = run.read(tmp_path / "one.xml", xtce.Xtce())
    assert not read.failed
    (tmp_path / "one.yaml").write_text(
        emit.canonical_yaml(next(iter(read.trees.values())))
    )
    loaded = load([tmp_path / "one.yaml"])
    assert loaded.ok, loaded.findings
    (node,) = loaded.icd.nodes
    (message,) = node.messages
    frame = bytes.fromhex("02 AABB 3412 00 7856")
    raw = codec.decode_frame(node, message, frame)
    assert (raw["D"], raw["E"], raw["E 2"]) == (b"\xaa\xbb", 0x1234, 0x5678)
    assert codec.encode(node, message, codec.decode(node, message, frame)) == frame


@pytest.mark.parametrize(
    "entries",
    [
        ("F",),
        ("E", "F"),
        ('<ParameterRefEntry parameterRef="E"><LocationInContainerInBits>'
         "<FixedValue>8</FixedValue></LocationInContainerInBits></ParameterRefEntry>",),
    ],
)  # fmt: skip
def test_fields_without_whole_bytes_after_a_counted_array_are_refused(
    entries, tmp_path
):
    text = behind(counted(value(8, 0), "bytes"), *entries)
    (tmp_path / "one.xml").write_text(text)
    with pytest.raises(Findings) as refused:
        run.read(tmp_path / "one.xml", xtce.Xtce())
    (finding,) = refused.value.findings
    assert "follows `D`, whose size is not fixed" in finding.message


@pytest.mark.parametrize("dynamic", [value(2, 0), value(1, 0.5), "<DynamicValue/>"])
def test_an_array_without_a_counter_is_imported_as_bytes_to_the_end(dynamic, tmp_path):
    (tmp_path / "one.xml").write_text(counted(dynamic))
    read = run.read(tmp_path / "one.xml", xtce.Xtce())
    (lost,) = [
        finding
        for finding in read.definitions.import_findings
        if finding.severity == "error"
    ]
    assert lost.code == "IMP081" and lost.message.startswith(
        "message `A`: from `D` on only bytes are imported: "
    )
    assert "no parameter counts" in lost.message and read.failed
    assert field(read, "A", "D") == {
        "at": 8,
        "name": "D",
        "type": "bytes",
        "size": "rest",
        "up_to": 65_534,
    }


@pytest.mark.parametrize("bits", [8 * 65_536, 10**12])
def test_a_position_beyond_every_frame_removes_the_message_and_needs_no_memory(
    bits, tmp_path
):
    position = f"<LocationInContainerInBits><FixedValue>{bits}</FixedValue></LocationInContainerInBits>"
    entry = f'{ENTRY}<ParameterRefEntry parameterRef="P">{position}</ParameterRefEntry>'
    (tmp_path / "one.xml").write_text(system(container("A", entry), BYTE))
    with pytest.raises(Findings) as raised:
        run.read(tmp_path / "one.xml", xtce.Xtce())
    assert any(
        "more than 65,535 bytes" in finding.message for finding in raised.value.findings
    )


@pytest.mark.parametrize("scale", ["x", "1e9999"])
def test_a_time_with_an_invalid_scale_is_imported_raw(scale, tmp_path):
    text = (
        (FILES / "lander.xml").read_text().replace('scale="0.001"', f'scale="{scale}"')
    )
    (tmp_path / "lander.xml").write_text(text)
    read = run.read(tmp_path / "lander.xml", xtce.Xtce())
    assert "formula" not in field(read, "Power", "At") and "unit" not in field(
        read, "Power", "At"
    )
    assert f"`At` (message `Power`): a coefficient is `{scale}`" in [
        finding.message for finding in read.definitions.import_findings
    ]


def test_messages_with_equal_names_get_unique_names(lander):
    assert [message["name"] for message in lander.trees["lander"]["messages"]].count(
        "Power"
    ) == 1


@pytest.mark.parametrize(
    ("stated", "most"), [(0, 1), (1, 1), (5, 5), (255, 255), (300, 255)]
)
def test_an_array_has_at_most_the_number_of_elements_that_its_parameter_states(
    stated, most, tmp_path
):
    plain = '<Parameter name="D" parameterTypeRef="data"/>'
    data = f'<AncillaryData name="ICD up_to">{stated}</AncillaryData>'
    limited = f"{plain[:-2]}><AncillaryDataSet>{data}</AncillaryDataSet></Parameter>"
    text = counted(value(1, -1))
    assert plain in text
    (tmp_path / "one.xml").write_text(text.replace(plain, limited))
    read = run.read(tmp_path / "one.xml", xtce.Xtce())
    assert field(read, "A", "D")["up_to"] == most
