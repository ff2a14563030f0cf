"""Comparing ICDs."""
