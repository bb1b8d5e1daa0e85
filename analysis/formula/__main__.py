"""What the program starts when it meets a formula: a JSON object {"formula", "at_zero"} from the standard
input, one to the standard output: name, label, library, library_sha256; or found and allowed of what is
wrong.
"""

from __future__ import annotations

import json
import sys

from .compiled import compiled
from .grammar import FormulaError


def main() -> int:
    asked = json.load(sys.stdin)
    try:
        made = compiled(asked["formula"], asked.get("at_zero"))
    except FormulaError as error:
        print(json.dumps({"found": error.found, "allowed": error.allowed}))
        return 0
    known = {key: made.about[key] for key in ("formula", "label", "at_zero", "library_sha256")}
    print(json.dumps({**known, "library": str(made.library)}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
