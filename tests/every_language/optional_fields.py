"""Optional fields: present only if another field has certain values."""

from __future__ import annotations

from tests.every_language.story import Claim, Story

OPTIONAL_FIELDS = Story(
    node="optional",
    icd="""\
icdgen: 1
node: {name: optional, title: Optional fields, byte_order: big, bit_order: lsb0}
enums:
  - {name: Gear, members: [{value: 1, name: First}, {value: 2, name: Second}]}
messages:
  - name: Order
    id: 1
    kind: telecommand
    length: 4
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, bits: 8, name: Key, type: uint, const: 0x5A, when: {Mode: 7}}
      - {at: 16, bits: 16, name: Rate, type: int, unit: rpm, formula: raw*0.5, when: {Mode: [0, 7]}}
  - name: Drive
    id: 2
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 1, name: Has Gear, type: bool}
      - {at: 8, bits: 8, name: Gear, type: enum, enum: Gear, when: {Has Gear: [false, true]}}
""",
    c="""\
const uint8_t with_rate[4] = {0, 0, 0xff, 0xfe};
const uint8_t without_rate[4] = {1, 0, 0, 0};
uint8_t again[4] = {0};
optional_order_t order;
CHECK(optional_order_decode(&order, with_rate, sizeof with_rate) == ICD_OK);
(void)again;
(void)without_rate;
""",
    python="""\
order = Order.from_bytes(bytes.fromhex("0000fffe"))
without_rate = Order.from_bytes(bytes.fromhex("01000000"))
""",
    rust="""\
use icd::optional::Order;
let mut order = Order::from_bytes(&[0, 0, 0xff, 0xfe]).unwrap();
let without_rate = Order::from_bytes(&[1, 0, 0, 0]).unwrap();
""",
    claims=(
        Claim(
            "a field that is present has its value, raw and physical",
            c="""\
CHECK(optional_order_has_rate(&order));
CHECK(order.rate == -2 && optional_order_rate_rpm(&order) == -1.0);
""",
            python="assert (order.rate, order.rate_rpm) == (-2, -1.0)\n",
            rust="assert_eq!((order.rate, order.rate_rpm()), (Some(-2), Some(-1.0)));\n",
        ),
        Claim(
            "a field that is absent is reported as absent",
            c="""\
CHECK(optional_order_decode(&order, without_rate, sizeof without_rate) == ICD_OK);
CHECK(!optional_order_has_rate(&order) && !optional_order_has_key(&order) && order.rate == 0);
""",
            python="assert (without_rate.rate, without_rate.rate_rpm, order.key) == (None,) * 3\n",
            rust="assert_eq!((without_rate.rate, without_rate.rate_rpm(), order.key), (None, None, None));\n",
        ),
        Claim(
            "a new message has the fields that are present if all others are 0",
            c="""\
optional_order_init(&order);
CHECK(optional_order_encode(&order, again, sizeof again) == ICD_OK);
CHECK(again[0] == 0u && again[1] == 0u && again[2] == 0u && again[3] == 0u);
""",
            python="assert (Order().rate, Order().key) == (0, None)\n",
            rust="assert_eq!((Order::default().rate, Order::default().key), (Some(0), None));\n",
        ),
        Claim(
            "a constant that becomes present has its value",
            c="""\
order.mode = 7u;
CHECK(optional_order_encode(&order, again, sizeof again) == ICD_OK);
CHECK(again[1] == OPTIONAL_ORDER_KEY_CONST && again[3] == 0xfeu);
""",
            python="assert Order(mode=7).to_bytes() == bytes([7, 0x5A, 0, 0])\n",
        ),
        Claim(
            "a message without a field that must be present is refused",
            python="""\
without_rate.mode = 0
try:
    without_rate.to_bytes()
except package.RangeError as error:
    assert str(error) == "rate takes integers from -32768 to 32767, not None"
else:
    assert False
""",
            rust="""\
order.rate = None;
assert!(matches!(order.to_bytes(), Err(icd::Error::Range { field: "Rate", .. })));
""",
        ),
        Claim(
            "an absent field is not written",
            c="""\
order.mode = 1u;
CHECK(optional_order_encode(&order, again, sizeof again) == ICD_OK);
CHECK(memcmp(again, without_rate, sizeof again) == 0);
""",
            python="assert Order(mode=1, rate=1 << 20).to_bytes() == bytes([1, 0, 0, 0])\n",
            rust="""\
order.mode = 1;
assert_eq!(order.to_bytes(), Ok([1, 0, 0, 0]));
""",
        ),
        Claim(
            "a field that is present for both values of a flag is 0 at first, "
            "also if its enumeration has no such member",
            c="""\
optional_drive_t drive;
memset(again, 0xff, sizeof again);
optional_drive_init(&drive);
CHECK(optional_drive_has_gear(&drive) && drive.gear == 0u);
CHECK(optional_drive_encode(&drive, again, sizeof again) == ICD_OK && again[1] == 0u);
drive.has_gear = true;
CHECK(optional_drive_has_gear(&drive));
""",
            python="""\
for has_gear in (False, True):
    assert Drive(has_gear=has_gear).gear == 0
    assert Drive(has_gear=has_gear).to_bytes() == bytes([has_gear, 0])
    assert Drive.from_bytes(bytes([has_gear, 2])).gear == Gear.SECOND
""",
            rust="""\
use icd::optional::{enums::Gear, Drive};
assert_eq!(Gear::default().raw(), 0);
let mut drive = Drive::default();
for has_gear in [false, true] {
    drive.has_gear = has_gear;
    assert_eq!(drive.gear.map(|gear| gear.raw()), Some(0));
    assert_eq!(drive.to_bytes(), Ok([u8::from(has_gear), 0]));
    let decoded = Drive::from_bytes(&[u8::from(has_gear), 2]).unwrap();
    assert_eq!(decoded.gear, Some(Gear::Second.into()));
}
""",
        ),
    ),
)
