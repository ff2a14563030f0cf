"""What C makes of members that a program changed after decoding: counts, and what says
which members are there.
"""

from __future__ import annotations

import subprocess

from tests.c import harness

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: big, bit_order: lsb0}
messages:
  - name: Packet
    id: 1
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: Blob Length, type: uint}
      - {at: 8, bits: 8, name: Length, type: uint}
      - {at: 16, name: Blob, type: bytes, size: {field: Blob Length, plus: -1}, up_to: 9}
      - {at: 16, after: Blob, name: Payload, type: bytes, size: {field: Length, plus: -2}, up_to: 60}
  - name: Log
    id: 2
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Length, type: uint}
      - {at: 8, name: Payload, type: bytes, size: {field: Length, plus: -2}, up_to: 60}
  - name: Order
    id: 3
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, bits: 8, name: Key, type: uint, const: 0x5A, when: {Mode: 7}}
"""

USER = """\
#include <demo.h>

int main(void)
{
    const uint8_t frame[2] = {0, 0};
    uint8_t again[2];
    demo_packet_t packet;
    demo_log_t log;
    demo_order_t order;
    demo_packet_init(&packet);
    demo_log_init(&log);
    if ((demo_packet_size(&packet) != 2u) || (demo_log_size(&log) != 1u)) {
        return 1;
    }
    packet.blob_length = 0u;
    packet.length = 1u;
    log.length = 0u;
    if ((demo_packet_size(&packet) != 2u) || (demo_log_size(&log) != 1u)) {
        return 2;
    }
    packet.blob_length = 3u;
    packet.length = 5u;
    log.length = 5u;
    if ((demo_packet_size(&packet) != 7u) || (demo_log_size(&log) != 4u)) {
        return 3;
    }
    if (demo_order_decode(&order, frame, sizeof frame) != ICD_OK) {
        return 4;
    }
    order.mode = 7u;
    if ((demo_order_encode(&order, again, sizeof again) != ICD_OK) || (again[1] != DEMO_ORDER_KEY_CONST)) {
        return 5;
    }
    return 0;
}
"""


def test_a_count_too_small_makes_no_huge_size_and_a_constant_is_right_once_it_is_there(
    tmp_path,
):
    (tmp_path / "demo.yaml").write_text(ICD, encoding="utf-8")
    folder = harness.generate(harness.read(tmp_path / "demo.yaml"), tmp_path / "c")
    (folder / "user.c").write_text(USER)
    options = (*harness.WARNINGS, *harness.SANITIZERS, f"-I{folder}")
    program = harness.compile(
        folder / "user.c", "-std=c99", *options, output=folder / "user"
    )
    assert subprocess.run([program]).returncode == 0
