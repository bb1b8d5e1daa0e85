"""The queries of `bench eval`, in this process."""

from __future__ import annotations

import json
from typing import Any

from . import _core


def evaluate(query: dict[str, Any]) -> dict[str, Any]:
    """The answer to one query, as `bench eval` gives it (configs/schema/eval.schema.json).

    Errors: ConfigError with the text that is the answer's `error` there.

    >>> query = {"kind": "match", "rule": "equal_force", "shape": "cubic", "d_hat": 0.01, "load": 1, "theta": 0.5}
    >>> evaluate(query)["kappa"]
    200.0
    """
    _, answer, _ = _core.evaluate_lines(json.dumps(query) + "\n")
    found = json.loads(answer)
    if "error" in found:
        raise _core.ConfigError(found["error"])
    return found
