# A format without `seq`: its fields stand at fixed places.
meta: {id: places, endian: le}
instances:
  tail: {pos: 6, type: u2}
  head: {pos: 0, type: point}
types:
  point:
    seq: [{id: x, type: s2}, {id: y, type: s2}]
