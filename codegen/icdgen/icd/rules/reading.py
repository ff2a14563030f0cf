"""Codes of findings that are raised before there is a model: by ``source``, ``schema`` and ``load``."""

from __future__ import annotations

from icdgen.icd.rules.rule import elsewhere

elsewhere("reading", "ICD001", "ICD002", "ICD003", "ICD004", "ICD010")
