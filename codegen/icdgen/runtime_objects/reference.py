"""Reference of links: responses to JSON requests, as used by golden vectors and
conformance tests.

``tests/conformance/README.md`` describes requests and responses. The Python runtime
computes the responses; the runtimes of other languages must respond equally.
"""

from __future__ import annotations

from typing import Any

from icdgen_runtime._errors import IcdError

from icdgen.icd.model import Icd, Node
from icdgen.runtime_objects.links import link_of_node
from icdgen.runtime_objects.operations import OPERATIONS, Operation
from icdgen.runtime_objects.procedures import procedure
from icdgen.runtime_objects.refusals import Refusal, details_of
from icdgen.runtime_objects.request_keys import Request, text
from icdgen.runtime_objects.scripts import client, stream_client

OPS: dict[str, Operation] = {
    operation.__name__: operation
    for operation in (*OPERATIONS, client, stream_client, procedure)
}


def answer(icd: Icd, request: Request) -> dict[str, Any]:
    """Return the response to a request.

    ``op`` must be one of `OPS`.
    """
    operation = OPS[request["op"]]
    try:
        node = _node(icd, request)
        return {"ok": True, **operation(link_of_node(icd, node), request)}
    except Refusal as refusal:
        return {"ok": False, **refusal.details}
    except IcdError as error:
        return {"ok": False, **details_of(error)}


def _node(icd: Icd, request: Request) -> Node:
    """Return the node in the request, by default the last node with a protocol
    section.
    """
    if "node" in request:
        name = text(request, "node")
        for node in icd.nodes:
            if node.name == name:
                return node
        raise Refusal("unknown-node")
    for node in reversed(icd.nodes):
        if icd.protocol_of(node):
            return node
    raise Refusal("unsupported")
