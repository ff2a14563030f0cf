"""`allows` reports whether a value is within the limits of a field.

The ICD declares whether the limits themselves are included (`min`) or not (`above`).
"""

from __future__ import annotations

from icdgen.loading import load
from tests.rust import harness
from tests.rust.tools import USED, Toolchain, run

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
messages:
  - name: Set
    id: 1
    kind: telecommand
    length: 16
    fields:
      - {at: 0,  bits: 32, name: At Least, type: float, min: 2}
      - {at: 32, bits: 32, name: Above, type: float, above: 2}
      - {at: 64, bits: 32, name: At Most, type: float, max: 2}
      - {at: 96, bits: 32, name: Below, type: float, below: 2}
"""

PROGRAM = """\
use icd::Message;

fn main() {
    let allowed = |name: &str, value: f64| {
        let field = icd::demo::Set::FIELDS.iter().find(|field| field.name == name);
        field.unwrap().allows(value)
    };
    for (name, values) in [
        ("At Least", [false, true, true]),
        ("Above", [false, false, true]),
        ("At Most", [true, true, false]),
        ("Below", [true, false, false]),
    ] {
        let results = [1.5, 2.0, 2.5].map(|value| allowed(name, value));
        assert_eq!(results, values, "{name} 2: whether 1.5, 2 and 2.5 are allowed");
        assert!(!allowed(name, f64::NAN), "{name}: NaN");
    }
}
"""


def test_a_limit_allows_its_own_value_unless_it_is_excluded(tmp_path):
    (tmp_path / "demo.yaml").write_text(ICD)
    loaded = load([tmp_path / "demo.yaml"])
    assert loaded.findings == []
    crate = harness.generate(loaded.icd, tmp_path / "crate")
    (tmp_path / "main.rs").write_text(PROGRAM)
    tools = Toolchain("default")
    library = tools.library(crate, *USED)
    run(tools.program(tmp_path / "main.rs", library, tmp_path / "main"))
