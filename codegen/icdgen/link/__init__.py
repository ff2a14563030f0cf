"""Talking to a device: ports, and sessions over them of the Python runtime, which importing this makes importable."""

from icdgen import shipped

shipped.provide_runtime()
