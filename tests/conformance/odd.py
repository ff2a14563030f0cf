"""Small ICDs of what the shipped ones do not have: other bit orders, odd widths, scaled 64-bit fields, odd names."""

from __future__ import annotations

from pathlib import Path

SHARED = """\
icdgen: 1
node: {name: shared, title: Shared, byte_order: big, bit_order: msb0, node_type: 3, interface_version: 250}
enums:
  - name: 'Odd "enum" \\ */ {{ x }}'
    identifier: odd enum
    members:
      - {value: 0, name: 'zero ??/'}
      - {value: 18446744073709551615, name: "last \\u00e9\\U0001F6F0"}
messages:
  - name: 'class "quoted" \\ */ {% raw %}'
    identifier: class quoted
    set_id: 200
    get_id: 7
    kind: configuration
    length: 32
    fields:
      - {at: 3, bits: 64, name: Wide Enum, type: enum, enum: 'Odd "enum" \\ */ {{ x }}'}
      - {at: 67, bits: 13, name: Crossing, type: int, formula: "raw*0.1 - 273.15", unit: C}
      - {at: 81, bits: 1, name: Flag, type: bool}
      - {at: 82, bits: 64, name: Wide, type: uint, formula: raw*0.1}
      - {at: 146, bits: 33, name: Between, type: int, formula: (raw - 32)*5/9}
      - {at: 179, bits: 32, name: Unaligned Float, type: float,
         special: [{value: nan, meaning: Not known}, {value: -99.9, meaning: no data}]}
      - {at: 216, bits: 16, name: Octets, type: bytes}
      - {at: 232, bits: 8, name: Magic, type: uint, const: 0x5A}
      - {at: 240, bits: 9, name: Ninth, type: int, special: [{value: -256, meaning: none at all}], min: -100, max: 100.5}
      - {at: 249, bits: 1, name: One Bit, type: int}
      - {at: 250, bits: 1, name: One Unsigned Bit, type: uint, formula: -raw*3}
  - name: Ends of 64 Bits
    id: 9
    kind: telecommand
    length: 16
    fields:
      - {at: 0, bits: 64, name: Least, type: int, min: -9223372036854775808, max: 9223372036854775806}
      - {at: 64, bits: 64, name: Most, type: uint, min: 9223372036854775808, max: 18446744073709551614}
  - {name: Nothing, id: 0, kind: telecommand, length: 0}
"""

MIXED = """\
icdgen: 1
node: {name: mixed, title: Mixed order, byte_order: little, bit_order: msb0}
include: [shared.yaml]
enums:
  - name: Signed Narrow
    members:
      - {value: -1, name: Backwards}
      - {value: 0, name: Nowhere}
      - {value: 3, name: Forwards}
  - name: Signed Wide
    members:
      - {value: -9223372036854775808, name: Least}
      - {value: 9223372036854775807, name: Most}
  - name: Signed Word
    members:
      - {value: -40000, name: Below}
      - {value: -7, name: Seven Below}
  - name: Signed Ends
    members:
      - {value: -128, name: First}
      - {value: 127, name: Last}
messages:
  - name: Signs
    id: 9
    kind: telemetry
    length: 40
    fields:
      - {at: 0, bits: 3, name: Three, type: enum, enum: Signed Narrow}
      - {at: 3, bits: 8, name: Crossing, type: enum, enum: Signed Narrow, byte_order: big}
      - {at: 16, bits: 8, name: Byte, type: enum, enum: Signed Ends, const: -128}
      - {at: 24, bits: 8, name: Narrow Byte, type: enum, enum: Signed Narrow}
      - {at: 32, bits: 64, name: Whole, type: enum, enum: Signed Wide}
      - {at: 96, bits: 64, name: Turned, type: enum, enum: Signed Wide, byte_order: big}
      - {at: 163, bits: 17, name: Odd, type: enum, enum: Signed Word, special: [{value: -65536, meaning: none}]}
      - {at: 192, bits: 32, name: Word, type: enum, enum: Signed Word}
      - {at: 224, bits: 24, name: Three Bytes, type: enum, enum: Signed Word, byte_order: big}
      - {at: 248, bits: 8, name: Last Byte, type: enum, enum: Signed Ends}
      - {at: 256, bits: 16, name: Half, type: enum, enum: Signed Narrow}
      - {at: 280, bits: 33, name: Lengthy, type: enum, enum: Signed Word}
  - name: Curved
    set_id: 20
    get_id: 30
    kind: configuration
    length: 57
    fields:
      - {at: 0, bits: 16, name: Thermistor, type: uint, unit: C, formula: "-40 + 0.02*raw + 3e-6*raw^2", min: 0}
      - {at: 19, bits: 12, name: Falling, type: int, unit: V, formula: "5 - 0.01*raw - 1e-9*raw^3", byte_order: big}
      - {at: 32, bits: 32, name: Wide, type: int, formula: "raw^2*1e-3 + 7"}
      - {at: 64, bits: 64, name: Widest, type: uint, formula: "1.5e-18*raw^2 - 2.25e-9*raw + 1/3"}
      - {at: 128, bits: 32, name: Rate, type: float, unit: deg/s, formula: raw*57.295779513}
      - {at: 163, bits: 64, name: Angle, type: float, unit: deg, formula: raw*57.295779513 - 1e-3, min: -180, max: 180}
      - {at: 230, bits: 32, name: Squares, type: float, formula: raw^2}
      - {at: 264, bits: 8, name: Levels, type: uint, count: 4, unit: V, formula: "raw/100 + raw^2/1000"}
      - {at: 296, bits: 32, name: Rates, type: float, count: 3, unit: deg/s, formula: raw/3 + 0.1, byte_order: big}
      - {at: 392, bits: 8, name: Both Ways, type: int, formula: raw^2 - 3}
      - {at: 0, bits: 8, name: Low, type: uint, unit: V, formula: raw^3/1000, view: true}
      - {at: 400, bits: 7, name: Cubes, type: int, formula: raw^3, special: [{value: -64, meaning: Not known}]}
      - {at: 407, bits: 1, name: One, type: uint, formula: 3*raw^2 + 1}
      - {at: 408, bits: 32, name: Inverse, type: float, formula: raw = value*1000}
      - {at: 440, bits: 16, name: Constant, type: uint, formula: 0.5*raw^2 + raw, const: 8}
  - name: Tables
    set_id: 21
    get_id: 31
    kind: configuration
    length: 82
    fields:
      - {at: 0, bits: 10, name: Thermistor, type: uint, unit: C, points: [[0, -40], [512, 20.5], [1023, 125]], min: 0}
      - {at: 11, bits: 12, name: Falling, type: int, unit: V, points: [[-2000, 5.1], [-1, 0.3], [7, 0.1], [1800, -3]],
         outside: clamp, byte_order: big}
      - {at: 24, bits: 16, name: Within, type: uint, unit: V, points: [[10.5, "-1e-3"], [2000, 1.0e+2], [60000.25, 7000.1]],
         outside: refuse}
      - {at: 40, bits: 16, name: Beyond, type: int, points: [["-1e3", -0.7], [0.3, 1], [10, 1.1]], outside: extrapolate}
      - {at: 56, bits: 8, name: Wave, type: uint, points: [[3, 1], [10, 0], [20.5, 5]], outside: clamp}
      - {at: 64, bits: 32, name: Wide, type: uint, unit: V, points: [[100, 1], [4000000000, 3]], outside: refuse}
      - {at: 96, bits: 64, name: Widest, type: int, points: [["-9e18", 1], [0, 0.1], [4503599627370497, 5]], outside: extrapolate}
      - {at: 163, bits: 32, name: Flow, type: float, unit: V, points: [[-1.5, 3], [0, 4], [0.1, -7.3]], outside: clamp, max: 5}
      - {at: 200, bits: 64, name: Refused, type: float, points: [["-1e300", 0], [0.1, 4], ["1e300", -7]], outside: refuse}
      - {at: 264, bits: 64, name: Steep, type: float, points: [[0, 0], ["1e-300", 1], [1, "1e300"]], outside: extrapolate}
      - {at: 328, bits: 8, name: Levels, type: uint, count: 4, unit: V, points: [[0, 0], [100, 2.5], [255, 9]]}
      - {at: 360, bits: 32, name: Flows, type: float, count: 3, unit: V, points: [[0, 1], [1, 3]], outside: refuse, byte_order: big}
      - {at: 456, bits: 8, name: Depths, type: int, count: 5, unit: V, points: [[-100, 7], [0, 0.1], [50, -9.3]], outside: clamp}
      - {at: 0, bits: 8, name: Low, type: uint, unit: V, points: [[1, 1], [250, 3.3]], outside: refuse, view: true}
      - {at: 496, bits: 7, name: Named, type: int, points: [[-64, 0], [-1, 0.5], [63, 0.25]],
         special: [{value: -64, meaning: Not known}]}
      - {at: 503, bits: 1, name: One, type: uint, points: [[0, 3], [1, 1]]}
      - {at: 504, bits: 16, name: Constant, type: uint, points: [[0, 3], [8, 1.5]], outside: clamp, const: 8}
      - {at: 520, bits: 16, name: Edges, type: int, points: [[-32768, 0], [32767, 1]]}
      - {at: 536, bits: 16, name: Outer, type: uint, points: [[-10, 1], [70000, 2]], outside: refuse}
      - {at: 552, bits: 8, name: Elsewhere, type: uint, points: [[300, 1], [400, 2]], outside: clamp}
      - {at: 560, bits: 32, name: Sent Float, type: float, points: [[-1, 1], [1, 1.5], ["2e38", 4]], outside: extrapolate}
      - {at: 592, bits: 64, name: All, type: uint, points: [[0, 0.1], ["18446744073709551615", 7]]}
  - name: Derived
    set_id: 22
    get_id: 32
    kind: configuration
    length: 62
    fields:
      - {at: 0, bits: 32, name: Lon, type: int, unit: deg, formula: raw*1e-7}
      - {at: 32, bits: 8, name: Lon HP, type: int, unit: deg, formula: raw*1e-9, byte_order: big}
      - {at: 40, bits: 16, name: Scale, type: int, byte_order: big}
      - {at: 56, bits: 3, name: Few, type: uint, const: 5}
      - {at: 59, bits: 12, name: W, type: uint}
      - {at: 72, bits: 32, name: Rate, type: float}
      - {at: 104, bits: 64, name: Wide, type: float, byte_order: big}
      - {at: 168, bits: 64, name: Most, type: uint}
      - {at: 232, bits: 64, name: Least, type: int, unit: V}
      - {at: 299, bits: 33, name: Message, type: uint, unit: V, formula: raw/3}
      - {at: 336, bits: 16, name: C/N0, type: uint, unit: C, formula: 3e-6*raw^2 - 40}
      - {at: 352, bits: 16, name: C, type: int, unit: C, points: [[-100, 7], [0, 0.1], [50, -9.3]], outside: refuse}
      - {at: 368, bits: 32, name: Flow, type: float, unit: m/s, formula: raw*57.295779513}
      - {at: 400, bits: 8, name: step 1, type: int}
      - {at: 408, bits: 8, name: 2D, identifier: plane, type: int}
      - {at: 416, bits: 8, name: power, type: uint, unit: W, formula: raw*0.1}
      - {at: 424, bits: 64, name: Wrapped, type: uint, formula: raw*1e-30}
      - {at: 488, bits: 8, name: Octave, type: uint}
      - {at: 48, bits: 8, name: Seen, type: int, view: true, unit: V, formula: raw*0.01}
      - {at: 80, bits: 16, name: Within, type: uint, view: true}
    derived:
      - {name: Longitude, unit: deg, formula: Lon + Lon HP}
      - {name: Power, identifier: derived power, unit: W, formula: W*10^Scale}
      - {name: Sign, formula: -W}
      - {name: Same, formula: Wide}
      - {name: Quotient, formula: Rate/Wide - 2D/step 1, unit: V}
      - {name: Powers, formula: "Rate^3 - Wide^-2 + (Lon - 1)^15"}
      - {name: Numbers, formula: "2/3*W + 10^-3*Few - 2^70 + 1e-40*Most"}
      - {name: Long, formula: Most - Least}
      - {name: Mixed, identifier: derived mix, formula: "C/N0*(C + Flow) - Message/power"}
      - {name: Again, formula: Longitude*Longitude - Same/Sign, unit: deg}
      - {name: Views, formula: Seen*Within + Seen}
      - {name: Nothing, formula: "(W - W)/(W - W) + Rate"}
      - {name: Bases, formula: "Rate^Scale + Wrapped*1e30 + (Least/Most)^Octave + 1.0000001^W"}
      - {name: Nested, formula: "((Lon + (1 - Lon HP))*2 - (3 + (W*Few)))/(Lon*(2 - Rate))"}
  - name: Mixed
    id: 7
    kind: telecommand
    length: 18
    byte_order: big
    bit_order: msb0
    fields:
      - {at: 5, bits: 11, name: Eleven, type: uint, formula: raw/4}
      - {at: 16, bits: 64, name: Eight Bytes, type: float}
      - {at: 81, bits: 63, name: Sixty Three, type: int}
"""

OTHER = """\
icdgen: 1
node: {name: other, title: The other mixed order, byte_order: big, bit_order: lsb0}
messages:
  - name: Other
    id: 255
    kind: telemetry
    length: 9
    fields:
      - {at: 2, bits: 23, name: A, type: int, formula: raw*0.0000001}
      - {at: 25, bits: 40, name: B, type: uint}
      - {at: 65, bits: 7, name: C, type: int}
  - name: Printed factors
    kind: configuration
    set_id: 1
    get_id: 254
    length: 52
    fields:
      - {at: 0, bits: 64, name: Smallest, type: uint, formula: raw*2^-66}
      - {at: 64, bits: 64, name: Both Ways, type: int, formula: raw*4.656612873077393e-10 + 273.15}
      - {at: 128, bits: 32, name: Downward, type: int, formula: 40 - raw*1e-19}
      - {at: 160, bits: 16, name: Large, type: uint, formula: "(raw + 2^-20)*123456789012345678901234567890"}
      - {at: 176, bits: 8, name: Tiny, type: int, formula: raw*2^-180}
      - {at: 184, bits: 5, name: Narrow, type: int, formula: raw*1.2345678901234567e-22 - 2^60}
      - {at: 189, bits: 31, name: Long Fraction, type: uint, formula: -raw/3^100}
      - {at: 224, bits: 64, name: Ends, type: int, formula: raw*2^180/(2^179 - 1) + 2^40}
      - {at: 288, bits: 64, name: Half, type: uint, formula: (raw - 2^63)*2^-67}
      - {at: 352, bits: 64, name: Turned, type: uint, formula: -raw*2^177 + 2^200}
"""

WIDE = """\
icdgen: 1
node: {name: wide, title: Wide ids, byte_order: little, bit_order: lsb0, id_bits: 32}
enums:
  - name: Turn
    members: [{value: -5, name: Left}, {value: 100, name: Right}, {value: -100, to: -50, name: Away},
              {value: 10, to: 12, name: Near}]
structs:
  - name: Odd
    length: 9
    fields:
      - {at: 0, bits: 12, name: Type, type: int, formula: raw*0.5}
      - {at: 12, bits: 1, count: 4, name: Flags, type: bool}
      - {at: 16, bits: 8, name: Turn, type: enum, enum: Turn, const: -5}
      - {at: 24, bits: 16, count: 2, name: Words, type: uint, unit: V, formula: raw*0.1, max: 6000}
      - {at: 56, bits: 8, name: Str, identifier: a str, type: text}
      - {at: 64, bits: 8, name: Octet, type: bytes}
  - name: Nested
    length: 40
    summary: A struct within a struct, and what crosses bytes.
    fields:
      - {at: 0, name: Match, struct: Odd, count: 2}
      - {at: 147, bits: 32, name: Across, type: float, special: [{value: nan, meaning: none}, {value: -1.5, meaning: left}]}
      - {at: 184, bits: 32, name: Whole Float, type: float, byte_order: big, formula: raw*57.29578}
      - {at: 216, bits: 64, name: Longest, type: int, special: [{value: -9223372036854775808, meaning: none}]}
      - {at: 282, bits: 3, count: 3, name: Crossing, type: uint, byte_order: big, formula: raw^3 - 9*raw}
      - {at: 296, bits: 8, count: 2, name: Turns, type: enum, enum: Turn}
  - name: Row
    length: 40
    fields:
      - {at: 0, bits: 32, count: 9, name: Floats, type: float}
      - {at: 288, bits: 8, name: One, type: uint, formula: raw^2 + raw*0.5}
messages:
  - name: Structs
    id: 0x01020308
    kind: telemetry
    length: 180
    fields:
      - {at: 0, name: First, struct: Odd}
      - {at: 72, bits: 3, name: Between, type: int}
      - {at: 80, name: Nests, struct: Nested, count: 2}
      - {at: 720, name: Fn, struct: Row, count: 1}
      - {at: 1040, bits: 32, name: Aligned, type: float}
      - {at: 1040, bits: 8, name: View, type: uint, view: true}
      - {at: 1072, name: Odds, struct: Odd, count: 4}
      - {at: 1360, name: Last, struct: Odd}
      - {at: 1432, bits: 8, name: End, type: uint}
  - name: Turned Structs
    set_id: 0x01020309
    get_id: 0x0102030A
    kind: configuration
    length: 50
    byte_order: big
    bit_order: msb0
    fields:
      - {at: 0, name: Nest, struct: Nested}
      - {at: 320, name: Odd, identifier: other odd, struct: Odd, count: 1}
      - {at: 392, bits: 8, name: End, type: uint}
  - name: Wide
    id: [0x12, 0x34, 0x56, 0x78]
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: A, type: uint}
  - name: Orders
    id: 0x01020304
    kind: telecommand
    length: 32
    fields:
      - {at: 0, bits: 12, name: Big Bits, type: int, byte_order: big, bit_order: msb0, formula: raw*0.5}
      - {at: 8, bits: 4, name: Low Half, type: uint}
      - {at: 16, bits: 16, name: Big Word, type: uint, byte_order: big}
      - {at: 32, bits: 24, name: Big Three, type: int, byte_order: big}
      - {at: 56, bits: 32, name: Big Float, type: float, byte_order: big}
      - {at: 88, bits: 32, name: Little Float, type: float}
      - {at: 120, bits: 64, name: Big Long, type: int, byte_order: big}
      - {at: 187, bits: 3, name: Turned Bits, type: uint, bit_order: msb0}
      - {at: 184, bits: 2, name: Straight Bits, type: uint}
      - {at: 192, bits: 64, name: Big Double, type: float, byte_order: big}
  - name: Arrays
    id: 0x01020306
    kind: telemetry
    length: 119
    fields:
      - {at: 0, bits: 16, count: 6, name: Type, type: int, unit: C, formula: raw*0.01, min: -20, max: 80}
      - {at: 96, bits: 12, count: 4, name: Big Bits, type: int, byte_order: big, bit_order: msb0, formula: raw*0.5}
      - {at: 144, bits: 1, count: 8, name: Flags, type: bool}
      - {at: 152, bits: 1, count: 4, name: Few Flags, type: bool, bit_order: msb0}
      - {at: 156, bits: 2, count: 2, name: Between, type: uint, bit_order: msb0}
      - {at: 160, bits: 32, count: 3, name: Floats, type: float}
      - {at: 256, bits: 64, count: 2, name: Big Doubles, type: float, byte_order: big}
      - {at: 384, bits: 24, count: 2, name: Threes, type: uint, formula: raw*1e-25}
      - {at: 432, bits: 8, count: 40, name: Octets, type: uint, special: [{value: 255, meaning: unknown}]}
      - {at: 752, bits: 16, count: 1, name: One, type: uint, const: 7}
      - {at: 768, bits: 16, count: 2, name: Big Words, type: uint, byte_order: big}
      - {at: 803, bits: 8, count: 3, name: Crossing, type: uint}
      - {at: 827, bits: 32, count: 2, name: Crossing Floats, type: float}
      - {at: 896, bits: 8, count: 7, name: Small, type: int}
  - name: Keywords
    id: 0x01020305
    kind: telecommand
    length: 12
    reserved: 3
    fields:
      - {at: 0, bits: 16, name: Type, type: int, unit: V, formula: raw*0.1}
      - {at: 16, bits: 3, name: Match, type: uint}
      - {at: 19, bits: 1, name: Fn, type: bool}
      - {at: 20, bits: 12, name: Mod, type: uint, byte_order: big}
      - {at: 32, bits: 32, name: Loop, type: float}
      - {at: 64, bits: 8, name: Impl, type: bytes}
  - name: Texts
    id: 0x01020306
    kind: telecommand
    length: 45
    reserved: 2
    fields:
      - {at: 0, bits: 8, name: Str, identifier: one str, type: text}
      - {at: 8, bits: 320, name: 'Odd "name" \\ */', identifier: odd name, type: text}
      - {at: 328, bits: 16, name: Text, type: text}
  - name: Views
    id: 0x01020307
    kind: telecommand
    length: 27
    reserved: 1
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 0, bits: 24, name: Seen before it is there, type: int, view: true, byte_order: big, formula: raw*0.1, unit: V}
      - {at: 8, bits: 16, name: Rate, type: int, byte_order: big, const: -7}
      - {at: 24, bits: 5, name: Narrow, type: uint}
      - {at: 29, bits: 3, name: Rest, type: int, formula: raw*2^-70}
      - {at: 28, bits: 1, name: Top of it, identifier: type, type: bool, view: true}
      - {at: 25, bits: 7, name: Across, type: int, view: true, special: [{value: -64, meaning: none}], min: -10.5}
      - {at: 32, bits: 64, name: Eight bytes, type: float}
      - {at: 36, bits: 60, name: Within a double, type: uint, view: true, bit_order: msb0, byte_order: big}
      - {at: 64, bits: 32, name: Half a double, type: float, view: true, byte_order: big}
      - {at: 96, bits: 64, name: Eight, type: text}
      - {at: 97, bits: 63, name: Long, type: int, view: true, formula: raw*1e-19 + 3}
      - {at: 96, bits: 64, name: Real, type: float, view: true, special: [{value: nan, meaning: not known}]}
      - {at: 160, bits: 32, name: Four bytes, type: float}
      - {at: 160, bits: 32, name: Its bits, type: uint, view: true, formula: raw*0.5}
      - {at: 191, bits: 1, name: Its sign, type: uint, view: true}
      - {at: 192, bits: 16, name: Seconds, type: uint}
      - {at: 200, bits: 8, name: Two of them, type: enum, enum: Turn, view: true, special: [{value: 7, meaning: odd}]}
      - {at: 195, bits: 9, name: Wider than them, type: enum, enum: Turn, view: true}
  - {name: Lowest byte of it, id: 0x78, kind: telemetry, length: 0}
  - {name: Lowest half of it, id: 0x5678, kind: telemetry, length: 0}
  - {name: Without its highest bit, id: 0x7FFFFFFF, kind: telecommand, length: 0}
  - {name: All ones, set_id: 0xFFFFFFFF, get_id: 0xFFFFFFFF, kind: configuration, length: 0}
"""

COMMON = """\
icdgen: 1
node: {name: common, title: Included, byte_order: big, bit_order: msb0, id_bits: 16}
messages:
  - name: Any command
    id: 0x004C
    kind: telecommand
    length: 6
    fields:
      - {at: 0, bits: 16, name: Command, type: uint}
      - {at: 16, bits: 32, name: Parameter, type: float}
  - name: Reset command
    id: 0x004C
    kind: telecommand
    length: 6
    fields:
      - {at: 0, bits: 16, name: Command, type: uint, const: 0x1234}
      - {at: 16, bits: 32, name: Delay, type: uint, unit: s, formula: raw*0.001}
  - name: Short command
    id: 0x004C
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 16, name: Command, type: uint, const: 0x1234}
"""

APART = """\
icdgen: 1
node: {name: apart, title: Ids that are shared, byte_order: little, bit_order: lsb0, id_bits: 16}
include: [common.yaml]
enums:
  - name: Action
    members: [{value: -2, name: Stop}, {value: 1, name: Go}]
structs:
  - name: Step
    length: 3
    fields:
      - {at: 0, bits: 8, name: Mark, type: uint, const: 7}
      - {at: 8, bits: 16, name: Value, type: int, formula: raw*0.25}
messages:
  - name: Arm command
    id: 0x004C
    kind: telecommand
    length: 6
    fields:
      - {at: 0, bits: 16, name: Command, type: uint, const: 0x5678, byte_order: big}
      - {at: 16, bits: 32, name: Key, type: uint}
  - name: Arm at once
    id: 0x004C
    kind: telecommand
    length: 6
    fields:
      - {at: 0, bits: 16, name: Command, type: uint, const: 0x5678, byte_order: big}
      - {at: 16, bits: 32, name: Key, type: uint, const: 0}
  - name: Aiding, first version
    id: [0x13, 0x00]
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 8, name: Same everywhere, type: uint, const: 9}
      - {at: 8, bits: 3, name: Version, type: uint, const: 1}
      - {at: 11, bits: 9, name: Signed one, type: int, const: -3}
      - {at: 20, bits: 20, name: Angle, type: int, unit: deg, formula: raw*0.01}
  - name: Aiding, second version
    id: [0x13, 0x00]
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 8, name: Same everywhere, type: uint, const: 9}
      - {at: 8, bits: 3, name: Version, type: uint, const: 2}
      - {at: 11, bits: 9, name: Signed one, type: int, const: 3}
      - {at: 20, bits: 20, name: Angle, type: uint, unit: rad, formula: raw*0.001}
  - name: Aiding, longer
    id: [0x13, 0x00]
    kind: telemetry
    length: 8
    fields:
      - {at: 0, bits: 8, name: Same everywhere, type: uint, const: 9}
      - {at: 8, bits: 16, count: 2, name: Words, type: uint, const: 0x0102}
      - {at: 40, bits: 24, name: Rest, type: bytes}
  - name: Longer with an action
    id: [0x13, 0x00]
    kind: telemetry
    length: 8
    fields:
      - {at: 0, bits: 8, name: Same everywhere, type: uint, const: 9}
      - {at: 8, bits: 16, name: First word, type: uint}
      - {at: 24, bits: 16, name: Second word, type: uint, const: 0x0103}
      - {at: 45, bits: 5, name: Turned, type: enum, enum: Action, bit_order: msb0, const: -2}
      - {at: 56, bits: 8, name: Rest, type: uint}
  - {name: Poll, id: 0x0601, kind: telecommand, length: 0}
  - name: Settings
    set_id: 0x0601
    get_id: 0x0602
    kind: configuration
    length: 2
    fields:
      - {at: 0, bits: 8, name: Version, type: uint, const: 0}
      - {at: 8, bits: 8, name: Rate, type: uint, unit: Hz}
  - name: Other settings
    set_id: 0x0601
    get_id: 0x0602
    kind: configuration
    length: 2
    fields:
      - {at: 0, bits: 8, name: Version, type: uint, const: 1}
      - {at: 8, bits: 8, name: Rate, type: int, unit: Hz}
  - name: Open, first version
    id: 0x1500
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 12, name: Version, type: int, const: -1}
      - {at: 16, bits: 8, name: Values Count, type: uint}
      - {at: 24, bits: 16, name: Values, type: int, count: Values Count, up_to: 5, byte_order: big}
  - name: Open, second version
    id: 0x1500
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 12, name: Version, type: int, const: 2}
      - {at: 16, bits: 24, name: Values, type: uint, count: rest, up_to: 3, const: 0x010203}
  - name: Open, third version
    id: 0x1500
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 12, name: Version, type: int, const: 3}
      - {at: 16, name: Remark, type: text, size: rest, up_to: 20}
  - name: Open, closed
    id: 0x1500
    kind: telemetry
    length: 7
    reserved: 5
    fields:
      - {at: 0, bits: 12, name: Version, type: int, const: 4}
  - name: Open, any other
    id: 0x1500
    kind: telemetry
    length: 2
    fields: [{at: 16, name: Data, type: bytes, size: rest, up_to: 9}]
  - name: Fours from none
    id: 0x1501
    kind: telecommand
    length: 0
    fields: [{at: 0, bits: 32, name: Values, type: float, count: rest, up_to: 3}]
  - name: Fours from two
    id: 0x1501
    kind: telecommand
    length: 2
    fields: [{at: 16, bits: 32, name: Values, type: uint, count: rest, up_to: 2}]
  - {name: No fours, id: 0x1501, kind: telecommand, length: 7, reserved: 7}
  - name: Ends early
    id: 0x1502
    kind: telemetry
    length: 8
    may_end_early: zeros
    fields:
      - {at: 0, bits: 24, name: Value, type: uint}
      - {at: 28, bits: 12, name: Command, type: uint, const: 0x178}
      - {at: 40, bits: 24, name: Rest, type: uint}
  - name: Ends early, command of zeros
    id: 0x1502
    kind: telemetry
    length: 9
    may_end_early: zeros
    fields:
      - {at: 0, bits: 24, name: Value, type: uint}
      - {at: 28, bits: 12, name: Command, type: uint, const: 0}
      - {at: 40, bits: 32, name: Rest, type: float}
  - name: Ends early, any command
    id: 0x1502
    kind: telemetry
    length: 8
    may_end_early: zeros
    reserved: 3
    fields: [{at: 0, bits: 40, name: Value, type: bytes}]
  - name: Steps
    id: 0x1503
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Type, type: uint, const: 1}
      - {at: 8, bits: 8, name: Steps Count, type: uint}
      - {at: 16, name: Steps, struct: Step, count: Steps Count, up_to: 3}
  - name: State
    id: 0x1503
    kind: telemetry
    length: 5
    fields:
      - {at: 0, bits: 8, name: Type, type: uint, const: 2}
      - {at: 8, bits: 8, name: Mode, type: uint}
      - {at: 16, bits: 8, name: Rate, type: int, const: 5, when: {Mode: 0}}
      - {at: 16, bits: 16, name: Torque, type: int, formula: raw*0.5, when: {Mode: [1, 2], Type: 2}}
      - {at: 32, bits: 8, name: Load, type: uint, when: {Type: 2}}
  - name: Any other state
    id: 0x1503
    kind: telemetry
    length: 5
    reserved: 2
    fields:
      - {at: 0, bits: 8, name: Type, type: uint}
      - {at: 8, bits: 8, name: Mode, type: uint}
      - {at: 16, bits: 8, name: Rate, type: int, const: 4, when: {Mode: 0}}
  - {name: Alone, id: 0x0107, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: A, type: uint, const: 5}]}
"""

NESTED = """\
icdgen: 1
node: {name: nested, title: Structs of another node, byte_order: big, bit_order: msb0, id_bits: 32}
include: [wide.yaml]
structs:
  - name: Around
    length: 52
    fields:
      - {at: 0, name: Nest, struct: Nested}
      - {at: 328, name: Odd, struct: Odd}
      - {at: 400, bits: 12, name: Twelve, type: uint, bitfields: [{at: 0, bits: 4, name: Low}, {at: 4, bits: 8, name: High}]}
messages:
  - name: Around
    id: 0x02000000
    identifier: all around
    kind: telecommand
    length: 105
    fields:
      - {at: 0, name: Around, struct: Around, count: 2}
      - {at: 832, bits: 8, name: End, type: int}
"""

OPEN = """\
icdgen: 1
node: {name: open, title: Messages of variable length, byte_order: big, bit_order: msb0}
structs:
  - name: Inner
    length: 5
    fields:
      - {at: 0, bits: 12, name: Type, type: int, unit: V, formula: raw*0.25 - 3}
      - {at: 12, bits: 1, count: 4, name: Flags, type: bool}
      - {at: 16, bits: 16, name: Gauge, type: enum, enum: Gauge}
      - {at: 32, bits: 8, name: Text, type: text}
  - name: Element
    length: 24
    fields:
      - {at: 0, name: Match, struct: Inner, count: 2}
      - {at: 80, bits: 32, name: Loop, type: float, formula: raw*2.5, special: [{value: nan, meaning: none}]}
      - {at: 114, bits: 10, name: Across, type: uint, byte_order: little, bit_order: lsb0, formula: raw^2 - 1}
      - {at: 128, bits: 16, count: 2, name: Pair, type: int, const: 1}
      - {at: 163, bits: 5, name: Low, type: uint, const: 3}
      - {at: 168, bits: 24, name: Wide, type: int, byte_order: little, formula: raw*2^-70}
  - name: Label
    length: 9
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 32, name: Words, type: text, count: 2}
enums:
  - name: Gauge
    members: [{value: 1, name: First}, {value: 300, name: Last},
              {value: 2, to: 255, name: "Between \\" */"}, {value: 400, to: 401, name: Two}]
  - name: Narrow Gauge
    members: [{value: -1, name: Before}, {value: 1, name: After}]
messages:
  - name: Counted
    id: 130
    kind: telemetry
    length: 4
    fields:
      - {at: 0, bits: 8, name: Size, type: uint}
      - {at: 8, bits: 6, name: Levels Count, type: uint, special: [{value: 12, meaning: all}]}
      - {at: 14, bits: 2, name: Gain, type: uint}
      - {at: 16, bits: 16, name: Rate, type: uint, unit: mA, formula: raw*0.1}
      - {at: 32, bits: 16, name: Type, type: int, count: Levels Count, up_to: 12, unit: V, formula: raw*0.01}
      - {at: 8, bits: 8, name: Both, type: uint, view: true}
  - name: Narrow
    id: 131
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 24, name: Samples, type: int, count: rest, up_to: 5, byte_order: little, formula: raw*2^-70}
  - name: Text
    id: 132
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 16, name: Severity, type: uint}
      - {at: 16, name: Match, type: text, size: rest, up_to: 80}
  - {name: Payload, id: 133, kind: telecommand, length: 0, fields: [{at: 0, name: Data, type: bytes, size: rest, up_to: 255}]}
  - name: Gauges
    id: 134
    kind: telecommand
    length: 2
    fields:
      - {at: 16, bits: 16, name: Gauges, type: enum, enum: Gauge, count: Gauges Count, up_to: 3}
      - {at: 0, bits: 16, name: Gauges Count, type: uint, byte_order: little}
  - name: Floats
    id: 135
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 32, name: Values, type: float, count: rest, up_to: 4, special: [{value: inf, meaning: too much}]}
  - name: Octets
    kind: configuration
    set_id: 7
    get_id: 136
    length: 9
    fields:
      - {at: 0, bits: 64, name: Number, type: uint}
      - {at: 72, bits: 8, name: Octets, type: uint, count: Number, up_to: 200, const: 3}
  - {name: Lengthy, id: 137, kind: telemetry, length: 0, fields: [{at: 0, bits: 8, name: Fn, type: uint, count: rest, up_to: 300}]}
  - name: Doubles
    id: 138
    kind: telemetry
    length: 0
    fields: [{at: 0, bits: 64, name: Values, type: float, count: rest, up_to: 1, special: [{value: -inf, meaning: too little}]}]
  - name: Fives
    id: 139
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: One, type: uint, const: 9}
      - {at: 8, bits: 40, name: Fives, type: uint, count: rest, up_to: 2, min: 4, special: [{value: 1099511627775, meaning: none}]}
  - name: Open Structs
    id: 141
    kind: telecommand
    length: 3
    fields:
      - {at: 0, bits: 16, name: Time, type: uint}
      - {at: 16, bits: 6, name: Number, type: uint}
      - {at: 24, name: Match, struct: Element, count: Number, up_to: 3}
  - name: Turned Structs
    set_id: 142
    get_id: 143
    kind: configuration
    length: 0
    byte_order: little
    bit_order: lsb0
    fields: [{at: 0, name: Inners, struct: Inner, count: rest, up_to: 3}]
  - name: Sized Text
    id: 144
    kind: telecommand
    length: 3
    fields:
      - {at: 0, bits: 4, name: Kind, type: uint}
      - {at: 4, bits: 10, name: Fn, type: uint}
      - {at: 24, name: Ref, type: text, size: Fn, up_to: 300}
  - name: Sized with its head
    id: 145
    kind: telemetry
    length: 4
    fields:
      - {at: 16, bits: 16, name: Octets Count, type: uint, byte_order: little}
      - {at: 0, bits: 16, name: Number, type: int}
      - {at: 32, name: Data, type: bytes, size: {field: Octets Count, plus: -4}, up_to: 40}
  - name: At least two
    id: 146
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 3, name: Last, type: uint}
      - {at: 8, bits: 24, name: Values, type: int, count: {field: Last, plus: 2}, up_to: 6, const: -3, formula: raw*0.25}
  - name: Structs and one
    id: 147
    kind: telecommand
    length: 2
    fields:
      - {at: 0, bits: 8, name: Last, type: uint}
      - {at: 16, name: Elements, struct: Element, count: {field: Last, plus: 1}, up_to: 3}
  - name: Structs but three
    id: 148
    kind: telemetry
    length: 2
    fields:
      - {at: 8, bits: 8, name: Last, type: uint}
      - {at: 16, name: Elements, struct: Inner, count: {field: Last, plus: -3}, up_to: 2}
  - name: Text of one and more
    id: 149
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 8, name: Last, type: uint}
      - {at: 8, name: Word, type: text, size: {field: Last, plus: 1}, up_to: 12}
  - name: Rows
    id: 150
    kind: telecommand
    length: 100
    fields:
      - {at: 0, bits: 64, name: Words, type: text, count: 4}
      - {at: 256, bits: 16, name: Pairs, type: bytes, count: 3}
      - {at: 304, bits: 240, name: Longer, type: text, count: 2}
      - {at: 784, bits: 8, name: Data, type: bytes, count: 1}
      - {at: 792, bits: 1, name: Flag, type: bool, count: 3}
  - name: Wide Rows
    id: 151
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, bits: 320, name: Extensions, type: text, count: rest, up_to: 3}
  - name: Counted Rows
    id: 152
    kind: telecommand
    length: 1
    fields:
      - {at: 0, bits: 2, name: Last, type: uint}
      - {at: 8, bits: 24, name: Rows, type: bytes, count: {field: Last, plus: 1}, up_to: 3}
  - name: Rows in structs
    id: 153
    kind: telemetry
    length: 1
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 8, name: Labels, struct: Label, count: Number, up_to: 2}
  - name: Two open parts
    id: 154
    kind: telemetry
    length: 4
    fields:
      - {at: 3, bits: 9, name: Number, type: uint, byte_order: little, bit_order: lsb0}
      - {at: 12, bits: 4, name: Last, type: uint, byte_order: little, bit_order: lsb0}
      - {at: 16, bits: 16, name: Match, type: int, unit: V, formula: raw*0.01}
      - {at: 32, bits: 24, name: Values, type: int, count: Number, up_to: 5, formula: raw*0.25}
      - {at: 32, name: Elements, struct: Element, after: Values, count: {field: Last, plus: 1}, up_to: 3}
      - {at: 20, bits: 6, name: Both, type: uint, view: true}
  - name: Three and what comes
    id: 155
    kind: telecommand
    length: 3
    fields:
      - {at: 0, bits: 8, name: Inner, type: uint}
      - {at: 8, bits: 8, name: Between, type: uint}
      - {at: 16, bits: 8, name: To, type: uint}
      - {at: 24, bits: 8, name: There, type: uint, count: Inner, up_to: 4, const: 3}
      - {at: 24, name: Actual, type: bytes, after: There, size: {field: Between, plus: -2}, up_to: 9}
      - {at: 24, name: Output, type: text, after: Actual, size: To, up_to: 200}
      - {at: 24, name: Buffer, struct: Inner, after: Output, count: rest, up_to: 2}
  - name: Cut Off
    id: 140
    kind: telemetry
    length: 23
    may_end_early: zeros
    reserved: 2
    fields:
      - {at: 0, bits: 12, name: Input, type: int, unit: V, formula: raw*0.01}
      - {at: 12, bits: 4, name: Length, type: uint, const: 5}
      - {at: 16, bits: 32, name: Value, type: float}
      - {at: 48, bits: 8, name: Gauge, type: enum, enum: Narrow Gauge}
      - {at: 56, bits: 40, name: Words, type: text}
      - {at: 96, bits: 16, name: Buffer, type: int, count: 3, byte_order: little}
      - {at: 144, bits: 1, name: Flag, type: bool, count: 8}
      - {at: 152, bits: 16, name: Whole, type: bytes}
      - {at: 88, bits: 24, name: Both, type: uint, view: true}
  - name: Two
    set_id: 8
    get_id: 141
    kind: configuration
    length: 2
    may_end_early: zeros
    fields: [{at: 3, bits: 9, name: Whole, type: uint}]
"""

MUX = """\
icdgen: 1
node: {name: mux, title: Fields that are not always there, byte_order: big, bit_order: msb0}
enums:
  - name: State
    members: [{value: -2, name: Stopped}, {value: 0, name: Idle}, {value: 3, name: Turning}]
messages:
  - name: Multiplexed
    id: 10
    kind: telemetry
    length: 9
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, bits: 12, name: Rate, type: int, unit: deg/s, formula: raw*0.25, when: {Mode: 0}}
      - {at: 8, bits: 16, name: Angle, type: uint, unit: deg, formula: raw*0.01, when: {Mode: [1, 2]}}
      - {at: 8, bits: 32, name: Speed, type: float, when: {Mode: 7}}
      - {at: 20, bits: 4, name: Rest, type: uint, when: {Mode: 0}, const: 5}
      - {at: 24, bits: 8, name: Turned, type: enum, enum: State, when: {Mode: [0, 2]}, byte_order: little}
      - {at: 40, bits: 1, name: Flag, type: bool}
      - {at: 41, bits: 1, name: Is Fast, type: bool, when: {Flag: true, Mode: [1, 3]}}
      - {at: 41, bits: 6, name: Slow, type: uint, when: {Flag: false}}
      - {at: 48, bits: 3, name: State, type: enum, enum: State}
      - {at: 51, bits: 21, name: Idle Time, type: uint, unit: s, formula: "3 + raw/50 + 3e-6*raw^2", when: {State: [Idle, Stopped]}}
      - {at: 51, bits: 9, name: On Count, type: int, min: -3, special: [{value: -256, meaning: none}], when: {State: Turning}}
      - {at: 0, bits: 7, name: Head, type: uint, view: true}
  - name: Choice
    set_id: 11
    get_id: 12
    kind: configuration
    length: 8
    may_end_early: zeros
    byte_order: little
    bit_order: lsb0
    fields:
      - {at: 0, bits: 62, name: Value, type: uint, when: {Type: 1}}
      - {at: 0, bits: 60, name: Longer, type: int, when: {Type: 2}, formula: raw*0.1}
      - {at: 62, bits: 2, name: Type, type: uint}
  - name: Floats
    id: 14
    kind: telecommand
    length: 9
    fields:
      - {at: 0, bits: 8, name: Mode, type: uint}
      - {at: 8, bits: 32, name: Always, type: float}
      - {at: 40, bits: 32, name: At Times, type: float, when: {Mode: 1}}
  - name: Flags
    id: 13
    kind: telemetry
    length: 2
    fields:
      - {at: 0, bits: 8, name: Page, type: uint}
      - {at: 8, bits: 1, name: Flag 0, type: bool, when: {Page: 0}}
      - {at: 9, bits: 1, name: Flag 1, type: bool, when: {Page: 0}}
      - {at: 10, bits: 1, name: Flag 2, type: bool, when: {Page: 0}}
      - {at: 11, bits: 1, name: Flag 3, type: bool, when: {Page: 0}}
      - {at: 12, bits: 1, name: Flag 4, type: bool, when: {Page: 1}}
      - {at: 13, bits: 1, name: Flag 5, type: bool, when: {Page: 1}}
"""

EMPTY = """\
icdgen: 1
node: {name: empty, title: No messages, byte_order: little, bit_order: lsb0}
"""


_TEXTS = {
    "shared": SHARED,
    "mixed": MIXED,
    "other": OTHER,
    "wide": WIDE,
    "nested": NESTED,
    "common": COMMON,
    "apart": APART,
    "open": OPEN,
    "mux": MUX,
    "empty": EMPTY,
}


def write(folder: Path) -> Path:
    """The folder, with the ICDs in it."""
    for name, text in _TEXTS.items():
        (folder / f"{name}.yaml").write_text(text, encoding="utf-8")
    return folder


def variable(folder: Path) -> list[Path]:
    """Files of messages of variable length, shared ids and conditions: odd ones, and devices of others."""
    write(folder)
    devices = Path(__file__).parent.parent.parent / "examples" / "devices"
    names = ("common", "apart", "open", "mux")
    return [
        *(folder / f"{name}.yaml" for name in names),
        *(devices / name / f"{name}.yaml" for name in ("mavlink", "ublox")),
    ]
