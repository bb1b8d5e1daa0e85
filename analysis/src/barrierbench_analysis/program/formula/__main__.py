"""What the program starts when it meets a formula: a JSON object {"kind", "formula"} from the standard input,
one to the standard output. Of kind shape and policy: formula, label, library, library_sha256; of a shape
at_zero too and, where its signs are not proven, unproven (a text); of a policy reads_gap and
slope_error_rel. Of kind device, which is requested with a layout, the kernel of a shape: entry, ptx (a file),
ptx_sha256. Or found and allowed of what is wrong.
"""

import json
import sys

from .cache import Compiled
from .compiled import compiled, compiled_policy, signs_of
from .device import device_code
from .grammar import FormulaError

REPORTED = ("formula", "label", "at_zero", "reads_gap", "slope_error_rel", "library_sha256")


def _library(made: Compiled) -> dict:
    known = {key: made.about[key] for key in REPORTED if key in made.about}
    if unproven := made.about.get("unproven"):
        known["unproven"] = signs_of(unproven)
    return {**known, "library": str(made.library)}


ANSWERS = {
    "shape": lambda request: _library(compiled(request["formula"])),
    "policy": lambda request: _library(compiled_policy(request["formula"])),
    "device": lambda request: device_code(request["formula"], request["layout"]),
}


def main() -> int:
    request = json.load(sys.stdin)
    try:
        answer = ANSWERS[request["kind"]](request)
    except FormulaError as error:
        answer = {"found": error.found, "allowed": error.allowed}
    print(json.dumps(answer))
    return 0


if __name__ == "__main__":
    sys.exit(main())
