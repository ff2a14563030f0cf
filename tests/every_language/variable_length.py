"""Arrays, bytes and texts of variable length, and fields behind them.

A field or the size of the frame determines the length.
"""

from __future__ import annotations

from tests.every_language.story import Claim, Story

VARIABLE_LENGTH = Story(
    node="variable",
    icd="""\
icdgen: 1
node: {name: variable, title: Variable length, byte_order: big, bit_order: lsb0}
messages:
  - name: Samples
    id: 1
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 24, name: Samples, type: int, count: rest, up_to: 5}
  - name: Packet
    id: 2
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: Blob Length, type: uint}
      - {at: 8, bits: 8, name: Length, type: uint}
      - {at: 16, name: Blob, type: bytes, size: {field: Blob Length, plus: -1}, up_to: 9}
      - {at: 16, after: Blob, name: Payload, type: bytes, size: {field: Length, plus: -2}, up_to: 60}
      - {at: 16, after: Payload, bits: 16, name: Check, type: uint}
  - name: Log
    id: 3
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Length, type: uint}
      - {at: 8, name: Payload, type: bytes, size: {field: Length, plus: -2}, up_to: 60}
""",
    c="""\
const uint8_t frame[7] = {3, 0, 0, 1, 0xff, 0xff, 0xff};
uint8_t again[100] = {0};
variable_samples_t samples;
variable_packet_t packet;
CHECK(variable_samples_decode(&samples, frame, sizeof frame) == ICD_OK);
variable_packet_init(&packet);
(void)again;
""",
    python="""\
frame = bytes.fromhex("03000001ffffff")
samples = Samples.from_bytes(frame)
""",
    rust="""\
use icd::variable::{Packet, Samples};
let frame = [3, 0, 0, 1, 0xff, 0xff, 0xff];
let mut samples = Samples::from_bytes(&frame).unwrap();
""",
    claims=(
        Claim(
            "an array has the elements of the frame",
            c="""\
CHECK(samples.number == 3u && samples.samples_count == 2u);
CHECK(samples.samples[0] == 1 && samples.samples[1] == -1);
CHECK(variable_samples_size(&samples) == sizeof frame);
CHECK(variable_samples_encode(&samples, again, sizeof frame) == ICD_OK && memcmp(frame, again, sizeof frame) == 0);
""",
            python="""\
assert (samples.number, samples.samples) == (3, (1, -1))
assert samples.to_bytes() == frame
""",
            rust="""\
assert_eq!((samples.number, samples.samples()), (3, &[1, -1][..]));
assert_eq!(&*samples.to_bytes().unwrap(), &frame[..]);
""",
        ),
        Claim(
            "a frame that ends within an element is refused",
            c="""\
CHECK(variable_samples_decode(&samples, frame, 3u) == ICD_ERROR_LENGTH);
CHECK(variable_samples_decode(&samples, frame, 0u) == ICD_ERROR_LENGTH);
""",
            python="""\
for length in (0, 2, 3, 5, 17, 400):
    try:
        Samples.from_bytes(bytes(length))
    except package.LengthError as error:
        assert error.actual == length
    else:
        assert False, length
""",
            rust="""\
for length in [0, 2, 3, 5, 17, 400] {
    let error = Samples::from_bytes(&vec![0; length]).unwrap_err();
    assert!(matches!(error, icd::Error::Length { actual, .. } if actual == length));
}
""",
        ),
        Claim(
            "an element that does not fit is refused",
            c="""\
samples.samples[1] = 1 << 23;
CHECK(variable_samples_encode(&samples, again, sizeof frame) == ICD_ERROR_RANGE);
""",
            python="""\
samples.samples = (0, 1 << 23)
try:
    samples.to_bytes()
except package.RangeError as error:
    assert error.field == "samples[1]"
else:
    assert False
""",
            rust="""\
samples.samples[1] = 1 << 23;
assert!(matches!(samples.to_bytes(), Err(icd::Error::Range { field: "Samples", .. })));
""",
        ),
        Claim(
            "a new message has no elements",
            c="""\
variable_samples_init(&samples);
CHECK(variable_samples_size(&samples) == 1u && variable_packet_size(&packet) == 4u);
""",
            python="""\
assert Samples().to_bytes() == bytes(1)
assert len(Packet().to_bytes()) == 4
""",
            rust="""\
assert_eq!(&*Samples::default().to_bytes().unwrap(), &[0]);
assert_eq!(Packet::default().to_bytes().unwrap().len(), 4);
""",
        ),
        Claim(
            "a field behind is found where the part in front of it ends",
            c="""\
const uint8_t whole[8] = {3, 4, 0xaa, 0xab, 0xba, 0xbb, 0x12, 0x34};
CHECK(variable_packet_decode(&packet, whole, sizeof whole) == ICD_OK);
CHECK(packet.check == 0x1234u && packet.blob[1] == 0xabu && packet.payload[1] == 0xbbu);
CHECK(variable_packet_encode(&packet, again, sizeof whole) == ICD_OK && memcmp(whole, again, sizeof whole) == 0);
""",
            python="""\
frame = bytes.fromhex("0304aaabbabb1234")
packet = Packet.from_bytes(frame)
assert packet.blob == b"\\xaa\\xab".ljust(9, b"\\0")  # only the last part varies
assert (packet.payload, packet.check) == (b"\\xba\\xbb", 0x1234)
assert packet.to_bytes() == frame
""",
            rust="""\
let frame = [3, 4, 0xaa, 0xab, 0xba, 0xbb, 0x12, 0x34];
let packet = Packet::from_bytes(&frame).unwrap();
assert_eq!((packet.blob(), packet.payload(), packet.check), (&frame[2..4], &frame[4..6], 0x1234));
assert_eq!(&*packet.to_bytes().unwrap(), &frame[..]);
""",
        ),
        Claim(
            "a count that is less than what is subtracted from it counts nothing",
            c="""\
variable_log_t log;
variable_log_init(&log);
CHECK(variable_log_size(&log) == 1u);
log.length = 0u;
CHECK(variable_log_size(&log) == 1u);
log.length = 5u;
CHECK(variable_log_size(&log) == 4u);
packet.blob_length = 0u;
packet.length = 1u;
CHECK(variable_packet_size(&packet) == 4u);
packet.blob_length = 3u;
packet.length = 5u;
CHECK(variable_packet_size(&packet) == 9u);
""",
        ),
    ),
)
