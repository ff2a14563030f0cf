meta:
  id: probe
  title: Frames of a probe
  endian: be
doc: What the probe sends.
seq:
  - id: sync
    contents: [0xEB, 0x90]
  - id: header
    type: header
  - id: body
    type:
      switch-on: header.kind
      cases:
        kind::power: power
        kind::places: places
enums:
  kind:
    1: power
    2: places
    9: off
types:
  header:
    seq:
      - id: version
        type: b3
        valid: 2
      - id: is_late
        type: b1
      - id: spare
        type: b4
      - id: kind
        type: u1
        enum: kind
      - id: counter
        type: u2le
      - id: delay
        type: u2
        if: is_late
  power:
    seq:
      - id: volts_raw
        type: u2
        doc: Bus voltage.
        -unit: mV
      - id: temperature_raw
        type: s1
      - id: name
        type: str
        size: 6
        encoding: ASCII
      - id: cells
        type: u2
        repeat: expr
        repeat-expr: 3
    instances:
      temperature:
        value: temperature_raw * 0.5 - 40
        -unit: degC
      total:
        value: cells[0] + cells[1]
  places:
    seq:
      - id: place
        type: place
        repeat: expr
        repeat-expr: 2
      - id: rest
        size-eos: true
  place:
    seq:
      - id: x
        type: f4
      - id: y
        type: f4
