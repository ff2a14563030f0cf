# Shapes of formats in public collections: types that compute and have no `seq`, an empty case of a switch, a size of 0.
meta: {id: cases, title: Beacon with cases, endian: be}
seq:
  - {id: kind, type: u1}
  - {id: derived, type: computed}
  - id: body
    type:
      switch-on: kind
      cases:
        1: power
        2: nothing
        _: unknown
types:
  computed:
    instances: {is_power: {value: _parent.kind}}
  nothing: {}
  unknown:
    seq: [{id: skipped, size: 0}]
  power:
    seq:
      - {id: volts, type: u2}
      - {id: flags, type: nothing, repeat: expr, repeat-expr: 3}
      - {id: amps, type: s2}
