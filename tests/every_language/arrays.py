"""Arrays: members with several elements, and accessors that take an index."""

from __future__ import annotations

from tests.every_language.story import Claim, Story

ARRAYS = Story(
    node="arrays",
    icd="""\
icdgen: 1
node: {name: arrays, title: Arrays, byte_order: little, bit_order: lsb0}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: -3, name: Active}]}
messages:
  - name: Heat
    id: 1
    kind: telemetry
    length: 9
    fields:
      - {at: 0, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
      - {at: 48, bits: 12, count: 2, name: Levels, type: uint}
  - name: Everything
    id: 2
    kind: telemetry
    length: 80
    fields:
      - {at: 0, bits: 8, count: 40, name: Octets, type: uint}
      - {at: 320, bits: 8, count: 2, name: Modes, type: enum, enum: Mode}
      - {at: 336, bits: 4, count: 2, name: Narrow Modes, type: enum, enum: Mode}
      - {at: 344, bits: 1, count: 8, name: Flags, type: bool}
      - {at: 352, bits: 32, count: 2, name: Floats, type: float, byte_order: big}
      - {at: 416, bits: 64, count: 2, name: Longs, type: uint, formula: raw*0.1}
      - {at: 544, bits: 12, count: 8, name: Levels, type: int, byte_order: big, bit_order: msb0, formula: raw/3}
  - name: Versions
    id: 3
    kind: telemetry
    length: 12
    fields:
      - {at: 0, bits: 64, name: Software, type: text}
      - {at: 64, bits: 32, name: Serial, type: bytes}
      - {at: 96, bits: 32, name: Extension, type: text, count: rest, up_to: 3}
""",
    c="""\
const uint8_t frame[9] = {0x64, 0x00, 0xfa, 0x00, 0xd4, 0xfe, 0x01, 0xf0, 0xff};
uint8_t again[9] = {0};
arrays_heat_t heat;
double value = -1.0;
int32_t thousandths = -1;
CHECK(arrays_heat_decode(&heat, frame, sizeof frame) == ICD_OK);
(void)again;
(void)value;
(void)thousandths;
""",
    python="""\
frame = bytes.fromhex("6400fa00d4fe01f0ff")
heat = Heat.from_bytes(frame)
""",
    rust="""\
use icd::arrays::{Everything, Heat, Versions};
let frame = [0x64, 0x00, 0xfa, 0x00, 0xd4, 0xfe, 0x01, 0xf0, 0xff];
let mut heat = Heat::from_bytes(&frame).unwrap();
""",
    claims=(
        Claim(
            "a member stores all elements, in the type of one element",
            c="""\
CHECK(sizeof heat.temperatures == 3u * sizeof(int16_t));
CHECK(heat.temperatures[0] == 100 && heat.temperatures[1] == 250 && heat.temperatures[2] == -300);
CHECK(heat.levels[0] == 1u && heat.levels[1] == 4095u);
""",
            python="""\
assert heat.temperatures == (100, 250, -300)
assert heat.levels == (1, 4095)
""",
            rust="""\
assert_eq!(heat.temperatures, [100, 250, -300]);
assert_eq!(heat.levels, [1, 4095]);
""",
        ),
        Claim(
            "a decoded message encodes to the same frame",
            c="""\
CHECK(arrays_heat_encode(&heat, again, sizeof again) == ICD_OK && memcmp(frame, again, sizeof frame) == 0);
""",
            python="""\
assert heat.to_bytes() == frame
assert Everything.from_bytes(bytes(range(80))).to_bytes() == bytes(range(80))
""",
            rust="""\
assert_eq!(heat.to_bytes().unwrap(), frame);
let bytes: Vec<u8> = (0..80).collect();
assert_eq!(Everything::from_bytes(&bytes).unwrap().to_bytes().unwrap(), *bytes);
""",
        ),
        Claim(
            "elements have physical values",
            c="""\
CHECK(arrays_heat_temperatures_c(&heat, 2u, &value) == ICD_OK && value == -3.0);
CHECK(arrays_heat_temperatures_mc(&heat, 1u, &thousandths) == ICD_OK && thousandths == 2500);
""",
            python="assert heat.temperatures_c == (1.0, 2.5, -3.0)\n",
            rust="assert_eq!(heat.temperatures_c(2), Some(-3.0));\n",
        ),
        Claim(
            "an index beyond the last element is refused and changes nothing",
            c="""\
CHECK(arrays_heat_temperatures_c(&heat, 3u, &value) == ICD_ERROR_RANGE && value == -1.0);
CHECK(arrays_heat_temperatures_mc(&heat, (size_t)-1, &thousandths) == ICD_ERROR_RANGE && thousandths == -1);
CHECK(arrays_heat_set_temperatures_c(&heat, 3u, 1.0) == ICD_ERROR_RANGE);
CHECK(arrays_heat_set_temperatures_mc(&heat, 3u, 1000) == ICD_ERROR_RANGE);
CHECK(arrays_heat_encode(&heat, again, sizeof again) == ICD_OK && memcmp(frame, again, sizeof frame) == 0);
""",
            rust="""\
assert_eq!(heat.temperatures_c(3), None);
assert_eq!(heat.temperatures_c(usize::MAX), None);
let error = heat.set_temperatures_c(3, 1.0).unwrap_err();
assert_eq!(error.to_string(), "`Temperatures` takes an index of its elements");
assert_eq!(heat.to_bytes().unwrap(), frame);
""",
        ),
        Claim(
            "a physical value of an element can be set",
            c="""\
for (size_t i = 0; i < 3u; i++) {
    CHECK(arrays_heat_set_temperatures_c(&heat, i, (double)i) == ICD_OK);
}
CHECK(heat.temperatures[0] == 0 && heat.temperatures[1] == 100 && heat.temperatures[2] == 200);
""",
            python="""\
heat.temperatures_c = [0, 1, 2]
assert heat.temperatures == (0, 100, 200)
""",
            rust="""\
heat.set_temperatures_c(1, 2.0).unwrap();
assert_eq!(heat.temperatures, [100, 200, -300]);
""",
        ),
        Claim(
            "a physical value out of range is refused and changes nothing",
            c="""\
CHECK(arrays_heat_set_temperatures_c(&heat, 0u, 1000.0) == ICD_ERROR_RANGE);
CHECK(heat.temperatures[0] == 100);
""",
            python="""\
for value, field in (
    ((0, 1e6, 0), "temperatures_c[1]"), ((1, 2), "temperatures_c"), (5, "temperatures_c")
):
    try:
        heat.temperatures_c = value
    except package.RangeError as error:
        assert error.field == field
    else:
        assert False, value
assert heat.temperatures == (100, 250, -300)
""",
            rust="""\
let error = heat.set_temperatures_c(0, 1000.0).unwrap_err();
assert_eq!(error.to_string(), "`Temperatures` takes -327.68 to 327.67 C");
assert_eq!(heat.temperatures, [100, 250, -300]);
""",
        ),
        Claim(
            "an element that does not fit is refused when encoding, by name",
            c="""\
CHECK(arrays_heat_misfit(&heat) == NULL);
heat.levels[1] = 4096u;
CHECK(arrays_heat_misfit(&heat) != NULL && strcmp(arrays_heat_misfit(&heat), "Levels") == 0);
CHECK(arrays_heat_encode(&heat, again, sizeof again) == ICD_ERROR_RANGE);
""",
            python="""\
heat.levels = (1, 4096)
try:
    heat.to_bytes()
except package.RangeError as error:
    assert error.field == "levels[1]"
else:
    assert False
""",
            rust="""\
heat.levels[1] = 4096;
assert_eq!(heat.to_bytes(), Err(icd::Error::Range { field: "Levels", allowed: "0 to 4095" }));
""",
        ),
        Claim(
            "elements of a new message are 0",
            c="""\
arrays_heat_init(&heat);
CHECK(heat.temperatures[0] == 0 && heat.temperatures[2] == 0 && heat.levels[1] == 0u);
""",
            python="assert Everything().octets == (0,) * 40\n",
            rust="assert_eq!(Everything::default().octets, [0; 40]);\n",
        ),
        Claim(
            "a message shows texts as texts and bytes as numbers",
            rust="""\
let frame = b"1.0 (B)\\0\\x01\\x02\\x03\\xffGPS\\0\\xb0C\\0\\0";
let versions = Versions::from_bytes(frame).unwrap();
let shown = r#"Versions: Software "1.0 (B)", Serial [1, 2, 3, 255], Extension ["GPS", [176, 67, 0, 0]], "#;
assert!(versions.to_string().starts_with(shown), "{versions}");
assert!(Versions::default().to_string().contains("Extension [], "));
""",
        ),
    ),
)
