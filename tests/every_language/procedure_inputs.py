"""Inputs of procedures: values of an enumeration that a field can and cannot store."""

from __future__ import annotations

from tests.conftest import ROOT
from tests.every_language.story import Claim, Story

PROCEDURE_INPUTS = Story(
    node="store",
    icd=(ROOT / "tests" / "procedures" / "wide_enumeration.yaml").read_text("utf-8"),
    c="icd_procedure_t procedure;\n",
    python="",
    rust="""\
use icd::store::enums::Mode;
use icd::store::procedures::Choose;
""",
    claims=(
        Claim(
            "a value of an enumeration that its field can have is accepted",
            c="CHECK(store_choose(&procedure, STORE_MODE_BUSY) == ICD_OK);\n",
            rust="assert!(Choose::new(Mode::Busy).is_ok());\n",
        ),
        Claim(
            "a value of an enumeration that its field cannot have is refused",
            c="CHECK(store_choose(&procedure, UINT64_C(0x100000001)) == ICD_ERROR_RANGE);\n",
            rust="""\
let error = Choose::new(Mode::from(0x1_0000_0001)).err();
assert!(matches!(error, Some(icd::wire::Error::Range { .. })), "{error:?}");
""",
        ),
    ),
)
