"""Talking to a device: ports, and the wire layer that users of the Python runtime get, `icdgen_runtime`.

Importing this makes ``icdgen_runtime`` importable, from where it lies in the checkout or in the wheel.
"""

from icdgen import shipped

shipped.provide_runtime()
