"""What the program starts when it meets a formula: a JSON object {"kind": "shape" or "policy", "formula"}
from the standard input, one to the standard output: formula, label, library, library_sha256, of a shape
at_zero too, of a policy reads_gap and slope_error_rel; or found and allowed of what is wrong.
"""

from __future__ import annotations

import json
import sys

from .compiled import compiled, compiled_policy
from .grammar import FormulaError


def main() -> int:
    asked = json.load(sys.stdin)
    try:
        make = {"shape": compiled, "policy": compiled_policy}[asked["kind"]]
        made = make(asked["formula"])
    except FormulaError as error:
        print(json.dumps({"found": error.found, "allowed": error.allowed}))
        return 0
    told = ("formula", "label", "at_zero", "reads_gap", "slope_error_rel", "library_sha256")
    known = {key: made.about[key] for key in told if key in made.about}
    print(json.dumps({**known, "library": str(made.library)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
