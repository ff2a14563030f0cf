"""Checks that the diff and the generated code agree about changes on the wire."""
