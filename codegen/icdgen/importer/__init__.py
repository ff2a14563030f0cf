"""A vendor's manual, PDF or text, to a reviewable ICD: ``icdgen import``."""
