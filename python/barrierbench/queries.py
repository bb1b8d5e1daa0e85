"""The queries of `bench eval`, in this process."""

from __future__ import annotations

import json
from typing import Any

from . import _core
from .given import json_text


def evaluate(query: dict[str, Any]) -> dict[str, Any]:
    """The answer to one query, as `bench eval` gives it (configs/schema/eval.schema.json).

    Lists may be numpy arrays, and numbers numpy scalars. Errors: ConfigError with the text that is the answer's `error`
    there, and for what is no JSON.

    >>> query = {"kind": "match", "rule": "equal_force", "shape": "cubic", "d_hat": 0.01, "load": 1, "theta": 0.5}
    >>> evaluate(query)["kappa"]
    200.0
    """
    _, answer, _ = _core.evaluate_lines(json_text(query, "query") + "\n")
    found = json.loads(answer)
    if "error" in found:
        raise _core.ConfigError(found["error"])
    return found
