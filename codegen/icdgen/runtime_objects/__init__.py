"""Links and messages of a model as objects of the Python runtime, without generated
code.

The simulator, links and logs of icdgen use the same runtime as generated code.
Importing this package makes the runtime importable as ``icdgen_runtime``, from the
checkout or the wheel.
"""

from icdgen import shipped

shipped.provide_runtime()
