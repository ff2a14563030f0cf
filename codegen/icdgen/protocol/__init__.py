"""Protocol section of an ICD: keys and parts, and the facts of the links of a node.

`icdgen.protocol.facts.of` returns the facts. ``sections`` declares the parts of the
ICD, ``reading`` reads them; ``framed_links`` and ``packet_formats`` are about packets,
``responding`` and ``exchange`` about responses, ``procedure_steps`` and ``procedures``
about procedures: the first module of each pair reads the ICD, the second has the
classes of the result. The state machines of links are in the runtimes; the runtime of
Python is the reference.
"""
