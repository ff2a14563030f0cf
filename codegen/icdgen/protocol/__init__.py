"""Protocol section of an ICD: keys and parts, and the facts of the links of a node.

`icdgen.protocol.facts.of` returns the facts. The state machines of links are in the
runtimes; the runtime of Python is the reference.
"""
