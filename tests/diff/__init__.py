"""Tests of ``icdgen diff``, which compares two releases of ICDs."""
