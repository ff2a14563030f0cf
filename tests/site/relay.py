"""ICD of a fictional relay whose link has several packet formats per direction.

They have an id of two parts, with and without length, a request with reserved bytes,
and negative acknowledges with and without an id.
"""

from __future__ import annotations

RELAY = """
icdgen: 1
node: {name: relay, title: Relay, id_bits: 16, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: length}
    packets:
      order:
        from: host
        header:
          - {at: 0,  bits: 8, role: sync, value: 0xC1}
          - {at: 8,  bits: 8, role: id}
          - {at: 16, bits: 8, role: length, counts: message}
          - {at: 24, bits: 8, role: id}
        trailer: [{at: 0, bits: 16, role: checksum, checksum: crc, covers: {from: sync, to: data}}]
      question:
        from: host
        summary: Its two bytes of data mean nothing
        header:
          - {at: 0, bits: 8,  role: sync, value: 0xC2}
          - {at: 8, bits: 16, role: id}
        trailer: [{at: 0, bits: 8, role: checksum, checksum: xor, covers: {from: sync, to: data}}]
      report:
        from: device
        header:
          - {at: 0, bits: 8,  role: sync, value: 0xD1}
          - {at: 8, bits: 16, role: id}
          - {at: 24, bits: 8, role: status, enum: State}
          - {at: 32, bits: 8, role: length}
        trailer: [{at: 0, bits: 16, role: checksum, checksum: crc, covers: {from: sync, to: data}}]
      beat:
        from: device
        header: [{at: 0, bits: 16, role: sync, value: [0xD2, 0xD3]}]
        trailer: [{at: 0, bits: 8, role: checksum, checksum: xor, covers: {from: sync, to: data}}]
        messages: [Beat]
      refusal:
        from: device
        reserved: 1
        header:
          - {at: 0,  bits: 8,  role: sync, value: 0xD4}
          - {at: 8,  bits: 16, role: id}
          - {at: 24, bits: 8,  role: reason, enum: Reason}
        trailer: [{at: 0, bits: 8, role: checksum, checksum: xor, covers: {from: sync, to: data}}]
      busy:
        from: device
        header: [{at: 0, bits: 16, role: sync, value: [0xD5, 0xD6]}]
        trailer: [{at: 0, bits: 8, role: checksum, checksum: xor, covers: {from: sync, to: data}}]
      taken:
        from: device
        header:
          - {at: 0, bits: 8,  role: sync, value: 0xD7}
          - {at: 8, bits: 16, role: id}
        trailer: [{at: 0, bits: 8, role: checksum, checksum: xor, covers: {from: sync, to: data}}]
    commands:
      ack: Done
      nak: {packet: refusal, echo: id, reason: reason}
      busy: {packet: busy}
    requests:
      packet: question
      reserved: 2
      nak: {packet: refusal, echo: id, reason: reason}
      timeout_ms: 250
    checksums:
      crc:
        {kind: crc, width: 16, polynomial: 0x1021, init: 0xFFFF, xor_out: 0,
         reflect_in: false, reflect_out: false}
      xor: {kind: xor, width: 8}
enums:
  - name: State
    members: [{value: 0, name: Open}, {value: 1, name: Closed}]
  - name: Reason
    members: [{value: 1, name: Too hot}, {value: 2, name: Locked}]
messages:
  - name: Set Contact
    id: 0x0102
    kind: telecommand
    length: 2
    fields: [{at: 0, bits: 16, name: Contact, type: uint}]
  - name: Blink
    id: 0x0103
    kind: telecommand
    length: 1
    response: {ack: {packet: taken, echo: id}}
    fields: [{at: 0, bits: 8, name: Times, type: uint}]
  - name: Done
    id: 0x0201
    kind: telemetry
    length: 0
  - name: Temperature
    id: 0x0102
    kind: telemetry
    length: 2
    fields: [{at: 0, bits: 16, name: Temperature, type: int, unit: C}]
  - name: Counters
    id: 0x0203
    kind: telemetry
    length: 0
    fields: [{at: 0, bits: 16, name: Counts, type: uint, count: rest, up_to: 6}]
  - name: Beat
    id: 0x0204
    kind: telemetry
    length: 3
    fields: [{at: 0, bits: 24, name: Time, type: uint}]
"""
