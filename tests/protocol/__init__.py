from __future__ import annotations

from hypothesis import HealthCheck, settings

quick = settings(
    max_examples=60, deadline=None, suppress_health_check=list(HealthCheck)
)
