"""Device's half of the procedures of a node, made from their steps.

`counterpart.Counterpart` takes the telecommands of the steps and fills in the telemetry
that they request. Vectors record their scripts with it, and the simulator is a device
with it. ``run`` has the state of one procedure, ``blocks`` and ``actions`` its kinds;
``effects`` has the objects, such as files, that procedures read and change.
"""

from icdgen import shipped

shipped.provide_runtime()
