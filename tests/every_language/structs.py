"""Structs: types that messages and other structs contain."""

from __future__ import annotations

from tests.every_language.story import Claim, Story

STRUCTS = Story(
    node="structs",
    icd="""\
icdgen: 1
node: {name: structs, title: Structs, byte_order: little, bit_order: lsb0}
enums:
  - {name: System, members: [{value: 0, name: GPS}, {value: 2, name: Galileo}]}
structs:
  - name: Satellite
    length: 5
    fields:
      - {at: 0, bits: 4, name: System, type: enum, enum: System}
      - {at: 4, bits: 4, name: Quality, type: uint}
      - {at: 8, bits: 16, name: Azimuth, type: int, unit: deg, formula: raw*0.5}
      - {at: 24, bits: 8, count: 2, name: Signals, type: uint, unit: V, formula: raw*0.25}
  - name: Pair
    length: 11
    fields:
      - {at: 0, name: Both, struct: Satellite, count: 2}
      - {at: 80, bits: 8, name: Version, type: uint, const: 7}
messages:
  - name: View
    id: 1
    kind: telemetry
    length: 16
    fields:
      - {at: 0, name: Best, struct: Satellite}
      - {at: 40, name: Pairs, struct: Pair, count: 1}
""",
    c="""\
const uint8_t frame[16] = {0x32, 0x64, 0x00, 1, 2, 0x12, 0xfe, 0xff, 3, 4, 0xf0, 0x00, 0x80, 5, 6, 7};
uint8_t again[16] = {0};
structs_view_t view;
structs_satellite_t *last = &view.pairs[0].both[1];
CHECK(structs_view_decode(&view, frame, sizeof frame) == ICD_OK);
(void)again;
(void)last;
""",
    python="""\
frame = bytes.fromhex("326400010212feff0304f00080050607")
view = View.from_bytes(frame)
last = view.pairs[0].both[1]
""",
    rust="""\
use icd::structs::enums::System;
use icd::structs::{Pair, Satellite, View};
use icd::{Error, Message};
let frame = [0x32, 0x64, 0x00, 1, 2, 0x12, 0xfe, 0xff, 3, 4, 0xf0, 0x00, 0x80, 5, 6, 7];
let mut view = View::from_bytes(&frame).unwrap();
""",
    claims=(
        Claim(
            "a struct is a type of its own wherever it stands",
            c="""\
CHECK(sizeof view.pairs == sizeof(structs_pair_t));
CHECK(sizeof view.pairs[0].both == 2u * sizeof(structs_satellite_t));
CHECK(view.best.system == STRUCTS_SYSTEM_GALILEO && view.best.quality == 3u && view.best.signals[1] == 2u);
""",
            python="""\
assert type(view.best) is type(last) is Satellite
assert (view.best.system, view.best.quality, view.best.signals) == (System.GALILEO, 3, (1, 2))
assert [satellite.signals for satellite in view.pairs[0].both] == [(3, 4), (5, 6)]
""",
            rust="""\
let best: Satellite = view.best;
assert_eq!((best.quality, best.signals), (3, [1, 2]));
assert_eq!(best.system, System::Galileo);
assert_eq!(view.pairs[0].both[1].signals, [5, 6]);
""",
        ),
        Claim(
            "a decoded message encodes to the same frame",
            c="CHECK(structs_view_encode(&view, again, sizeof again) == ICD_OK && memcmp(frame, again, sizeof frame) == 0);\n",
            python="assert view.to_bytes() == frame\n",
            rust="assert_eq!(view.to_bytes().unwrap(), frame);\n",
        ),
        Claim(
            "fields of a struct have physical values",
            c="""\
double value = -1.0;
CHECK(structs_satellite_azimuth_deg(&view.best) == 50.0);
CHECK(structs_satellite_azimuth_deg(&view.pairs[0].both[0]) == -1.0);
CHECK(structs_satellite_signals_v(last, 1u, &value) == ICD_OK && value == 1.5);
CHECK(structs_satellite_signals_v(last, 2u, &value) == ICD_ERROR_RANGE && value == 1.5);
""",
            python="""\
assert view.best.azimuth_deg == 50.0 and view.pairs[0].both[0].azimuth_deg == -1.0
assert last.signals_v == (1.25, 1.5)
""",
            rust="""\
assert_eq!(view.best.azimuth_deg(), 50.0);
assert_eq!(view.pairs[0].both[0].azimuth_deg(), -1.0);
assert_eq!(view.pairs[0].both[1].signals_v(1), Some(1.5));
assert_eq!(view.pairs[0].both[1].signals_v(2), None);
""",
        ),
        Claim(
            "a physical value can be set in a struct of a message",
            c="""\
CHECK(structs_satellite_set_azimuth_deg(last, 1.0) == ICD_OK && last->azimuth == 2);
CHECK(structs_satellite_set_azimuth_deg(last, 1e6) == ICD_ERROR_RANGE && last->azimuth == 2);
CHECK(structs_view_encode(&view, again, sizeof again) == ICD_OK && again[11] == 2u && again[12] == 0u);
""",
            python="""\
last.azimuth_deg = 1.0
assert view.to_bytes() == frame[:11] + b"\\x02\\x00" + frame[13:]
""",
            rust="""\
view.pairs[0].both[1].set_azimuth_deg(1.0).unwrap();
assert_eq!(view.to_bytes().unwrap()[11..13], [2, 0]);
""",
        ),
        Claim(
            "a value that does not fit in a struct is refused by name",
            c="""\
last->quality = 16u;
CHECK(strcmp(structs_view_misfit(&view), "Pairs[].Both[].Quality") == 0);
CHECK(structs_view_encode(&view, again, sizeof again) == ICD_ERROR_RANGE);
""",
            python="""\
last.quality = 16
try:
    view.to_bytes()
except package.RangeError as error:
    assert error.field == "pairs[0].both[1].quality"
else:
    assert False
""",
            rust="""\
view.pairs[0].both[1].quality = 16;
assert_eq!(view.to_bytes(), Err(Error::Range { field: "Quality", allowed: "0 to 15" }));
""",
        ),
        Claim(
            "a new message has structs with their constants, and so has a new struct",
            c="""\
structs_view_init(&view);
CHECK(view.pairs[0].version == STRUCTS_PAIR_VERSION_CONST && last->quality == 0u);
view.pairs[0].version = 0u;
structs_pair_init(&view.pairs[0]);
CHECK(view.pairs[0].version == 7u);
""",
            python="""\
assert View().pairs == (Pair(),) and View().best == Satellite()
assert Pair().version == 7
""",
            rust="""\
assert_eq!(View::default().pairs, [Pair::default()]);
assert_eq!(Satellite::default(), View::default().best);
assert_eq!((Pair::default().version, Pair::VERSION_CONST), (7, 7));
""",
        ),
        Claim(
            "the table of fields leads to the fields of a struct",
            c="""\
size_t count = 0u;
const icd_field_t *fields = structs_view_fields(&count);
CHECK(count == 2u && fields[1].at == 40u && fields[1].bits == 88u && fields[1].count == 1u);
fields = fields[1].fields(&count);
CHECK(count == 2u && strcmp(fields[1].name, "Version") == 0 && fields[1].at == 80u && fields[1].fields == NULL);
fields = fields[0].fields(&count);
CHECK(count == 4u && strcmp(fields[2].unit, "deg") == 0 && fields[3].count == 2u);
""",
            python="""\
pairs = View.FIELDS[1]
assert (pairs.type, pairs.struct, pairs.elements, pairs.at) == ("struct", Pair, 1, 40)
assert [(leaf.attribute, leaf.at) for leaf in pairs.leaves[-4:]] == [
    ("pairs[0].both[1].azimuth", 88), ("pairs[0].both[1].signals[0]", 104),
    ("pairs[0].both[1].signals[1]", 112), ("pairs[0].version", 120),
]
""",
            rust="""\
let pairs = View::FIELDS[1];
assert_eq!((pairs.name, pairs.count, pairs.fields[0].fields[2].unit), ("Pairs", 1, "deg"));
""",
        ),
        Claim(
            "a message shows the fields of its structs",
            python="assert repr(view.best).startswith('Satellite(system=<System.GALILEO: 2>, quality=3,')\n",
            rust="""\
let shown = "Satellite: System Galileo, Quality 3, Azimuth 50 deg, Signals [0.25, 0.5] V";
assert_eq!(view.best.to_string(), shown);
assert!(view.to_string().starts_with("View: Best {System Galileo, Quality 3"));
""",
        ),
    ),
)
