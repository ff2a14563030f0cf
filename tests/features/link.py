"""A line and a log, for ICDs without a link: the simulator and the logs need them."""

from __future__ import annotations

LINK = """\
enums:
  - name: Refusal of the line
    members: [{value: 0, name: None}, {value: 1, name: Unknown}, {value: 2, name: Length}, {value: 3, name: Value}]
protocol:
  link:
    packets:
      acknowledge:
        from: device
        header: [{bits: 8, role: id, name: Number}, {bits: 8, role: status, name: Refusal, enum: Refusal of the line}]
    commands:
      ack: {packet: acknowledge, echo: id, status: status, success: [None]}
      reasons: {unknown_id: Unknown, length: Length, value: Value}
    buses:
      uart:
        line: {baud_rate: 115200, data_bits: 8, parity: none, stop_bits: 1}
        framing:
          by: escape
          escape: 0x10
          start: 0x02
          end: 0x03
          data: 0x10
          other: error
          escaped_in: [id, data]
    client: {reply_timeout_ms: 100, retries: 2}
  log_mask:
    bytes: 2
    bit_order: lsb0
    frame_bytes: 64
    frame_order: rising bits
    short_frames: filled
    fill: 0x00
    unassigned_bits: filled
  telemetry_log:
    header:
      - {byte: 0, bytes: 2, name: Mask, role: mask, type: bytes}
    entry:
      - {byte: 0, bytes: 4, name: Unix time,    role: seconds,      type: uint, unit: s}
      - {byte: 4, bytes: 2, name: Milliseconds, role: milliseconds, type: uint, unit: ms}
    frames_byte: 6
"""


def framed_link(id_bits: int) -> dict[str, object]:
    """Return the link of a node whose messages do not fit the line of `LINK`.

    Its ids are longer, or its messages have different lengths.
    """
    header = [
        {"at": 0, "bits": 8, "role": "sync", "value": 0x55},
        {"at": 8, "bits": 16, "role": "length"},
        {"at": 24, "bits": id_bits, "role": "id"},
    ]
    covers = {"from": "length", "to": "data"}
    checksum = {"at": 0, "bits": 8, "role": "checksum", "checksum": "parity"}
    return {
        "protocol": {
            "link": {
                "framing": {"by": "length"},
                "header": header,
                "trailer": [{**checksum, "covers": covers}],
                "checksums": {"parity": {"kind": "xor", "width": 8}},
            }
        }
    }
