"""Links and messages of a model as objects of the Python runtime, without generating code.

The tool's own commands (simulator, links, logs) run on the runtime that users get. Importing this package makes the runtime
importable as ``icdgen_runtime`` from the checkout or the wheel.
"""

from icdgen import shipped

shipped.provide_runtime()
