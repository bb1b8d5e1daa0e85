"""The queries of `bench eval` in this process, and the same verb: python -m barrierbench.eval < queries."""

from __future__ import annotations

import json
import sys
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


def main(argv: list[str]) -> int:
    """The verb: queries from a file, or the standard input, to answers on the standard output; exit code 0, 2 or 75."""
    if argv == ["--schema"]:
        sys.stdout.write(_core.eval_schema())
        return 0
    try:
        return _core.run_eval(argv[0] if argv else "-")
    except _core.ConfigError as error:
        print(error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
