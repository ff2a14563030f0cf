---
# A frame of AX.25 as decoders of satellites define it, and what is seldom in them.
meta:
  id: frame
  endian: le
seq:
  - id: header
    type: header
  - id: payload
    type:
      switch-on: header.control & 0x13
      cases:
        0x03: unnumbered
        0x00: information
types:
  header:
    seq:
      - id: callsign
        process: ror(1)
        size: 6
        type: text
      - id: ssid_raw
        type: u1
      - id: control
        type: u1
    instances:
      ssid:
        value: (ssid_raw & 0x0f) >> 1
  text:
    seq:
      - {id: text, type: str, size: 6, encoding: ASCII}
  unnumbered:
    seq:
      - {id: pid, type: u1}
      - {id: uptime, type: u4, doc: Since the last reset., -unit: s}
      - {id: current, type: s2be}
      - {id: low, type: b4le, enum: 'side'}
      - {id: high, type: b4le}
      - {id: limit, type: s1, valid: {min: -40, max: 85}}
      - id: page
        size: 4
        type: page
      - {id: samples, type: s2, repeat: eos}
    instances:
      amps: {value: current / 1000.0 + 0.5, -unit: A}
      halves: {value: uptime / 2}
      elsewhere: {pos: 4, type: u1}
    enums:
      side: {0: 'off', 1: on, 0b11: {id: both, doc: Of them.}}
  page:
    seq:
      - {id: number, type: u1}
      - {id: data, size-eos: true}
  information:
    seq:
      - {id: pid, type: u1}
      - {id: size, type: u1}
      - {id: data, size: size * 2}
