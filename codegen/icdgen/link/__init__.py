"""Communication with devices: ports, and sessions of the Python runtime.

Importing this package makes the runtime importable.
"""

from icdgen import shipped

shipped.provide_runtime()
