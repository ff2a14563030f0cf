"""Links and messages of a model as objects of the Python runtime, without generated
code.

The simulator, links and logs of icdgen use the same runtime as generated code:
``links`` and ``messages`` make its objects from a model. The other modules are the
reference for conformance tests and golden vectors: ``reference.answer`` responds to
JSON requests. Importing this package makes the runtime importable as
``icdgen_runtime``, from the checkout or the wheel.
"""

from icdgen import shipped

shipped.provide_runtime()
