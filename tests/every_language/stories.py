"""List of all stories. A new subject is a new entry."""

from __future__ import annotations

from tests.every_language.arrays import ARRAYS
from tests.every_language.composite_parts import composite_parts
from tests.every_language.optional_fields import OPTIONAL_FIELDS
from tests.every_language.procedure_inputs import PROCEDURE_INPUTS
from tests.every_language.structs import STRUCTS
from tests.every_language.variable_length import VARIABLE_LENGTH

STORIES = (
    ARRAYS,
    STRUCTS,
    OPTIONAL_FIELDS,
    VARIABLE_LENGTH,
    composite_parts(),
    PROCEDURE_INPUTS,
)
