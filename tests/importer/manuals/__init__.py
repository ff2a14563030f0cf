"""Manuals drawn from ICDs, in layouts that differ in every property of a page."""
